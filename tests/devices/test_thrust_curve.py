"""Thrust of a command and its inverse, against the polynomial solved by bisection."""

import numpy as np
import pytest
from scipy.optimize import brentq

from seatrial.devices.actuators.polynomial_thruster import PolynomialThruster
from seatrial.physics.thrust_curve import T200_BENCHMARK, command_of

from .running import started

MOST_INSIDE = (3.0, -1.0 / 0.8**2, 0.0, 0.0, 0.0)  # rises up to 0.8
MOST_OUTSIDE = (3.0, -1.0 / 1.05**2, 0.0, 0.0, 0.0)
# Its derivative is (V^2 - 0.25)^2 + 0.04: it has complex roots, and no maximum.
RISES = (0.1025, -0.5 / 3, 1.0 / 5, 0.0, 0.0)


def thrust(coefficients, V):
    return sum(c * V**power for c, power in zip(coefficients, (1, 3, 5, 7, 9), strict=True))


@pytest.mark.parametrize("coefficients", [T200_BENCHMARK, MOST_INSIDE, MOST_OUTSIDE, RISES])
def test_a_command_gives_the_thrust_asked_for(coefficients):
    places = np.linspace(0.0, 1.0, 100_001)
    most = float(places[np.argmax(thrust(coefficients, places))])
    for share in (-0.9, -0.3, 0.2, 0.6, 0.95):
        wanted = thrust(coefficients, share * most)
        expected = brentq(lambda V, w=wanted: thrust(coefficients, V) - w, -most, most)
        # Linear in 2001 rows, whose distance squared times the curvature of a T200 is 1e-6.
        assert command_of(coefficients, wanted) == pytest.approx(expected, abs=1e-5)
    beyond = 1.1 * thrust(coefficients, most)
    assert command_of(coefficients, beyond) == pytest.approx(most, abs=1e-5)
    assert command_of(coefficients, -beyond) == pytest.approx(-most, abs=1e-5)
    assert command_of(coefficients, 0.0) == 0.0


def test_a_thruster_knows_its_curve_both_ways():
    curve = (8.0, 150.0, -310.0, 290.0, -99.0)
    made = started(PolynomialThruster, thrust_curve=curve)
    for V in (-1.4, -1.0, -0.6, 0.0, 0.3, 0.9, 2.0):
        held = min(max(V, -1.0), 1.0)
        assert made.thrust_of(V) == pytest.approx(thrust(curve, held))
        assert made.command_of(thrust(curve, held)) == pytest.approx(held, abs=1e-5)
    assert made.rises()
    assert not started(PolynomialThruster, thrust_curve=(-1.0, 2.0, 0.0, 0.0, 0.0)).rises()
