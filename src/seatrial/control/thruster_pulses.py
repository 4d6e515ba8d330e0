"""Thrusters behind speed controllers: thrust to pulse."""

from __future__ import annotations

import math

from ..component import Component, Parameter
from ..errors import InputError


class ThrusterPulses(Component):
    """Mix-in for who drives thrusters that are alike by servo pulses.

        |pulse - pulse_neutral| = dead_band + (span - dead_band) (|T| / T_max)^0.75

    span and T_max being those of the side (ahead: pulse_max, ``thrust_ahead``). With the
    defaults this inverts the T200's 16 V table within 3 % of full thrust (largest error 1.52 N).
    """

    thrust_ahead = Parameter(51.4, "N", "thrust of one thruster at pulse_max", min=1e-3)
    thrust_astern = Parameter(39.9, "N", "thrust astern of one thruster at pulse_min", min=1e-3)
    pulse_min = Parameter(1.1e-3, "s", "pulse of full thrust astern", min=0.0)
    pulse_neutral = Parameter(1.5e-3, "s", "pulse of no thrust", min=0.0)
    pulse_max = Parameter(1.9e-3, "s", "pulse of full thrust ahead", min=0.0)
    dead_band = Parameter(26e-6, "s", "distance from neutral at which thrust begins", min=0.0)

    def check_pulses(self) -> None:
        """Raise InputError if the pulses do not rise."""
        if not self.pulse_min < self.pulse_neutral < self.pulse_max:
            raise InputError(
                f"{self.name}: pulse_min, pulse_neutral and pulse_max must rise, got "
                f"{self.pulse_min!r}, {self.pulse_neutral!r}, {self.pulse_max!r} s"
            )

    def pulse_of(self, thrust: float) -> float:
        """Return the pulse (s) that gives a thrust (N, positive ahead)."""
        neutral: float = self.pulse_neutral
        if thrust == 0.0:
            return neutral
        end = self.pulse_max if thrust > 0.0 else self.pulse_min
        full = self.thrust_ahead if thrust > 0.0 else self.thrust_astern
        share = min(abs(thrust) / full, 1.0) ** 0.75
        span = abs(end - neutral)
        away = self.dead_band + (span - self.dead_band) * share
        return neutral + math.copysign(away, thrust)
