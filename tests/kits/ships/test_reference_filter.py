"""The reference model of the heading against its linear equation in closed form."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial_kits.ships.control.reference_filter import HeadingReference
from tests.devices.running import run, started

W, ZETA = 0.05, 1.0
SYSTEM = np.array([[0, 1, 0], [0, 0, 1], [-(W**3), -3 * W**2, -3 * W]])
WIDE = {"natural_frequency": W, "damping_ratio": ZETA, "rate_limit": 1.0}


def followed(stop_ms, target, step_ms=100, **values):
    reference = started(HeadingReference, **{**WIDE, "target": target, **values})
    rows = np.array(run(reference, ["heading", "rate"], stop_ms, step_ms))
    return rows[:, 0], rows[:, 1]


@pytest.mark.parametrize("zeta", [0.7, 1.0, 1.5])
def test_linear_response_is_that_of_the_equation(zeta):
    a2 = (2 * zeta + 1) * W
    system = np.array([[0, 1, 0], [0, 0, 1], [-(W**3), -a2 * W, -a2]])
    heading, rate = followed(200000, 0.4, damping_ratio=zeta)
    for k in range(0, 2001, 100):
        psi, r, _ = expm(0.1 * k * system) @ [-0.4, 0, 0] + [0.4, 0, 0]
        assert heading[k] == pytest.approx(psi, abs=1e-10)
        assert rate[k] == pytest.approx(r, abs=1e-11)


def test_poles_are_those_that_are_said():
    a2 = 2 * 0.8 + 1
    poles = np.sort_complex(np.roots([1, a2 * W, a2 * W**2, W**3]))
    pair = np.roots([1, 2 * 0.8 * W, W**2])
    np.testing.assert_allclose(poles, np.sort_complex([-W, *pair]), rtol=1e-9)


@pytest.mark.parametrize("target", [2.0, -2.0])
def test_rate_keeps_its_limit_and_the_heading_arrives(target):
    heading, rate = followed(600000, target, rate_limit=0.01)
    assert np.abs(rate).max() == 0.01
    assert heading[-1] == pytest.approx(target, abs=1e-6)
    assert np.abs(heading).max() < abs(target) * 1.001
    middle = slice(1000, 1500)
    np.testing.assert_allclose(rate[middle], math.copysign(0.01, target), rtol=1e-3)
    # The rate that is published is the slope of the heading.
    np.testing.assert_allclose(np.diff(heading)[middle], 0.1 * rate[middle], rtol=1e-3)


def test_turns_the_shorter_way_and_counts_turns():
    heading, _ = followed(600000, math.radians(-170), heading_start=math.radians(170))
    assert heading[0] == math.radians(170)
    assert heading[-1] == pytest.approx(math.radians(190), abs=1e-9)
    assert np.diff(heading).min() > -1e-9


@pytest.mark.parametrize("step_ms", [50, 100, 300])
def test_communication_step_changes_nothing(step_ms):
    heading, _ = followed(60000, 0.4, step_ms)
    expected, _ = followed(60000, 0.4, 100)
    if step_ms < 100:
        np.testing.assert_array_equal(heading[::2], expected)
    else:
        np.testing.assert_array_equal(heading, expected[:: step_ms // 100])
