"""Thrusters behind speed controllers: thrust to pulse."""

from __future__ import annotations

import math

from ...errors import InputError
from ...model.component import Component, Parameter


class ThrusterPulses(Component):
    """Mix-in for who drives thrusters that are alike by servo pulses.

        |pulse - pulse_neutral| = dead_band + (span - dead_band) (|T| / T_max)^exponent

    span and T_max being those of the side (ahead: pulse_max, ``thrust_ahead``). With the
    defaults this inverts the T200's 16 V table within 3 % of full thrust (largest error 1.52 N);
    a dead band of 0 and the exponent 1/2 invert a thrust that goes by the square of the pulse.
    """

    thrust_ahead = Parameter(51.4, "N", "thrust of one thruster at pulse_max", min=1e-3)
    thrust_astern = Parameter(39.9, "N", "thrust astern of one thruster at pulse_min", min=1e-3)
    pulse_min = Parameter(1.1e-3, "s", "pulse of full thrust astern", min=0.0)
    pulse_neutral = Parameter(1.5e-3, "s", "pulse of no thrust", min=0.0)
    pulse_max = Parameter(1.9e-3, "s", "pulse of full thrust ahead", min=0.0)
    dead_band = Parameter(26e-6, "s", "distance from neutral at which thrust begins", min=0.0)
    exponent = Parameter(0.75, "1", "of the share of full thrust", min=0.1, max=2.0)

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
        away = self._away(abs(thrust), full, abs(end - neutral))
        return neutral + math.copysign(away, thrust)

    def _away(self, thrust: float, full: float, span: float) -> float:
        """Return how far from neutral, of span (s), the pulse of a thrust (N, of full) is."""
        share = min(thrust / full, 1.0) ** self.exponent
        return float(self.dead_band + (span - self.dead_band) * share)
