"""Nomoto's model of second order, against responses by scipy.signal."""

import math

import numpy as np
import pytest
from scipy.signal import lsim

from seatrial.errors import InputError
from seatrial_kits.sea_trials.figures.nomoto import nomoto_second
from seatrial_kits.sea_trials.figures.record import Record

K, T1, T2, T3 = 0.185, 118.0, 7.8, 18.5
"""Of a cargo ship of the Mariner class (Chislett and Stroem-Tejsen 1965)."""
OFFSET = math.radians(0.3)


def record(noise=0.0, seed=0, lags=(T1, T2, T3)):
    """Return half an hour at 1 Hz, helm 10 deg to alternate sides for a minute or more."""
    time = np.arange(0.0, 1800.0)
    turns = np.cumsum([0.0, 60.0, 140.0, 120.0, 170.0, 90.0, 150.0, 200.0, 110.0, 180.0, 240.0])
    corners = np.concatenate([(at, at + 4.0) for at in turns])
    sides = np.repeat([0.0, *(math.radians(10.0) * (-1.0) ** n for n in range(len(turns)))], 2)
    helm = np.interp(time, corners, sides[1:-1])
    one, two, three = lags
    model = ([K * three, K], [one * two, one + two, 1.0, 0.0])
    _, heading, _ = lsim(model, helm + OFFSET, time)
    error = noise * np.random.default_rng(seed).standard_normal(len(time))
    return Record(time, 7.0 * time, 0.0 * time, heading + error, helm)


def test_without_noise_it_is_exact():
    found = nomoto_second(record())
    values = found.K, found.T1, found.T2, found.T3
    assert values == pytest.approx((K, T1, T2, T3), rel=1e-3)


def test_with_noise_of_a_compass_intervals_hold_the_time_constants():
    found = [nomoto_second(record(math.radians(0.1), seed)) for seed in range(20)]
    for place, true in enumerate((K, T1, T2, T3)):
        inside = sum(
            abs((each.K, each.T1, each.T2, each.T3)[place] - true) < 1.96 * each.deviations[place]
            for each in found
        )
        assert inside >= 16  # fewer of 20 have a probability of 1 in 390


def test_a_vessel_of_first_order_has_no_second_one():
    with pytest.raises(InputError, match="shows a vessel of first order"):
        nomoto_second(record(math.radians(0.1), lags=(T1, T2, T2)))
