"""Servo pulses: the range that a channel's calibration gives, and shares of it."""

from __future__ import annotations

import math

from ...errors import InputError
from ...model.component import Component, Parameter


class PulseRange(Component):
    """Mix-in for what takes or gives servo pulses: a share from -1 to 1 is a width.

    Linear on either side of neutral: ``pulse_min`` is -1, ``pulse_neutral`` 0, ``pulse_max`` 1;
    with ``reversed`` = 1 the shares have the other sign. A width of 0 is no pulse.
    """

    pulse_min = Parameter(1.1e-3, "s", "pulse of the lower end: least angle, full astern", min=0.0)
    pulse_neutral = Parameter(1.5e-3, "s", "pulse of the middle of the range, or stop", min=0.0)
    pulse_max = Parameter(
        1.9e-3, "s", "pulse of the upper end: greatest angle, full ahead", min=0.0
    )
    reversed = Parameter(0.0, "1", "1 if it acts the other way", min=0.0, max=1.0)

    def check_pulses(self) -> None:
        """Raise InputError if the pulses do not rise."""
        if not self.pulse_min < self.pulse_neutral < self.pulse_max:
            raise InputError(
                f"{self.name}: pulse_min, pulse_neutral and pulse_max must rise, got "
                f"{self.pulse_min!r}, {self.pulse_neutral!r}, {self.pulse_max!r} s"
            )

    def share_of(self, pulse: float) -> float:
        """Return the share that a pulse (s) asks for, held at -1 and 1 beyond the range."""
        away = pulse - self.pulse_neutral
        span = (self.pulse_max if away > 0.0 else self.pulse_min) - self.pulse_neutral
        share = math.copysign(min(away / span, 1.0), away)
        return -share if self.reversed else share

    def pulse_of(self, share: float) -> float:
        """Return the pulse (s) that asks for a share, held at the ends beyond -1 and 1."""
        own = -share if self.reversed else share
        span = (self.pulse_max if own > 0.0 else self.pulse_min) - self.pulse_neutral
        pulse: float = self.pulse_neutral + min(abs(own), 1.0) * span
        return pulse


class AngleRange(Component):
    """Mix-in for shafts: ``angle_min`` and ``angle_max``, rad, are the ends of their range."""

    angle_min = Parameter(-math.pi / 4, "rad", "angle at pulse_min")
    angle_max = Parameter(math.pi / 4, "rad", "angle at pulse_max")

    def check_angles(self) -> None:
        """Raise InputError if the angles do not rise."""
        if not self.angle_min < self.angle_max:
            raise InputError(
                f"{self.name}: angle_min must be less than angle_max, got {self.angle_min!r} and "
                f"{self.angle_max!r} rad"
            )

    @property
    def middle(self) -> float:
        """Angle half-way, rad."""
        return float(0.5 * (self.angle_min + self.angle_max))

    @property
    def half_range(self) -> float:
        """Angle from the middle to either end, rad."""
        return float(0.5 * (self.angle_max - self.angle_min))
