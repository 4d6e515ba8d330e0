"""Servo commanded by an angle."""

from __future__ import annotations

import math

from ...errors import InputError
from ...model.component import Input, Output, Parameter
from ...model.sampled import Sampled
from ..fault import SHARE_WRONG
from .actuator import Actuator


class AngleServo(Actuator, Sampled):
    """Position servo with range and rate, moved every ``period`` by a command in radians.

        angle_k = angle_(k-1) + e limited to +-(rate period),
        e = command limited to angle_min ... angle_max, less angle_(k-1)

    The move belongs to the instant: it is on the output at once and stays until the next
    instant. A servo that turns evenly through the period is on average half a period later.
    ``angle_(-1)`` is ``angle_start``. Angles rad, rate rad/s.

    Failures are those of `Actuator`; the shaft of a wrong one, within its range, is a tenth of the
    range further than it should be.

    Not modelled: acceleration, load torque, backlash, resolution.

    Raises InputError at the start if the angles do not rise, or ``angle_start`` lies outside
    the range.
    """

    period = Parameter(0.02, "s", "time between two moves", min=1e-6)
    angle_min = Parameter(-math.pi / 2, "rad", "least angle")
    angle_max = Parameter(math.pi / 2, "rad", "greatest angle")
    angle_start = Parameter(0.0, "rad", "angle before the first move")
    rate = Parameter(math.radians(120.0), "rad/s", "speed of the shaft", min=1e-9)

    command = Input("rad", "angle wanted", role="command")
    angle = Output("rad", "angle of the shaft")
    speed = Output("rad/s", "rate of the shaft, mean of the period that ends with this move")

    def reset(self, t: float) -> None:
        """Start at rest; raises InputError for angles out of order."""
        if not self.angle_min < self.angle_max:
            raise InputError(
                f"{self.name}: angle_min must be less than angle_max, got {self.angle_min!r} and "
                f"{self.angle_max!r} rad"
            )
        if not self.angle_min <= self.angle_start <= self.angle_max:
            raise InputError(
                f"{self.name}.angle_start is {self.angle_start!r} rad, allowed "
                f"{self.angle_min!r} to {self.angle_max!r} rad"
            )
        self._angle: float = self.angle_start
        self.begin_at(self.angle_start)

    def sample(self, t: float, k: int) -> None:
        """Move towards the command."""
        self.angle = self._moved(t)
        self.speed = (self.angle - self._angle) / self.period

    def _moved(self, t: float) -> float:
        """Return the angle after the move of this instant."""
        received = self.received(t, [self.command], [self.angle_min], [self.angle_max])
        if received is None or self.fault == "stuck":
            return self._angle
        wanted = min(max(received[0], self.angle_min), self.angle_max)
        if self.fault == "wrong":
            further = SHARE_WRONG * (self.angle_max - self.angle_min)
            wanted = min(wanted + further, self.angle_max)
        most = self.rate * self.period / self.slowness
        move: float = min(max(wanted - self._angle, -most), most)
        return self._angle + move

    def update(self, t: float, k: int) -> None:
        """Remember where the shaft is."""
        self._angle = self.angle
        self.take(t, [self.command], [self.angle_min], [self.angle_max])
