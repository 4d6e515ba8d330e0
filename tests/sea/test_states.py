"""Wind, current and sea as a trial states them, beside formulas with numbers off every symmetry."""

import math

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from seatrial.errors import InputError
from seatrial.physics.craft.surrounded import _cubic
from seatrial.physics.sea import lattice
from seatrial.physics.sea.currents import CurrentState
from seatrial.physics.sea.loads import WaveLoads, tabulated
from seatrial.physics.sea.orbital import Orbital
from seatrial.physics.sea.quadrature import integrals
from seatrial.physics.sea.seastate import SeaState
from seatrial.physics.sea.spectra import Jonswap, Tma
from seatrial.physics.sea.spreading import cos_2s, cos_n
from seatrial.physics.sea.waves import Waves
from seatrial.physics.sea.wind_spectra import davenport, gust_energies, gusts, harris, norsok
from seatrial.physics.sea.winds import WindState

U = 14.0


def at_height(profile, z):
    """Return the mean at a height, of U at 10 m: 0.12 of the power law, a roughness of 0.2 mm."""
    z = max(z, 0.1)
    return {
        "uniform": U,
        "power": U * (z / 10) ** 0.12,
        "logarithmic": U * math.log(z / 2e-4) / math.log(10 / 2e-4),
        # [NORSOK], 1 h mean: no part of the turbulence.
        "froya": U * (1 + 0.0573 * math.sqrt(1 + 0.15 * U) * math.log(z / 10)),
    }[profile]


@pytest.mark.parametrize("profile", ["uniform", "power", "logarithmic", "froya"])
@pytest.mark.parametrize("height", [-1.0, 0.02, 0.1, 2.5, 27.0])
def test_the_mean_wind_by_height(profile, height):
    blows = WindState(U, 2.2, profile).velocity(3.0, height)
    expected = at_height(profile, height) * np.array([math.cos(2.2), math.sin(2.2)])
    np.testing.assert_allclose(blows, expected, rtol=1e-12)


@pytest.mark.parametrize("spectrum", [davenport, harris, norsok])
def test_gusts_of_a_spectrum_and_one_of_a_cosine_come_on_top(spectrum):
    wind = WindState(U, -0.8, "power", spectrum.__name__, 6.0, 20.0, 8.0, 4)
    drawn = gusts(gust_energies(lambda f: spectrum(f, U)), 4)
    for t, bump in ((19.9, 0), (21.0, 1 - math.sqrt(0.5)), (25.0, 1 + math.sqrt(0.5)), (28.3, 0)):
        random = np.sum(drawn.amplitude * np.cos(drawn.omega * t + drawn.phase))
        speed = at_height("power", 4.0) + random + 3.0 * bump
        blows = wind.velocity(t, 4.0)
        assert complex(*blows) == pytest.approx(speed * np.exp(-0.8j), rel=1e-12)
    # Energy, band by band: variance of a band is that of its component.
    indices = lattice.bands(math.tau / 3600, math.pi, 10)
    edges = 2.0 ** (np.arange(indices.start, indices.stop + 1) / 10) / math.tau
    np.testing.assert_allclose(
        drawn.amplitude**2 / 2, integrals(lambda f: spectrum(f, U), edges), rtol=1e-12
    )
    assert (edges[:-1] <= drawn.omega / math.tau).all()
    assert (drawn.omega / math.tau <= edges[1:]).all()


def test_wind_does_not_blow_backwards_and_may_be_a_gust_alone():
    assert WindState(2.0, gust=-5.0, gust_start=0.0).velocity(5.0, 10.0).tolist() == [0.0, 0.0]
    assert WindState().is_absent
    assert not WindState(gust=1.0).is_absent
    assert not WindState(1.0).is_absent


@pytest.mark.parametrize("name", ["speed", "tide", "tide_minor", "variation"])
def test_one_part_makes_a_current(name):
    assert CurrentState().is_absent
    assert not CurrentState(**{name: 0.2}).is_absent
    assert CurrentState(**{name: 0.2}).is_steady is (name == "speed")


def test_a_stream_over_a_bed_is_no_faster_above_the_surface_and_begins_at_once():
    stream = CurrentState(0.8, 0.7, "power", reach=25.0, tide=0.5, tide_period=60.0, tide_axis=2.0)
    for depth in (-3.0, 0.0, 10.0, 30.0):
        share = max(0.0, 1 - max(depth, 0.0) / 25) ** (1 / 7)
        for t in (0.0, 7.0):
            tide = 0.5 * math.cos(math.tau * t / 60) * np.exp(2j)
            found, rate, _ = stream.at(t, depth)
            assert complex(*found) == pytest.approx(0.8 * share * np.exp(0.7j) + tide, rel=1e-12)
            turning = -0.5 * math.tau / 60 * math.sin(math.tau * t / 60) * np.exp(2j)
            # A difference over 2 ms, at the beginning one over 1 ms.
            assert complex(*rate) == pytest.approx(turning, abs=4e-6)


def test_a_turning_current_is_not_steady():
    assert not CurrentState(0.5, turning=0.1).is_steady
    slow = CurrentState(0.5, turning=0.3, variation_time=10.0)
    _, rate, _ = slow.at(4.5, 0.0)
    late, early = slow.velocity(4.6, 0.0), slow.velocity(4.4, 0.0)
    np.testing.assert_allclose(rate, (late - early) / 0.2, rtol=1e-2)
    assert np.abs(rate).max() > 1e-3


# ------------------------------------------------------------------ the sea

CROSSING = Waves([0.3, 0.2, 0.1], [0.7, 1.3, 2.9], [0.4, 2.0, -2.5], [1.0, 2.5, -0.6])


@pytest.mark.parametrize("depth", [math.inf, 9.0])
def test_water_below_the_surface_moves_as_the_waves_say(depth):
    sea = Waves(CROSSING.amplitude, CROSSING.omega, CROSSING.direction, CROSSING.phase, depth)
    orbital, draw = Orbital(sea), np.random.default_rng(2)
    for t, *point in draw.uniform((0, -9, -9, 0.8), (60, 9, 9, 8.5), (6, 4)):
        expected = sea.motion(t, point)
        elevation, moved = orbital.at(t, *point)
        assert elevation == pytest.approx(expected.elevation, rel=1e-12)
        np.testing.assert_allclose(
            moved, [*expected.velocity, *expected.acceleration], rtol=1e-10, atol=1e-12
        )


@pytest.mark.parametrize("depth", [math.inf, 9.0])
def test_the_motion_of_crossing_waves_has_the_derivatives_of_its_elevation(depth):
    sea = Waves(CROSSING.amplitude, CROSSING.omega, CROSSING.direction, CROSSING.phase, depth)
    t, place, h = 4.0, np.array([3.0, -7.0]), 1e-5
    at = sea.motion(t, [*place, 0.0], stretched=False)
    steps = h * np.eye(2)
    slope = [(sea.elevation(t, place + s) - sea.elevation(t, place - s)) / (2 * h) for s in steps]
    np.testing.assert_allclose(at.slope, slope, atol=1e-8)
    rising = (sea.elevation(t + h, place) - sea.elevation(t - h, place)) / (2 * h)
    assert at.velocity[2] == pytest.approx(-rising, abs=1e-8)  # down
    # Euler's equation at the mean surface, linear: dv/dt = -g grad head, and its own rate.
    np.testing.assert_allclose(at.acceleration[:2], -9.80665 * np.array(slope), rtol=1e-3)
    later, before = (sea.motion(t + s, [*place, 0.0], stretched=False) for s in (h, -h))
    rate = (later.velocity - before.velocity) / (2 * h)
    np.testing.assert_allclose(at.acceleration, rate, atol=1e-7)


def trains(**sea):
    """Return amplitude, frequency and direction of each wave of a sea."""
    waves = SeaState(**sea).waves()
    return waves.amplitude, waves.omega, waves.direction, waves.depth


def test_a_regular_wave_beside_a_swell():
    swell = {"swell_height": (0.8,), "swell_period": (11.0,), "swell_direction": (2.0,)}
    swell |= {"swell_gamma": (5.0,), "swell_spreading": (0.0,)}
    one = {"spectrum": "regular", "height": 0.4, "period": 4.0, "direction": -1.0}
    amplitude, omega, direction, depth = trains(**one, **swell, depth=12.0)
    assert (amplitude[0], omega[0], direction[0]) == (0.2, math.tau / 4.0, -1.0)
    assert (direction[1:] == 2.0).all()
    assert depth == 12.0
    energy = np.sum(amplitude[1:] ** 2) / 2
    assert 4 * math.sqrt(energy) == pytest.approx(0.8, rel=5e-3)
    # To 5 times its peak: in the band, a twelfth of an octave, that has it.
    band, top = 2 ** (1 / 12), math.tau / 11 * 5
    assert top / band < omega[1:].max() < top * band


@pytest.mark.parametrize(("form", "spreading"), [("cos-2s", cos_2s), ("cos-n", cos_n)])
def test_directions_are_spread_about_the_mean_as_the_form_says(form, spreading):
    sea = {"spectrum": "jonswap", "height": 1.0, "period": 6.0, "direction": 0.8}
    *_, direction, _ = trains(**sea, spreading=4.0, spreading_form=form)
    of_each = direction - 0.8
    d = np.linspace(-math.pi, math.pi, 4001)
    spread = np.trapezoid(spreading(4.0).density(d) * d**2, d) ** 0.5
    # As many draws as waves: a few per cent.
    assert of_each.std() == pytest.approx(spread, rel=0.15)
    assert abs(of_each.mean()) < 4 * spread / math.sqrt(len(direction))


def test_a_sea_ends_where_it_is_told_to_or_beyond_its_highest_peak():
    sea = {"spectrum": "jonswap", "height": 0.02, "components_per_octave": 20}
    for period, highest, expected in (
        (4.0, 0.0, 4 * math.pi),
        (1.0, 0.0, 10 * math.pi),
        (4.0, 5.0, 5.0),
    ):
        _, omega, *_ = trains(**sea, period=period, highest=highest)
        band = 2 ** (1 / 20)
        assert expected / band < omega.max() < expected * band
        assert math.pi / period / band**2 < omega.min() < math.pi / period * band**2


def test_gamma_and_depth_reach_the_spectrum():
    w = np.linspace(0.4, 3.0, 20)
    sea = {"height": 1.0, "period": 6.0, "gamma": 2.0, "depth": 7.0}
    for name, expected in (("jonswap", Jonswap(1.0, 6.0, 2.0)), ("tma", Tma(1.0, 6.0, 7.0, 2.0))):
        found = SeaState(name, **sea).spectrum_of_it().density(w)
        np.testing.assert_allclose(found, expected.density(w), rtol=1e-12)
    assert SeaState(depth=7.0).water_depth == 7.0
    assert SeaState().water_depth == math.inf
    assert SeaState().is_calm


def test_waves_break_at_a_seventh_of_their_length():
    # g T^2 / (2 pi) is the length.
    length = 9.81 * 3.0**2 / math.tau
    SeaState("regular", 0.99 * length / 7, 3.0).waves()
    with pytest.raises(InputError, match=r"steepness of 0\.14, and waves break at 0\.14"):
        SeaState("regular", 1.01 * length / 7, 3.0).waves()


def test_bands_of_two_kinds_and_streams_are_drawn_apart():
    bands = range(-20, 20)
    draws = [
        lattice.draws(kind, seed, stream, bands)
        for kind, seed, stream in (("sea", 1, 0), ("swell 1", 1, 0), ("sea", 2, 0), ("sea", 1, 1))
    ]
    correlation = np.corrcoef(draws) - np.eye(4)
    assert np.abs(correlation).max() < 0.5  # 40 draws: 3 deviations
    np.testing.assert_array_equal(lattice.draws("sea", 1, 0, range(5, 9)), draws[0][25:29])


# ------------------------------------------------------------------ loads between table's points


def linear(omega, k, chi):
    """Return a response that is linear in frequency, of six loads that differ."""
    size = np.arange(1.0, 7.0)[:, None] * (1 + 0.3 * omega)
    return size * np.exp(1j * (np.arange(6.0)[:, None] + chi))


def mean_forces(omega, chi):
    return np.stack([omega * np.cos(chi), 2 * omega * np.sin(chi), 3 + 0 * omega])


@pytest.mark.parametrize("heading", [0.3, 2.9, -1.234, 7.0])
@pytest.mark.parametrize("drift", [None, mean_forces])
def test_loads_between_two_headings_are_between_those_there(heading, drift):
    t, place, step = 3.3, (2.0, -5.0), math.tau / 180
    found = WaveLoads(CROSSING, linear, drift).at(t, *place, heading)
    phasors = CROSSING.phasors(t, np.array(place))
    cell, share = divmod(heading % math.tau / step, 1.0)
    expected = np.zeros(6)
    for weight, number in ((1 - share, cell), (share, cell + 1)):
        chi = CROSSING.direction - number * step
        expected += weight * (linear(CROSSING.omega, None, chi) @ phasors).real
        if drift:
            slow = np.conj(phasors.sum()) * (drift(CROSSING.omega, chi) @ phasors)
            expected[[0, 1, 5]] += weight * slow.real
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize(("w", "chi"), [(1.3, 0.5), (2.9, 2.2), (0.2, 5.9), (9.0, -0.3)])
def test_a_table_is_linear_in_frequency_and_direction(w, chi):
    draw = np.random.default_rng(5)
    omega, angles = np.array([1.0, 1.6, 3.0]), np.array([0.2, 1.1, 2.5, 4.0, 5.5])
    forces = draw.normal(size=(6, 3, 5)) + 1j * draw.normal(size=(6, 3, 5))
    found = tabulated(omega, angles, forces)(np.array([w]), np.array([w**2 / 9.81]), chi)[:, 0]
    round_angles = np.append(angles, 0.2 + math.tau)
    round_forces = np.concatenate([forces, forces[:, :, :1]], 2)
    grid = RegularGridInterpolator((omega, round_angles), np.moveaxis(round_forces, 0, 2))
    at = min(max(w, 1.0), 3.0), 0.2 + (chi - 0.2) % math.tau
    np.testing.assert_allclose(found, np.ravel(grid(at)), rtol=1e-9)


@pytest.mark.parametrize(("steps", "count"), [(1, 1), (1, 3), (5, 2)])
def test_surroundings_between_evaluations_are_the_cubic_through_four(steps, count):
    shares = _cubic(steps, count)
    assert shares.shape == (steps, 2 * count + 1, 4)
    polynomial = np.polynomial.Polynomial([0.7, -1.3, 0.4, 2.1])
    known = polynomial(np.array([-2.0, -1.0, 0.0, 1.0]))
    for step in range(steps):
        at = (step + np.linspace(0, 1, 2 * count + 1)) / steps
        np.testing.assert_allclose(shares[step] @ known, polynomial(at), atol=1e-12)
