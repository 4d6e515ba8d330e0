"""Motion of a craft in body axes, from sensors of position, heading and yaw rate."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Component, Input, Output, terminal


class SensedMotion(Component):
    """Motion as `DynamicPositioning` takes it, from GNSS, compass and gyro.

        u = cos(psi) V_n + sin(psi) V_e,   v = -sin(psi) V_n + cos(psi) V_e,   w = V_d

    psi = ``heading``; roll and pitch are 0, and so are their rates: the craft is taken to be level.
    What a sensor gave last stays while it is not valid. Positions m and velocities m/s in {n},
    north-east-down; heading rad clockwise from north; ``yaw_rate`` rad/s to starboard positive.
    Static.
    """

    position_n = Input("m", "position, north-east-down", axes=("north", "east", "down"))
    velocity_n = Input(
        "m/s", "velocity over ground, north-east-down", axes=("north", "east", "down")
    )
    heading = Input("rad", "heading, clockwise from north")
    yaw_rate = Input("rad/s", "rate of yaw, to starboard positive")

    position = Output("m", "position, north-east-down", axes="xyz", frame="n")
    attitude = Output("rad", "Euler angles, ZYX, of a level craft", axes=("phi", "theta", "psi"))
    velocity = Output("m/s", "velocity over ground, body axes", axes=("u", "v", "w"))
    rates = Output("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))

    terminals: ClassVar = {
        "sensors": terminal("position_n", "velocity_n", "heading", "yaw_rate"),
        "motion": terminal("position", "attitude", "velocity", "rates"),
    }

    def outputs(self, t: float) -> None:
        """Turn the velocity into body axes."""
        north, east, down = self.velocity_n
        c, s = math.cos(self.heading), math.sin(self.heading)
        self.velocity = c * north + s * east, c * east - s * north, down
        self.position = self.position_n
        self.attitude = 0.0, 0.0, self.heading
        self.rates = 0.0, 0.0, self.yaw_rate
