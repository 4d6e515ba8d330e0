"""Two fixed thrusters, port and starboard, behind speed controllers: force to pulse."""

from __future__ import annotations

import math
from typing import ClassVar

from ..component import Component, Output, Parameter, terminal
from ..errors import InputError


class TwinThrusters(Component):
    """Base of the allocation to a pair of thrusters: surge force X and yaw moment N to pulses.

    What the thrusters cannot give is cut off, moment first. **Allocation**: T_port = X / 2 +
    N / (2 d), T_starboard = X / 2 - N / (2 d), d = ``half_beam``; port ahead turns to starboard
    (N > 0). Thrust to pulse by

        |pulse - pulse_neutral| = dead_band + (span - dead_band) (|T| / T_max)^0.75

    span and T_max being those of the side (ahead: pulse_max, ``thrust_ahead``). With the
    defaults this inverts the T200's 16 V table within 3 % of full thrust (largest error 1.52 N).
    """

    half_beam = Parameter(0.4, "m", "thrusters from the centre line", min=1e-3)
    thrust_ahead = Parameter(51.4, "N", "thrust of one thruster at pulse_max", min=1e-3)
    thrust_astern = Parameter(39.9, "N", "thrust astern of one thruster at pulse_min", min=1e-3)
    pulse_min = Parameter(1.1e-3, "s", "pulse of full thrust astern", min=0.0)
    pulse_neutral = Parameter(1.5e-3, "s", "pulse of no thrust", min=0.0)
    pulse_max = Parameter(1.9e-3, "s", "pulse of full thrust ahead", min=0.0)
    dead_band = Parameter(26e-6, "s", "distance from neutral at which thrust begins", min=0.0)

    pulse_port = Output("s", "pulse to the port thruster", start=1.5e-3)
    pulse_starboard = Output("s", "pulse to the starboard thruster", start=1.5e-3)

    terminals: ClassVar = {"actuators": terminal(port="pulse_port", starboard="pulse_starboard")}

    def _check_pulses(self) -> None:
        """Raise InputError if the pulses do not rise."""
        if not self.pulse_min < self.pulse_neutral < self.pulse_max:
            raise InputError(
                f"{self.name}: pulse_min, pulse_neutral and pulse_max must rise, got "
                f"{self.pulse_min!r}, {self.pulse_neutral!r}, {self.pulse_max!r} s"
            )

    def _possible(
        self, surge: float, moment: float, most_surge: float, most_moment: float
    ) -> tuple[float, float]:
        """Return what limits (N, N.m) and the thrusters leave of a demand, moment first."""
        ahead, astern = self.thrust_ahead, self.thrust_astern
        largest = min(most_moment, 2.0 * self.half_beam * min(ahead, astern))
        moment = min(max(moment, -largest), largest)
        used = abs(moment) / (2.0 * self.half_beam)
        most = min(most_surge, 2.0 * (ahead - used))
        least = -min(most_surge, 2.0 * (astern - used))
        return min(max(surge, least), most), moment

    def _drive(self, surge: float, moment: float) -> None:
        """Publish the pulses of a demand that the thrusters can give."""
        turning = moment / (2.0 * self.half_beam)
        self.pulse_port = self._pulse(0.5 * surge + turning)
        self.pulse_starboard = self._pulse(0.5 * surge - turning)

    def _pulse(self, thrust: float) -> float:
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
