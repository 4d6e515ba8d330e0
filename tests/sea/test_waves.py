"""Waves against kinematics computed elsewhere, and the properties of a realisation."""

import math

import numpy as np
import pytest
from scipy.stats import kstest

from seatrial.errors import InputError
from seatrial.physics.sea.lattice import upper_frequency
from seatrial.physics.sea.orbital import Orbital
from seatrial.physics.sea.spectra import Jonswap, Torsethaugen, moment
from seatrial.physics.sea.spreading import cos_2s, cos_n
from seatrial.physics.sea.waves import Waves, irregular, regular

from .references import content, table

SEA = Jonswap(0.5, 4.0)


def reference_sea(case):
    given = content("components")[case]
    return Waves(
        given["a"], given["omega"], given["direction"], given["phase"], float(given["depth"])
    )


@pytest.mark.parametrize("case", ["deep", "depth8"])
def test_motion_of_the_water_is_that_of_the_reference(case):
    data = table("kinematics")
    sea = reference_sea(case)
    rows = data[data["case"] == case]
    assert len(rows) > 5
    for row in rows:
        point = [row["x"], row["y"], row["z"]]
        for stretched, suffix in ((False, ""), (True, "_wheeler")):
            found = sea.motion(row["t"], point, stretched=stretched)
            values = [*found.velocity, *found.acceleration, found.head]
            names = ("u", "v", "w", "du", "dv", "dw", "head")
            expected = [row[name + suffix] for name in names]
            np.testing.assert_allclose(values, expected, rtol=1e-10, atol=2e-12)
        np.testing.assert_allclose(
            [found.elevation, *found.slope],
            [row["elevation"], row["slope_x"], row["slope_y"]],
            rtol=1e-10,
            atol=2e-12,
        )


def test_many_points_at_once_are_the_points_one_by_one():
    sea = reference_sea("depth8")
    points = np.random.default_rng(1).uniform([-5, -5, 0], [5, 5, 6], (3, 4, 3))
    together = sea.motion(2.5, points)
    alone = sea.motion(2.5, points[1, 2])
    np.testing.assert_allclose(together.velocity[1, 2], alone.velocity, rtol=1e-13)
    np.testing.assert_allclose(together.head[1, 2], alone.head, rtol=1e-13)
    np.testing.assert_allclose(sea.elevation(2.5, points[..., :2]), together.elevation, rtol=1e-13)


def test_very_deep_water_does_not_overflow():
    deep, finite = (regular(0.2, 0.5, 0.3, h).motion(0.1, [1, 2, 0.05]) for h in (math.inf, 500.0))
    np.testing.assert_allclose(deep.velocity, finite.velocity, rtol=1e-3)
    assert np.isfinite(finite.velocity).all()


@pytest.mark.parametrize("per_octave", [3, 20, 50])
def test_energy_is_exact_for_any_number_of_components(per_octave):
    sea = irregular(SEA, direction=0.0, seed=1, high=8.0, per_octave=per_octave)
    low, high = 2.0 ** (np.array([-1, 3]))  # 0.5 wp is 0.785: the lattice's next edge is below
    edges = 2.0 ** (np.floor(np.log2(SEA.peaks[0] / 2) * per_octave) / per_octave), high
    assert low < edges[0] < SEA.peaks[0] / 2
    energy = 0.5 * np.square(sea.amplitude).sum()
    assert energy == pytest.approx(moment(SEA, 0, *edges), rel=1e-12)
    assert 4.0 * math.sqrt(energy) == pytest.approx(0.5, rel=4e-3)


def test_a_component_depends_on_its_band_and_seed_alone():
    wide = irregular(SEA, direction=0.2, seed=5, high=20.0, spreading=cos_2s(10))
    narrow = irregular(SEA, direction=0.2, seed=5, high=8.0, spreading=cos_2s(10))
    higher = irregular(Jonswap(1.0, 4.0), direction=0.2, seed=5, high=8.0, spreading=cos_2s(10))
    n = len(narrow.omega)
    for name in ("amplitude", "omega", "direction", "phase"):
        assert (getattr(wide, name)[:n] == getattr(narrow, name)).all()
    for name in ("omega", "direction", "phase"):
        assert (getattr(higher, name) == getattr(narrow, name)).all()
    other = irregular(SEA, direction=0.2, seed=6, high=8.0)
    assert not (other.phase == narrow.phase).any()


def test_random_amplitudes_are_rayleigh_distributed_about_the_spectrums():
    fixed = irregular(SEA, direction=0, seed=1, high=8.0, per_octave=50).amplitude
    drawn = [
        irregular(SEA, direction=0, seed=s, high=8.0, per_octave=50, random_amplitudes=True)
        for s in range(15)
    ]
    energies = np.square(np.concatenate([sea.amplitude / fixed for sea in drawn]))
    assert len(energies) > 2000
    assert kstest(energies, "expon").pvalue > 0.01


def test_slopes_of_a_realisation_are_those_of_the_spectrum():
    ratios = []
    for seed in range(10):
        sea = irregular(SEA, direction=0, seed=seed, high=12.0)
        ratios.append(0.5 * (sea.amplitude**2 * sea.omega**4).sum() / moment(SEA, 4, 0.77, 12.126))
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("spreading", "mean_cosine"),
    [
        (cos_2s(10.0), 10.0 / 11.0),
        (cos_2s(120.0), 120.0 / 121.0),
        (cos_n(2.0), (math.gamma(2.0) / math.gamma(1.5)) ** 2 / 1.5),
    ],
)
def test_spreading_has_its_first_moment_and_inverse(spreading, mean_cosine):
    d = np.linspace(-math.pi, math.pi, 20001)
    density = spreading.density(d)
    assert np.trapezoid(density, d) == pytest.approx(1.0, abs=1e-7)
    assert np.trapezoid(density * np.cos(d), d) == pytest.approx(mean_cosine, abs=1e-7)
    np.testing.assert_allclose(spreading.density(d), spreading.density(-d + 4 * math.pi), atol=1e-9)
    below = np.array([0.03, 0.3, 0.5, 0.9])
    found = spreading.angle(below)
    for share, angle in zip(below, found, strict=True):
        inside = np.linspace(-math.pi, angle, 20001)
        assert np.trapezoid(spreading.density(inside), inside) == pytest.approx(share, abs=1e-6)


def test_the_crafts_size_sets_the_highest_frequency():
    assert upper_frequency(1.0, 100.0) == 5.0
    assert upper_frequency(1.57, 1.3, heave=10.4) == pytest.approx(13.52)
    assert upper_frequency(1.0, 1.3) == pytest.approx(math.sqrt(4 * math.pi * 9.81 / 1.3))


def test_swell_is_in_a_sea_of_two_peaks():
    sea = irregular(Torsethaugen(2.5, 8.0), direction=0, seed=1, high=5.0)
    assert sea.omega[0] < 0.6 * min(Torsethaugen(2.5, 8.0).peaks)


def test_impossible_seas_are_refused():
    with pytest.raises(InputError, match="no range"):
        irregular(SEA, direction=0, seed=1, high=0.1)
    with pytest.raises(InputError, match="differ in number"):
        Waves([1.0], [1.0, 2.0], [0.0], [0.0])
    with pytest.raises(InputError, match="height"):
        regular(0.0, 4.0, 0.0)


@pytest.mark.parametrize("depth", [math.inf, 8.0])
def test_above_the_surface_water_moves_as_the_surface_does(depth):
    sea = irregular(SEA, direction=0.7, seed=3, high=12.0, depth=depth)
    orbital, t, place = Orbital(sea), 3.0, (2.0, -1.0)
    surface = -float(sea.elevation(t, place))
    there = sea.motion(t, [*place, surface])
    for above in (0.0, 0.5, 50.0):
        elevation, moved = orbital.at(t, *place, surface - above)
        assert elevation == pytest.approx(-surface, rel=1e-12)
        np.testing.assert_allclose(moved[:3], there.velocity, atol=1e-12)
        np.testing.assert_allclose(moved[3:], there.acceleration, atol=1e-12)
