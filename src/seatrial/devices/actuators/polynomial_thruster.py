"""Electric thruster with a polynomial thrust curve and a lag of third order."""

from __future__ import annotations

import math
from typing import ClassVar

from ...errors import InputError
from ...model.component import Input, Output, Parameter
from ...physics.thrust_curve import ThrustCurve
from .actuator import Actuator

_DEGREE = 16


class PolynomialThruster(ThrustCurve, Actuator):
    """Thruster whose thrust is an odd polynomial of its command V, behind a linear lag.

        T(V) = c1 V + c3 V^3 + c5 V^5 + c7 V^7 + c9 V^9,   V = command, held within -1 and 1
        thrust = (b1 s + a0) / (s^3 + a2 s^2 + a1 s + a0) T(V)

    ``thrust_curve`` is (c1, c3, c5, c7, c9), ``lag_zero`` b1, ``lag_poles`` (a0, a1, a2), with
    unit gain. With z' = (z2, z3, T - a0 z1 - a1 z2 - a2 z3), thrust = a0 z1 + b1 z2: exact by the
    matrix exponential for a command that is held over a step, whatever its length. ``thrust`` is
    along the axis, N, positive ahead; it never reacts to the command at the same instant.

    Defaults: the T200 of a BlueROV2 (von Benzon et al., J. Mar. Sci. Eng. 2022, 10, 1898, eq. 18):
    30.6 N at V = 0.97 and 30.4 N at 1, no dead band, 95 % after 0.12 s.

    Failures are those of `Actuator`.

    Not modelled: loss of thrust with the speed of the water through the propeller, supply
    voltage, a dead band.

    Raises InputError at the start for a lag that is not stable.
    """

    lag_zero = Parameter(6136.0, "1/s2", "b1 of the lag")
    lag_poles = Parameter(
        (108700.0, 9258.0, 89.0),
        ("1/s3", "1/s2", "1/s"),
        "denominator of the lag below s^3",
        axes=("s0", "s1", "s2"),
    )

    command = Input("1", "V, -1 to 1, positive ahead", role="command")
    thrust = Output("N", "thrust along the axis, positive ahead")

    exercised: ClassVar = {"lag_zero": 5000.0}

    def start(self, t: float) -> None:
        """Start at rest; raises InputError for a lag that is not stable."""
        a0, a1, a2 = self.lag_poles
        if not (a0 > 0.0 and a2 > 0.0 and a1 * a2 > a0):  # Routh
            raise InputError(
                f"{self.name}.lag_poles is {list(self.lag_poles)}, whose lag is not stable: s0 and "
                "s2 must be positive, and s1 s2 greater than s0"
            )
        self._lag = [0.0, 0.0, 0.0]
        self._left = 1.0
        self._duration = 0.0
        self._kept = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        self.begin_at(0.0)

    def step(self, t: float, h: float) -> None:
        """Follow the thrust of the command as it is."""
        received = self.take(t, [self.command], [-1.0], [1.0])
        self._left = 1.0 if received is None else self.effect
        command = 0.0 if received is None else received[0]
        steady = self.thrust_of(command) / self.lag_poles[0]
        away = self._lag[0] - steady, self._lag[1], self._lag[2]
        kept = self._transition(h / self.slowness)
        first, *others = [sum(k * z for k, z in zip(row, away, strict=True)) for row in kept]
        self._lag = [first + steady, *others]

    def outputs(self, t: float) -> None:
        """Publish the thrust."""
        z = self._lag
        self.thrust = self._left * (self.lag_poles[0] * z[0] + self.lag_zero * z[1])

    def _transition(self, duration: float) -> list[list[float]]:
        """Return the matrix that takes the lag's state over a duration, s."""
        if duration != self._duration:
            self._duration, self._kept = duration, companion_exponential(self.lag_poles, duration)
        kept: list[list[float]] = self._kept
        return kept


def companion_exponential(poles: tuple[float, float, float], t: float) -> list[list[float]]:
    """Return exp(A t) of A = (0 1 0; 0 0 1; -a0 -a1 -a2), ``poles`` = (a0, a1, a2), a0 > 0.

    In states z_i / w^i, w = a0^(1/3), A is w (0 1 0; 0 0 1; -1 -a1/w^2 -a2/w), of moderate size.
    Its exponential is the Taylor polynomial of degree 16 after halving to a norm of 1/2 or less,
    squared as often (Higham, Functions of Matrices, 2008, section 10.3): what is left out is below
    1e-19.
    """
    a0, a1, a2 = poles
    w = a0 ** (1.0 / 3.0)
    last = [-1.0, -a1 / w**2, -a2 / w]
    norm = w * t * max(1.0, abs(last[0]) + abs(last[1]) + abs(last[2]))
    halvings = max(0, math.ceil(math.log2(norm)) + 1) if norm > 0.0 else 0
    part = w * t / 2.0**halvings
    A = [[0.0, part, 0.0], [0.0, 0.0, part], [part * each for each in last]]
    eye = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    found = eye
    for k in range(_DEGREE, 0, -1):  # Horner: I + A/1 (I + A/2 (I + ...))
        found = [
            [e + p / k for e, p in zip(one, other, strict=True)]
            for one, other in zip(eye, _product(A, found), strict=True)
        ]
    for _ in range(halvings):
        found = _product(found, found)
    scale = (1.0, w, w**2)
    return [
        [scale[i] * value / scale[j] for j, value in enumerate(row)] for i, row in enumerate(found)
    ]


def _product(a: list[list[float]], b: list[list[float]]) -> list[list[float]]:
    return [[row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j] for j in range(3)] for row in a]
