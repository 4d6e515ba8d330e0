"""Wind, its loads, currents and drift against reference data and closed forms."""

import math

import numpy as np
import pytest
from scipy.special import beta

from seatrial.errors import InputError
from seatrial.physics.sea.current import (
    GaussMarkov,
    Layers,
    Tide,
    power_profile,
    rate_in_body,
    reflected,
    towards,
    wind_driven,
)
from seatrial.physics.sea.currents import CurrentState
from seatrial.physics.sea.drift import mean_drift, slow_drift
from seatrial.physics.sea.quadrature import integrals
from seatrial.physics.sea.wind_loads import (
    BLENDERMANN,
    Areas,
    Blendermann,
    Isherwood,
    Silhouette,
    angle_of_attack,
)
from seatrial.physics.sea.wind_spectra import davenport, froya, gust_energies, gusts, harris, norsok

from .references import content, table


def test_spectra_of_wind_are_those_of_the_reference():
    data = table("wind_spectra")
    f = data["f_hz"]
    found = {
        "davenport_U10": davenport(f, 10.0, 0.003),
        "harris_U10": harris(f, 10.0, 0.0026),
        "froya_U10_z10": norsok(f, 10.0),
        "davenport_U20": davenport(f, 20.0, 0.003),
        "harris_U20": harris(f, 20.0, 0.0026),
        "froya_U20_z30": norsok(f, 20.0, 30.0),
    }
    for name, values in found.items():
        np.testing.assert_allclose(values, data[name], rtol=1e-8)


def test_variances_of_wind_have_closed_forms():
    ends = np.array([1e-8, 1e4])
    n, c = 0.468, 172.0
    total = 320.0 * beta(1 / n, 2 / (3 * n)) / (c * n)
    assert integrals(lambda f: davenport(f, 10.0), ends).sum() == pytest.approx(1.5, rel=1e-3)
    assert integrals(lambda f: harris(f, 10.0), ends).sum() == pytest.approx(
        6.67745 * 0.25, rel=1e-3
    )
    assert integrals(lambda f: norsok(f, 10.0), np.array([1e-9, 1e6])).sum() == pytest.approx(
        total, rel=2e-2
    )


def test_profile_of_froya():
    assert froya(20.0, 30.0) == pytest.approx(22.518, abs=5e-4)
    assert froya(20.0, 10.0, 3.0) == pytest.approx(26.488, abs=5e-4)


def test_gusts_have_the_spectrums_variance_and_depend_on_the_seed_alone():
    made = gusts(gust_energies(lambda f: norsok(f, 10.0)), seed=4)
    assert 0.5 * np.square(made.amplitude).sum() == pytest.approx((0.0944 * 10) ** 2, rel=0.02)
    stronger = gusts(gust_energies(lambda f: norsok(f, 20.0)), seed=4)
    assert (made.phase == stronger.phase).all()
    assert (made.omega == stronger.omega).all()
    speeds = [made.speed(t) for t in np.arange(0.0, 36000.0, 5.0)]
    assert np.std(speeds) == pytest.approx(0.944, rel=0.05)


def test_wind_loads_of_ships_are_those_of_the_reference():
    given, data = content("wind_loads"), table("wind_loads")
    shape = Silhouette(given["Loa"], given["A_front"], given["A_lateral"])
    by_form = Isherwood(
        shape, given["B"], given["S"], given["C"], given["M"], given["A_superstructure"]
    )
    by_type = Blendermann(shape, given["type"], given["sL"], given["sH"])
    for row in data:
        gamma = math.radians(row["gamma_deg"])
        found = by_form.coefficients(gamma)[[0, 1, 3]]
        expected = [row[f"isherwood_C{axis}"] for axis in "XYN"]
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9)
        expected = [row[f"blendermann_C{axis}"] for axis in "XYKN"]
        np.testing.assert_allclose(by_type.coefficients(gamma), expected, rtol=1e-8, atol=1e-9)
        mirrored = by_type.coefficients(-gamma) * [1, -1, -1, -1]
        np.testing.assert_allclose(mirrored, by_type.coefficients(gamma), atol=1e-12)
    assert len(BLENDERMANN) == len(table("blendermann"))
    for row in table("blendermann"):
        assert BLENDERMANN[row["type"]] == tuple(row)[1:]
    with pytest.raises(InputError, match="cargo_loaded"):
        Blendermann(shape, "cargo_loded", 0.0, 0.0)


def test_wind_pushes_and_a_drifting_craft_feels_none():
    boat = Areas(frontal=0.2, lateral=0.5, ahead=0.1, height=0.3)
    assert (boat.loads(0.0, 0.0) == 0.0).all()
    x, y, k, n = boat.loads(0.0, -5.0)  # the air goes to starboard
    assert x == 0.0
    assert y == pytest.approx(0.5 * 1.225 * 25 * 0.85 * 0.5)
    assert (k, n) == pytest.approx((0.3 * y, 0.1 * y))
    assert angle_of_attack(0.0, -5.0) == pytest.approx(math.pi / 2)
    shape = Silhouette(160.0, 450.0, 1500.0)
    loads = shape.loads(np.array([1.0, 1.0, 1.0, 1.0]), 2.0)
    assert loads == pytest.approx(0.5 * 1.225 * 4 * np.array([450, 1500, 1500**2 / 160, 240000]))


def test_profiles_of_current():
    depths = np.linspace(0.0, 20.0, 20001)
    surface = towards(1.0, 0.0)
    speeds = [power_profile(surface, z, 20.0)[0] for z in depths]
    assert np.trapezoid(speeds, depths) / 20.0 == pytest.approx(7 / 8, abs=1e-4)
    assert power_profile(surface, 21.0, 20.0)[0] == 0.0
    assert wind_driven(surface, 25.0)[0] == 0.5
    assert wind_driven(surface, 60.0)[0] == 0.0
    turning = Layers([0.0, 10.0], [towards(1, math.radians(359)), towards(1, math.radians(1))])
    north, east = turning.at(5.0)
    assert north == pytest.approx(math.cos(math.radians(1)))
    assert abs(east) < 1e-15
    with pytest.raises(InputError, match="must rise"):
        Layers([0.0, 0.0], [[1, 0], [1, 0]])


def test_tide_runs_round_its_ellipse():
    tide = Tide(44714.164, 1.0, math.pi / 2, minor=0.2)
    assert tide.at(0.0) == pytest.approx([0.0, 1.0], abs=1e-15)
    assert tide.at(44714.164 / 4) == pytest.approx([-0.2, 0.0], abs=1e-12)


@pytest.mark.parametrize("profile", ["power", "linear", "layers"])
def test_rate_and_slope_of_a_current_are_its_derivatives(profile):
    state = CurrentState(
        speed=0.8, direction=0.7, profile=profile, reach=25.0, layers=2,
        layer_depths=(2.0, 20.0), layer_speeds=(1.0, 0.3), layer_directions=(2.0, 3.0),
        tide=0.6, tide_axis=-1.0, tide_minor=0.2, tide_period=600.0, tide_phase=0.4,
    )  # fmt: skip
    t, z, h = 170.0, 7.0, 1e-2
    velocity, rate, slope = state.at(t, z)
    np.testing.assert_array_equal(velocity, state.velocity(t, z))
    late, early = state.velocity(t + h, z), state.velocity(t - h, z)
    np.testing.assert_allclose(rate, (late - early) / (2 * h), rtol=1e-6)
    below, above = state.velocity(t, z + h), state.velocity(t, z - h)
    np.testing.assert_allclose(slope, (below - above) / (2 * h), rtol=1e-5)
    swing = 0.4 + math.tau * t / 600.0
    tidal = (0.6 * math.cos(swing) + 0.2j * math.sin(swing)) * np.exp(-1j)
    stream = {
        "power": 0.8 * (18 / 25) ** (1 / 7) * np.exp(0.7j),
        "linear": 0.8 * 18 / 25 * np.exp(0.7j),
    }
    stream["layers"] = 13 / 18 * np.exp(2j) + 5 / 18 * 0.3 * np.exp(3j)
    assert complex(*velocity) == pytest.approx(tidal + stream[profile], rel=1e-12)


def test_slow_variation_is_stationary_and_keyed():
    x = GaussMarkov(0.1, 20.0, 3, "current speed")
    values = np.array([x.at(float(k)) for k in range(20000)])
    assert values.std() == pytest.approx(0.1, rel=0.06)
    lag = np.corrcoef(values[:-20], values[20:])[0, 1]
    assert lag == pytest.approx(math.exp(-1.0), abs=0.06)
    assert GaussMarkov(0.1, 20.0, 3, "current speed").at(500.25) == x.at(500.25)
    assert GaussMarkov(0.1, 20.0, 3, "current direction").at(3.0) != x.at(3.0)
    # Linear between its samples, one a second.
    for t, share in ((2.5, 0.5), (7.25, 0.25), (40.9, 0.9)):
        k = math.floor(t)
        assert x.at(t) == pytest.approx((1 - share) * values[k] + share * values[k + 1], rel=1e-9)
    assert reflected(1.2, 0.0, 1.0) == pytest.approx(0.8)
    assert reflected(-0.3, 0.0, 1.0) == pytest.approx(0.3)
    assert reflected(0.4, 0.0, 1.0) == pytest.approx(0.4)


@pytest.mark.parametrize("t", [-2.0, 5.3, 61.7])
def test_a_slow_variation_turns_and_stretches_the_whole_profile(t):
    slow = {"variation": 0.5, "turning": 0.4, "variation_time": 30.0, "seed": 5}
    faster = GaussMarkov(0.5, 30.0, 5, "current speed").at(max(t, 0.0))
    turned = GaussMarkov(0.4, 30.0, 5, "current direction").at(max(t, 0.0))
    even = CurrentState(speed=0.3, direction=0.7, **slow)
    expected = abs(0.3 + faster) * np.exp(1j * (0.7 + turned))
    assert complex(*even.velocity(t, 4.0)) == pytest.approx(expected, rel=1e-12)
    layers = {"layers": 2, "layer_depths": (0.0, 10.0), "layer_speeds": (0.8, 0.2)}
    layers["layer_directions"] = (0.1, 2.0)
    layered = CurrentState(speed=0.3, direction=0.7, profile="layers", **layers, **slow)
    # Halfway between the layers; longer by what the speed has grown.
    still = (0.8 * np.exp(0.1j) + 0.2 * np.exp(2j)) / 2
    grown = (abs(still) + abs(0.3 + faster) - 0.3) / abs(still)
    expected = still * grown * np.exp(1j * turned)
    assert complex(*layered.velocity(t, 5.0)) == pytest.approx(expected, rel=1e-12)


def test_current_in_the_axes_of_a_turning_craft():
    def rotation(psi):
        c, s = math.cos(psi), math.sin(psi)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    current, r, h = np.array([0.5, -0.3, 0.0]), 0.2, 1e-6
    found = rate_in_body(rotation(0.7), [0.0, 0.0, r], current, np.zeros(3))
    ahead, behind = (rotation(0.7 + sign * r * h).T @ current for sign in (1, -1))
    np.testing.assert_allclose(found, (ahead - behind) / (2 * h), atol=1e-9)


def test_drift_is_the_mean_and_the_differences_of_frequencies():
    coefficients = table("drift_barge_T020")
    head = coefficients[coefficients["direction_deg"] == 180]
    w, d = head["omega"][4:6], head["D_X"][4:6]
    a = np.array([0.1, 0.05])
    t = np.linspace(0.0, math.tau / (w[1] - w[0]), 4001)[:-1]
    forces = np.array([slow_drift(a * np.exp(1j * w * time), d) for time in t])
    assert forces.mean() == pytest.approx(mean_drift(a, d), rel=1e-10)
    spectrum = abs(np.fft.rfft(forces - forces.mean()))
    assert spectrum[1] > 1.0
    assert (spectrum[2:] < 1e-9 * spectrum[1]).all()
    assert slow_drift(a[:1] * np.exp(1j * 0.7), d[:1]) == pytest.approx(a[0] ** 2 * d[0])
