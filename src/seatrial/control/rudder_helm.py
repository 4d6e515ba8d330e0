"""Helm of a craft with a rudder: switch between autopilot and manual control."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Component, Input, Output, Parameter, terminal


class RudderHelm(Component):
    """Switch between the autopilot's rudder, while it is ``engaged``, and manual control.

        rudder = rudder_held   if engaged,   else -manual rudder_limit

    ``manual`` is positive to turn to starboard, and limited to +-1; a positive rudder turns to
    port. ``engaged`` and ``manual`` are those of `Guidance` or `SailingGuidance`: of a craft that
    is not armed nothing is engaged and ``manual`` is 0, so that the rudder is amidships. rad.
    Static.
    """

    rudder_limit = Parameter(
        math.radians(35.0), "rad", "rudder angle of full deflection", min=0.0, tunable=True
    )

    engaged = Input("1", "whether the autopilot steers", type=bool)
    manual = Input("1", "turn to starboard, -1 to 1")
    rudder_held = Input("rad", "rudder of the autopilot, positive to turn to port")

    rudder = Output("rad", "rudder wanted, positive to turn to port")

    terminals: ClassVar = {
        "wanted": terminal(heading_engaged="engaged", direct_yaw="manual"),
        "held": terminal(rudder="rudder_held"),
        "actuators": terminal("rudder"),
    }

    def outputs(self, t: float) -> None:
        """Choose."""
        steered = -min(max(self.manual, -1.0), 1.0) * self.rudder_limit
        self.rudder = self.rudder_held if self.engaged else steered
