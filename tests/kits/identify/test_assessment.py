"""Fit, whiteness and rules of rejection."""

import numpy as np
import pytest

from seatrial_kits.identify.assessment import fit, verdicts, whiteness
from seatrial_kits.identify.output_error import Estimate, Structure
from seatrial_kits.identify.prediction import UNKNOWNS


def estimate(thrust=10.0, delay=2):
    values = dict.fromkeys(UNKNOWNS, 0.0) | {"thrust": thrust}
    nothing = np.zeros((1, 1))
    return Estimate(values, Structure(), ("thrust",), nothing, nothing, delay, {}, np.zeros(3))


def kept(**changes):
    case = {"thrust": 10.0, "delay": 2, "fit": 0.9, "mass": 6.5, "full": 93.4} | changes
    found = verdicts(estimate(case["thrust"], case["delay"]), 0.1, case["fit"], case["mass"], case["full"])  # fmt: skip
    return [verdict.passed for verdict in found]


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, [True, True, True, True]),
        ({"thrust": -10.0}, [False, True, True, False]),
        ({"delay": 5}, [True, True, True, True]),
        ({"delay": 6}, [True, False, True, True]),
        ({"fit": 0.70}, [True, True, False, True]),
        ({"mass": 9.35}, [True, True, True, False]),  # total 9.34
        ({"mass": 3.12}, [True, True, True, True]),
        ({"mass": 3.11}, [True, True, True, False]),
        # [Paulino2015], table 7.4: what it says of surge.
        ({"thrust": -0.2096, "delay": 35}, [False, False, True, False]),
    ],
)
def test_rules(changes, expected):
    assert kept(**changes) == expected


def test_fit():
    y = np.array([1.0, 2.0, 3.0, 4.0])
    assert fit(y, y) == 1.0
    assert fit(y, np.full(4, 2.5)) == 0.0
    assert fit(y, 2.5 + 0.75 * (y - 2.5)) == pytest.approx(0.75)


def test_white_noise_passes_and_a_filtered_one_does_not():
    white = [whiteness(np.random.default_rng(k).normal(size=800)) for k in range(40)]
    # 25 lags at 5 %: 1.25 outside on average; of 40 residuals 0.3 are expected to fail.
    assert sum(found.white for found in white) >= 38
    assert 0.6 < np.mean([found.outside for found in white]) < 1.9
    noise = np.random.default_rng(1).normal(size=801)
    assert not whiteness(noise[1:] + 0.5 * noise[:-1]).correlation[0] < 0.3
    lagging = np.convolve(noise, 0.8 ** np.arange(20))[:800]
    assert not whiteness(lagging).white
