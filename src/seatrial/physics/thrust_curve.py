"""Static thrust of a thruster as an odd polynomial of its command, and its inverse."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from ..model.component import Component, Parameter
from ..model.expressions import Vector

_POWERS = (1, 3, 5, 7, 9)
COEFFICIENTS = tuple(f"c{power}" for power in _POWERS)
_ROWS = 2001
T200_BENCHMARK = (8.9, 176.0, -404.1, 389.9, -140.3)
"""von Benzon et al., J. Mar. Sci. Eng. 2022, 10, 1898, eq. 18: a BlueROV2's T200, N."""


class ThrustCurve(Component):
    """Mix-in: T(V) = c1 V + c3 V^3 + c5 V^5 + c7 V^7 + c9 V^9, V held within -1 and 1."""

    thrust_curve = Parameter(
        T200_BENCHMARK,
        "N",
        "coefficients of the thrust by powers of the command",
        axes=COEFFICIENTS,
    )

    def thrust_of(self, command: float) -> float:
        """Return the thrust, N, of a command."""
        V = min(max(command, -1.0), 1.0)
        total = 0.0
        for coefficient in reversed(self.thrust_curve):
            total = total * V * V + coefficient
        return float(total * V)

    def rises(self) -> bool:
        """Say if the thrust rises from command 0 on, so that `command_of` can be asked."""
        return bool(_rising(tuple(self.thrust_curve))[1][1] > 0.0)

    def command_of(self, thrust: float) -> float:
        """Return the command of a thrust, N; see `command_of`."""
        return command_of(tuple(self.thrust_curve), thrust)


def command_of(coefficients: tuple[float, ...], thrust: float) -> float:
    """Return the command of a thrust, N, up to where the thrust no longer rises.

    ``coefficients`` are (c1, c3, c5, c7, c9). From a table of 2001 rows, within 2e-5 N for a T200.
    """
    commands, thrusts = _rising(coefficients)
    return math.copysign(float(np.interp(abs(thrust), thrusts, commands)), thrust)


@lru_cache
def _rising(coefficients: tuple[float, ...]) -> tuple[Vector, Vector]:
    """Return commands from 0 to the first maximum in (0, 1], and their thrusts, N."""
    by_power = np.zeros(_POWERS[-1] + 1)
    by_power[list(_POWERS)] = coefficients
    curve = np.polynomial.Polynomial(by_power)
    roots = curve.deriv().roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    commands = np.linspace(0.0, min(real[(real > 0.0) & (real < 1.0)], default=1.0), _ROWS)
    return commands, curve(commands)
