"""Motion of a vehicle in surge, sway and yaw: the model that is fitted to a log of its turns."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.model.component import Input, Output, Parameter
from seatrial.model.plant import Plant, State

_UVR = ("u", "v", "r")


class PlanarMotion(Plant):
    """Surge, sway and yaw in still water under two thrusters ahead, with no force in sway.

        m11 u' = E1 s1 + E2 s2 - D_u(u) + m22 v r
        m22 v' =               - D_v(v) - m11 u r              D_i(x) = (d_i + q_i |x|) x
        m33 r' = arm (E1 s1 - E2 s2) - D_r(r) + (m11 - m22) u v

    [Paulino2015], eq. 5.18, with its missing lever arm and, of ours, the quadratic drag q that it
    sets aside here. ``mass`` has the added mass, thruster 1 ahead turns to starboard. s is each
    thruster's share of its full thrust E: with ``lag`` "none" the command, with "thruster"
    T s' = command - s.

    ``acceleration`` is (u' - v r, v' + u r), what accelerometers along bow and starboard read
    without gravity; the heading is not wrapped.

    Not modelled: heave, roll and pitch, current, tether, a centre of gravity off the origin.
    """

    lag = Parameter("none", "1", "what delays the thrust", choices=("none", "thruster"))
    mass = Parameter(1.0, ("kg", "kg", "kg.m2"), "with added mass", axes=_UVR, min=1e-9)
    linear = Parameter(
        0.0, ("N.s/m", "N.s/m", "N.m.s/rad"), "linear drag, positive", axes=_UVR, min=0.0
    )
    quadratic = Parameter(
        0.0, ("N.s2/m2", "N.s2/m2", "N.m.s2/rad2"), "quadratic drag, positive", axes=_UVR, min=0.0
    )
    thrust = Parameter(1.0, "N", "thrust of each thruster at command 1", axes=("t1", "t2"))
    arm = Parameter(1.0, "m", "thrusters from the centre line", min=1e-9)
    time_constant = Parameter(0.15, "s", "time constant of the thrust, with a lag", min=1e-6)
    command = Input("1", "share of each thruster's full thrust, -1 to 1", axes=("t1", "t2"))
    heading = State("rad", "heading, clockwise, not wrapped")
    velocity = State(("m/s", "m/s", "rad/s"), "velocity in body axes and yaw rate", axes=_UVR)
    share = State("1", "share of full thrust, with a lag", axes=("t1", "t2"))
    acceleration = Output("m/s2", "acceleration of the body origin, body axes", axes="xy")

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of heading, velocity and shares, and the acceleration."""
        has_lag = p.lag == "thruster"
        first, second = ca.vertsplit(p.thrust * (x.share if has_lag else u.command))
        surge, sway, yaw = ca.vertsplit(x.velocity)
        m11, m22, _ = ca.vertsplit(p.mass)
        coupling = ca.vertcat(m22 * sway * yaw, -m11 * surge * yaw, (m11 - m22) * surge * sway)
        thrust = ca.vertcat(first + second, 0, p.arm * (first - second))
        drag = (p.linear + p.quadratic * ca.fabs(x.velocity)) * x.velocity
        change = (thrust - drag + coupling) / p.mass
        slopes = {
            "heading": yaw,
            "velocity": change,
            "share": (u.command - x.share) / p.time_constant if has_lag else ca.DM.zeros(2),
        }
        carried = ca.vertcat(change[0] - sway * yaw, change[1] + surge * yaw)
        return slopes, {"acceleration": carried}
