"""A sea as it is: hours that differ, heights of its waves, several trains at once."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.sea.seastate import SeaState
from seatrial.physics.sea.spectra import Jonswap

HEIGHT, PERIOD = 2.0, 8.0
HOUR, STEP, HOURS, SEEDS = 3600.0, 0.5, 3, 10
WIDTH = 0.6594 * 2 * math.pi / PERIOD
"""m0^2 / int S^2 dw of JONSWAP, gamma 3.3, rad/s."""


def record(state):
    """Return the elevation at the origin over three hours."""
    waves, block = state.waves(), 300.0
    starts = np.arange(0.0, HOURS * HOUR, block)
    within = np.exp(1j * np.outer(np.arange(0.0, block, STEP), waves.omega))
    begun = waves.amplitude * np.exp(1j * (np.outer(starts, waves.omega) + waves.phase))
    return np.real(within @ begun.T).T.ravel()


@pytest.fixture(scope="module")
def records():
    states = (
        SeaState("jonswap", HEIGHT, PERIOD, seed=s, components_per_octave=0) for s in range(SEEDS)
    )
    return [record(state) for state in states]


def variation(all_records):
    hours = np.concatenate([r.reshape(HOURS, -1) for r in all_records])
    heights = 4 * hours.std(axis=1)
    return heights.mean(), heights.std(ddof=1) / heights.mean()


def test_hours_differ_as_those_of_a_gaussian_sea(records):
    # Of a Gaussian record: CoV(Hm0) = 0.5 sqrt(2 pi / (W T)), 2.9 % here.
    expected = 0.5 * math.sqrt(2 * math.pi / (WIDTH * HOUR))
    mean, found = variation(records)
    count = HOURS * SEEDS
    assert mean == pytest.approx(HEIGHT, rel=3 * expected / math.sqrt(count))
    assert found == pytest.approx(expected, rel=3 / math.sqrt(2 * count))  # 3 standard errors


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
    # Linear narrow seas: H1/3 = 0.964 Hm0 and a mean of 0.605 Hm0 for gamma 3.3 (sea.md, section 2).
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
