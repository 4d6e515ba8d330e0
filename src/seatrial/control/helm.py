"""Helm: switch between autopilots and manual control."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Component, Input, Output, Parameter, terminal


class Helm(Component):
    """Switch, axis by axis, between the engaged autopilots' forces and manual control.

        X = surge_held        engaged.speed      else direct.surge surge_limit
        N = yaw_moment_held   engaged.heading    else direct.yaw moment_limit
        Z = heave_held        engaged.depth      else direct.heave heave_limit
        Y = sway_held         + direct.sway sway_limit

    ``engaged`` and ``direct`` are those of `Guidance`: of a craft that is not armed nothing is
    engaged and ``direct`` is 0, so that nothing is asked of the thrusters; while sway is held,
    ``direct`` is 0 too. ``direct`` is limited to +-1. Body axes; X ahead, Y to starboard, Z down,
    N; N to starboard positive, N.m. Static.

    Defaults: the Hydrone catamaran, which has no sway and no heave.
    """

    exercised: ClassVar = {"sway_limit": 3.0, "heave_limit": 4.0}

    surge_limit = Parameter(30.0, "N", "surge force of full deflection", min=0.0, tunable=True)
    sway_limit = Parameter(0.0, "N", "sway force of full deflection", min=0.0, tunable=True)
    moment_limit = Parameter(12.0, "N.m", "yaw moment of full deflection", min=0.0, tunable=True)
    heave_limit = Parameter(0.0, "N", "heave force of full deflection", min=0.0, tunable=True)

    engaged = Input("1", "which autopilots act", type=bool, axes=("speed", "heading", "depth"))
    direct = Input("1", "manual control, -1 to 1", axes=("surge", "sway", "yaw", "heave"))
    surge_held = Input("N", "surge force of the autopilot, positive ahead", optional=True)
    sway_held = Input("N", "sway force of the autopilot, positive to starboard", optional=True)
    yaw_moment_held = Input("N.m", "yaw moment of the autopilot, positive to starboard")
    heave_held = Input("N", "heave force of the autopilot, positive down", optional=True)

    surge = Output("N", "surge force wanted, positive ahead")
    sway = Output("N", "sway force wanted, positive to starboard")
    yaw_moment = Output("N.m", "yaw moment wanted, positive to starboard")
    heave = Output("N", "heave force wanted, positive down")

    terminals: ClassVar = {
        "wanted": terminal("engaged", "direct"),
        "held": terminal(surge="surge_held", yaw_moment="yaw_moment_held", heave="heave_held"),
        "demand": terminal("surge", "sway", "yaw_moment", "heave"),
    }

    def outputs(self, t: float) -> None:
        """Choose."""
        limits = self.surge_limit, self.sway_limit, self.moment_limit, self.heave_limit
        surge, sway, moment, heave = (
            min(max(deflection, -1.0), 1.0) * most
            for deflection, most in zip(self.direct, limits, strict=True)
        )
        self.sway = self.sway_held + sway
        speed, heading, depth = self.engaged
        self.surge = self.surge_held if speed else surge
        self.yaw_moment = self.yaw_moment_held if heading else moment
        self.heave = self.heave_held if depth else heave
