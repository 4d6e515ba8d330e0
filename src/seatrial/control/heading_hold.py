"""Heading hold of an underwater vehicle by its horizontal thrusters."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Input, Output, Parameter, terminal
from .axis_hold import AxisHold


class HeadingHold(AxisHold):
    """PID control of the heading, from a compass: yaw moment, with the law of `AxisHold`.

    Headings rad, clockwise from north, any number of turns: error and rate go the shorter way.
    ``yaw_moment`` N.m, positive to starboard. [Paulino2015] controls the yaw rate only; this is
    ours.

    Defaults: inertia with added inertia of the VideoRay Pro 4, and half of the moment that its
    thrusters have.
    """

    exercised: ClassVar = {"capacity": 1e12, "rate_limit": 1e9, "damping_per_speed": 0.7}

    natural_frequency = Parameter(1.6, "rad/s", "w", min=1e-9, tunable=True)
    damping_ratio = Parameter(0.8, "1", "zeta", min=0.0, tunable=True)
    integral_pole = Parameter(0.2, "rad/s", "sigma", min=0.0, tunable=True)
    rate_filter = Parameter(0.05, "s", "time constant of the filtered rate", min=0.0, tunable=True)
    inertia = Parameter(0.1338, "kg.m2", "inertia in yaw with added inertia", min=1e-9)
    capacity = Parameter(4.7, "N.m", "largest moment", min=0.0, tunable=True)
    rate_limit = Parameter(0.4, "rad/s", "largest rate of the target", min=1e-9, tunable=True)
    damping = Parameter(0.0, "N.m.s/rad", "damping in yaw at rest", min=0.0, tunable=True)
    damping_per_speed = Parameter(
        0.0, "N.m.s2/(rad.m)", "damping in yaw per speed ahead", min=0.0, tunable=True
    )

    heading_wanted = Input("rad", "heading to hold, clockwise from north")
    heading = Input("rad", "measured heading, clockwise from north")
    heading_valid = Input("1", "whether the heading is one", type=bool, start=True, optional=True)

    yaw_moment = Output("N.m", "yaw moment asked of the thrusters, positive to starboard")

    terminals: ClassVar = {
        "wanted": terminal("heading_wanted"),
        "sensors": terminal("heading", "heading_valid"),
        "demanded": terminal("surge"),
        "held": terminal("yaw_moment"),
    }

    def sample(self, t: float, k: int) -> None:
        """Command the yaw moment."""
        self.yaw_moment = self._limited(self._demanded())

    def _axis(self) -> tuple[float, float, float]:
        return self.inertia, self.capacity, self.rate_limit

    def _is_valid(self) -> bool:
        valid: bool = self.heading_valid
        return valid

    def _places(self) -> tuple[float, float]:
        return self.heading_wanted, self.heading

    def _apart(self, a: float, b: float) -> float:
        return math.remainder(a - b, math.tau)
