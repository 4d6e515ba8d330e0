"""Driver of a stepper motor: angle in, counted steps out."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Input, Output, Parameter
from seatrial.model.sampled import Sampled


class StepperDriver(Sampled):
    """Pulses that turn the shaft of a `Stepper` to an angle, along a trapezium of speed.

    Every ``period`` T, with e the steps to the angle wanted (limited to its range) and v steps
    per second:

        |v_k| <= rate,    |v_k - v_(k-1)| <= acceleration T,
        |v_k| <= (sqrt(T^2 a^2 + 8 a |e|) - T a) / 2    so that it can stop in |e|

    It counts what it sends and knows no other angle: steps that the motor loses stay lost.
    ``steps_per_turn``, ``microsteps``, ``gear`` and ``angle_start`` are those of the motor. Angles
    and rates are those of the shaft, rad, rad/s, rad/s2.

    Raises InputError at the start for angles that do not rise, or a start outside of them.
    """

    exercised: ClassVar = {"period": 0.01}

    period = Parameter(0.005, "s", "time between two speeds", min=1e-6)
    steps_per_turn = Parameter(200.0, "1", "full steps of a turn of the motor", min=4.0)
    microsteps = Parameter(8.0, "1", "pulses of a full step", min=1.0, max=256.0)
    gear = Parameter(20.0, "1", "turns of the motor for one of the shaft", min=1e-3)
    angle_start = Parameter(0.0, "rad", "angle of the shaft at the start")
    angle_min = Parameter(-math.pi / 2, "rad", "least angle")
    angle_max = Parameter(math.pi / 2, "rad", "greatest angle")
    rate = Parameter(math.radians(45.0), "rad/s", "speed of the shaft", min=1e-9)
    acceleration = Parameter(math.radians(360.0), "rad/s2", "acceleration of it", min=1e-9)

    angle = Input("rad", "angle wanted")
    steps = Output("1", "pulses counted since the start", type=int)
    counted = Output("rad", "angle of the shaft if no step is lost")

    def reset(self, t: float) -> None:
        """Start at rest; raises InputError for angles out of order."""
        if not self.angle_min <= self.angle_start <= self.angle_max:
            raise InputError(
                f"{self.name}: angle_min <= angle_start <= angle_max is needed, got "
                f"{self.angle_min!r}, {self.angle_start!r}, {self.angle_max!r} rad"
            )
        self._per_rad = self.steps_per_turn * self.microsteps * self.gear / math.tau
        self._place, self._speed = 0.0, 0.0

    def sample(self, t: float, k: int) -> None:
        """Publish the pulses sent."""
        self.steps = round(self._place)
        self.counted = self.angle_start + self.steps / self._per_rad

    def update(self, t: float, k: int) -> None:
        """Choose the speed until the next instant."""
        wanted = min(max(self.angle, self.angle_min), self.angle_max) - self.angle_start
        left = round(wanted * self._per_rad) - self._place
        T, a = self.period, self.acceleration * self._per_rad
        if abs(left) <= 0.5 and abs(self._speed) <= a * T:
            self._place, self._speed = float(round(wanted * self._per_rad)), 0.0
            return
        stops = 0.5 * (math.sqrt((a * T) ** 2 + 8.0 * a * abs(left)) - a * T)
        most = min(self.rate * self._per_rad, stops)
        change = math.copysign(most, left) - self._speed
        self._speed += min(max(change, -a * T), a * T)
        self._place += self._speed * T
