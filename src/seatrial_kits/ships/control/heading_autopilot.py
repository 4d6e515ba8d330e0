"""Heading autopilot of a ship with a rudder."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled

from .wave_filter import WaveFiltered, unwrapped


class HeadingAutopilot(WaveFiltered, Sampled):
    """PID control of the heading: delta = Kp e + Kd e' + delta_I ([Moro1979], eqs 8 and 9).

    e = heading - reference, wrapped to +-pi; e' = yaw_rate - reference_rate. With the source's
    K and T_d (dimensionless) Kp = K and Kd = K T_d L / U. The source has no integral action;
    here delta_I grows at Ki e, so that no steady disturbance leaves an offset. The command is
    held to ``rudder_limit``, and back-calculation at the rate Ki / Kp removes from delta_I what
    was cut off. ``integral_gain`` = 0 is the PD law of the source.

    Sign: a positive rudder turns to port, and a positive e is a ship too far to starboard, so
    that positive gains are negative feedback.

    With ``wave_frequency`` the measured heading and rate go through a notch (`WaveFiltered`), so
    that the rudder does not answer what waves do; its lag costs phase margin, about
    2 w_c/``wave_frequency`` rad at a crossover w_c. ``error`` is of the heading as measured.

    Angles rad, clockwise from north, any number of turns; rates rad/s, to starboard positive.
    ``reference_rate`` is 0 unless a reference model is connected (see `HeadingReference`).

    Defaults are the gains of [Moro1979] for the Mariner at 15 knots: K = 0.034 and
    T_d = 1.25379 with the rudder's effect in B as it must be (docs/kits/ships/mariner.md).
    """

    exercised: ClassVar = {"rudder_limit": 100.0, "integral_gain": 0.1, "wave_frequency": 0.8}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    proportional_gain = Parameter(0.860783, "1", "Kp", min=1e-9, tunable=True)
    derivative_gain = Parameter(22.504992, "s", "Kd", tunable=True)
    integral_gain = Parameter(0.0, "1/s", "Ki, 0 for none", min=0.0, tunable=True)
    rudder_limit = Parameter(
        0.6108652381980153, "rad", "largest command, to either side", min=1e-9, tunable=True
    )

    reference = Input("rad", "heading to hold, clockwise from north")
    reference_rate = Input("rad/s", "its derivative, to starboard positive")
    heading = Input("rad", "heading, clockwise from north")
    yaw_rate = Input("rad/s", "rate of yaw, to starboard positive")

    rudder = Output("rad", "angle asked of the rudder, positive to turn to port")
    error = Output("rad", "heading - reference, wrapped to +-pi")

    terminals: ClassVar = {
        "wanted": terminal(heading_wanted="reference", yaw_rate_wanted="reference_rate"),
        "sensors": terminal("heading", "yaw_rate"),
        "held": terminal("rudder"),
    }

    def reset(self, t: float) -> None:
        """Start with no integral, and a filter that has been at the heading for long."""
        self._integral = 0.0
        self.prepare_filter()
        self._heading = self.settled(self.heading)
        self._rate = self.settled(self.yaw_rate)

    def sample(self, t: float, k: int) -> None:
        """Command the rudder."""
        self.error = self._error()
        self.rudder = self._limited(self._wanted())

    def update(self, t: float, k: int) -> None:
        """Advance the integral."""
        wanted = self._wanted()
        cut_off = (self._limited(wanted) - wanted) / self.proportional_gain
        self._integral += self.period * self.integral_gain * (self._error() + cut_off)
        if self.wave_frequency > 0.0:
            self._heading = self.advanced(self._heading, self._unwrapped())
            self._rate = self.advanced(self._rate, self.yaw_rate)

    def _unwrapped(self) -> float:
        return unwrapped(self.heading, self._heading[2])

    def _error(self) -> float:
        return math.remainder(self.heading - self.reference, math.tau)

    def _wanted(self) -> float:
        error, rate = self._error(), self.yaw_rate
        if self.wave_frequency > 0.0:
            left = self.filtered(self._heading, self._unwrapped())
            error = math.remainder(left - self.reference, math.tau)
            rate = self.filtered(self._rate, rate)
        wanted: float = (
            self.proportional_gain * error
            + self.derivative_gain * (rate - self.reference_rate)
            + self._integral
        )
        return wanted

    def _limited(self, angle: float) -> float:
        limit: float = self.rudder_limit
        return min(max(angle, -limit), limit)
