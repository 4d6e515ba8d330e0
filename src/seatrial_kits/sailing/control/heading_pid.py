"""Heading control of a sailing boat by a PID law."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Parameter, terminal

from .heading import SailingHeading


class SailingHeadingPid(SailingHeading):
    """PID control of the heading, with the rudder of `SailingHeading`.

        e = wrap(heading_wanted - heading),  I_k = I_(k-1) + K_i e_k period
        yaw_moment = K_p e + I - K_d r cos(heel)

    [Silva2018], eq. 3.7, with the rate of the heading for its derivative. I grows before it is
    used, and not at an instant after one at which the rudder was at its limit; it is kept as a
    moment, so that a new K_i moves what comes and not what was found. The gains are the
    source's: poles at 0.76 rad/s with damping 0.6, for an inertia of 28.54 kg m2 and no
    damping of yaw by the hull.

    I is limited to +-``integral_limit``. A long turn fills the integral, and where the
    rudder is at its limit afterwards the freeze keeps it so: the boat turns on.
    """

    exercised: ClassVar = {"rudder_limit": 100.0}

    K_p = Parameter(20.2, "N.m/rad", "moment per heading error", tunable=True)
    K_i = Parameter(2.3, "N.m/(rad.s)", "rate of the integral term", tunable=True)
    K_d = Parameter(30.0, "N.m.s/rad", "moment against the rate of the heading", tunable=True)
    integral_limit = Parameter(
        1e6, "N.m", "greatest moment of the integral term", min=0.0, tunable=True
    )

    heel = Input("rad", "heel, starboard down")

    terminals: ClassVar = {
        **SailingHeading.terminals,
        "sensors": terminal("heading", "heel"),
    }

    def reset(self, t: float) -> None:
        """Start with an empty integral."""
        super().reset(t)
        self._integral = 0.0

    def moment(self) -> float:
        """Return the moment of the PID law, N.m."""
        turning = self.nu[3] * math.cos(self.heel)
        moment: float = self.K_p * self._error() + self._grown() - self.K_d * turning
        return moment

    def update(self, t: float, k: int) -> None:
        """Remember the integral."""
        self._integral = self._grown()
        super().update(t, k)

    def _error(self) -> float:
        return math.remainder(self.heading_wanted - self.heading, math.tau)

    def _grown(self) -> float:
        """Return the integral at this instant, N.m."""
        growth = 0.0 if self.saturated else self.K_i * self._error() * self.period
        most: float = self.integral_limit
        return min(max(self._integral + growth, -most), most)
