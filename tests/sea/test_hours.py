"""A sea as it is: hours that differ, heights of its waves, several trains at once."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.sea.seastate import SeaState
from seatrial.physics.sea.spectra import Jonswap, Torsethaugen, moment
from seatrial.physics.sea.spreading import cos_2s
from seatrial.physics.sea.waves import irregular

HEIGHT, PERIOD = 2.0, 8.0
HOUR, STEP, HOURS, SEEDS = 3600.0, 0.5, 3, 10


def record(state):
    """Return the elevation at the origin over three hours."""
    waves, block = state.waves(), 300.0
    starts = np.arange(0.0, HOURS * HOUR, block)
    within = np.exp(1j * np.outer(np.arange(0.0, block, STEP), waves.omega))
    begun = waves.amplitude * np.exp(1j * (np.outer(starts, waves.omega) + waves.phase))
    return np.real(within @ begun.T).T.ravel()


def ten(**sea):
    return [record(SeaState(seed=seed, **sea)) for seed in range(SEEDS)]


def heights_of_hours(records):
    """Return Hm0 of each hour, (SEEDS, HOURS)."""
    return 4 * np.array([r.reshape(HOURS, -1).std(axis=1) for r in records])


def variation(width):
    """Return CoV(Hm0) of an hour of a Gaussian sea, 0.5 sqrt(2 pi / (W T)), W in rad/s."""
    return 0.5 * math.sqrt(2 * math.pi / (width * HOUR))


@pytest.fixture(scope="module")
def records():
    return ten(spectrum="jonswap", height=HEIGHT, period=PERIOD)


# W / wp of JONSWAP by gamma: the table of the sea's specification.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("height", "period", "gamma", "width"),
    [(2.0, 8.0, 3.3, 0.65940), (0.1, 2.5, 1.0, 1.10982), (4.0, 12.0, 7.0, 0.43420)],
)
def test_hours_differ_as_those_of_a_gaussian_sea(height, period, gamma, width):
    found = heights_of_hours(ten(spectrum="jonswap", height=height, period=period, gamma=gamma))
    expected = variation(width * 2 * math.pi / period)
    count = HOURS * SEEDS
    # 3 standard errors each: of the mean, of the deviation of all hours, and of that of the hours
    # of one sea from each other, which has 2 degrees of freedom a sea.
    assert found.mean() == pytest.approx(height, rel=3 * expected / math.sqrt(count))
    assert found.std() / height == pytest.approx(expected, rel=3 / math.sqrt(2 * count))
    of_one = math.sqrt(found.var(axis=1, ddof=1).mean()) / height
    assert of_one == pytest.approx(expected, rel=3 / math.sqrt(4 * SEEDS))


def test_a_fixed_number_to_the_octave_has_hours_alike():
    sea = {"spectrum": "jonswap", "height": HEIGHT, "period": PERIOD}
    hours = heights_of_hours(ten(components_per_octave=20, **sea))
    # CoV 0.1 to 0.7 % (the sea's specification).
    assert 0.001 < hours.std() / HEIGHT < 0.007


@pytest.mark.slow
@pytest.mark.parametrize("spectrum", [Jonswap(2.0, 8.0), Torsethaugen(2.5, 8.0)])
def test_frequencies_are_spread_as_the_energy_is(spectrum):
    seas = [irregular(spectrum, direction=0.0, seed=s, high=8.0, per_octave=0) for s in range(100)]
    omega = np.concatenate([sea.omega for sea in seas])
    energy = np.concatenate([0.5 * sea.amplitude**2 for sea in seas]) / len(seas)
    # In a fifth of the energy 12 waves fall on either side of a frequency by chance: over 100 seas
    # the share below it has a standard deviation of at most 0.2 / (2 sqrt(1200)) = 0.003.
    for at in (0.6, 0.8, 0.9, 1.0, 1.3, 2.0, 4.0):
        below = moment(spectrum, 0, 0.3, at)
        assert energy[omega < at].sum() == pytest.approx(
            below, abs=0.01 * moment(spectrum, 0, 0.3, 8.0)
        )
    for order, error in ((-1, 0.01), (1, 0.01), (2, 0.02), (4, 0.02)):
        found = np.sum(energy * omega**order)
        expected = moment(spectrum, order, 0.5 * min(spectrum.peaks), 8.0)
        assert found == pytest.approx(expected, rel=error)


def test_a_wave_depends_on_seed_and_place_in_the_spectrum_alone():
    def sea(height, high, seed=5):
        spectrum = Jonswap(height, PERIOD)
        return irregular(
            spectrum, direction=0.2, seed=seed, high=high, spreading=cos_2s(10), per_octave=0
        )

    one, other, higher = sea(1.0, 12.0), sea(1.0, 8.0), sea(2.0, 12.0)
    count = len(other.omega)
    for name in ("omega", "direction", "phase"):
        assert (getattr(one, name)[:count] == getattr(other, name)).all()
        assert (getattr(one, name) == getattr(higher, name)).all()
    np.testing.assert_allclose(higher.amplitude, 2 * one.amplitude, rtol=1e-12)
    assert not (sea(1.0, 12.0, seed=6).phase == one.phase).any()
    total = 0.5 * np.sum(one.amplitude**2)
    assert total == pytest.approx(moment(Jonswap(1.0, PERIOD), 0, 0.3, 13.0), rel=2e-3)


def test_kurtosis_is_a_gaussian_one(records):
    kurtosis = [np.mean(r**4) / r.var() ** 2 for r in records]
    # Of three hours 3 +- 0.06 (spec: 0.06 to 0.15 of an hour), of ten records a third of that.
    assert np.mean(kurtosis) == pytest.approx(3.0, abs=0.06)


def test_heights_are_rayleigh_distributed(records):
    heights = []
    for r in records:
        up = np.flatnonzero((r[:-1] < 0) & (r[1:] >= 0)) + 1
        heights += [np.ptp(part) for part in np.split(r, up)[1:-1]]
    heights = np.sort(heights)
    # Linear narrow seas: H1/3 = 0.964 Hm0 and a mean of 0.605 Hm0 for gamma 3.3 (the sea's specification).
    assert heights[-len(heights) // 3 :].mean() == pytest.approx(0.964 * HEIGHT, rel=0.02)
    assert heights.mean() == pytest.approx(0.605 * HEIGHT, rel=0.03)


def test_it_does_not_repeat(records):
    hours = records[0].reshape(HOURS, -1)
    # Of independent Gaussian hours 1 / sqrt(W T / pi), 0.04.
    assert np.max(np.abs(np.triu(np.corrcoef(hours), 1))) < 0.15


@pytest.mark.slow
def test_drawn_amplitudes_vary_about_those_of_the_spectrum():
    energies = [
        np.sum(
            SeaState("jonswap", HEIGHT, PERIOD, seed=s, amplitudes="drawn").waves().amplitude ** 2
        )
        for s in range(100)
    ]
    fixed = SeaState("jonswap", HEIGHT, PERIOD).waves().amplitude ** 2
    # Exponential energies of independent bands.
    expected = np.sqrt(np.sum(fixed**2)) / np.sum(fixed)
    assert np.mean(energies) == pytest.approx(np.sum(fixed), rel=3 * expected / math.sqrt(100))
    assert np.std(energies) / np.mean(energies) == pytest.approx(expected, rel=0.25)


def test_a_swell_beside_a_sea_is_both():
    swell = {
        "swell_height": (1.5, 0.0, 0.5), "swell_period": (14.0, 0.0, 18.0),
        "swell_direction": (1.0, 0.0, -2.0), "swell_gamma": (7.0, 7.0, 1.0),
        "swell_spreading": (0.0, 0.0, 0.0),
    }  # fmt: skip
    both = SeaState("bretschneider", 1.0, 5.0, 0.2, **swell)
    waves, alone = both.waves(), SeaState("bretschneider", 1.0, 5.0, 0.2).waves()
    share = {
        direction: 4 * math.sqrt(np.sum(waves.amplitude[waves.direction == direction] ** 2) / 2)
        for direction in (0.2, 1.0, -2.0)
    }
    assert share == pytest.approx({0.2: 1.0, 1.0: 1.5, -2.0: 0.5}, rel=5e-3)
    count = len(alone.omega)
    np.testing.assert_array_equal(waves.amplitude[:count], alone.amplitude)  # the sea as before
    np.testing.assert_array_equal(waves.phase[:count], alone.phase)
    w = np.linspace(0.2, 3.0, 50)
    trains = [Jonswap(1.0, 5.0, 1.0), Jonswap(1.5, 14.0, 7.0), Jonswap(0.5, 18.0, 1.0)]
    expected = sum(train.density(w) for train in trains)
    np.testing.assert_allclose(both.spectrum_of_it().density(w), expected, rtol=1e-12)


def test_a_swell_may_be_alone_and_must_not_break():
    one = dict.fromkeys(("swell_direction", "swell_spreading"), (0.0,)) | {"swell_gamma": (7.0,)}
    swell = SeaState(swell_height=(1.0,), swell_period=(12.0,), **one)
    assert not swell.is_calm
    assert 4 * swell.waves().elevation(0.0, np.random.default_rng(1).uniform(0, 9e4, (4000, 2))).std() \
        == pytest.approx(1.0, rel=0.1)  # fmt: skip
    with pytest.raises(InputError, match="swell 1: height 9 m at a period of 3 s"):
        SeaState(swell_height=(9.0,), swell_period=(3.0,), **one).waves()
    with pytest.raises(InputError, match=r"swell 1: period is 0\.0 s"):
        SeaState(swell_height=(1.0,), swell_period=(0.0,), **one).waves()
