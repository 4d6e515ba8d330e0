"""Lift of a hull that sheds vorticity at its trailing end."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ...model.component import Component, Parameter
from .context import Context, wrench
from .hull_points import wet


class HullLift(Component):
    """Mix-in: cross-flow momentum that is left behind where the flow leaves the hull."""

    lift_center = Parameter(0.0, "m", "middle of the hull's lift, body axes", axes="xyz")
    lift_arm = Parameter(0.0, "m", "trailing end from that middle, ahead and astern", min=0.0)
    lift = Parameter(
        0.0, "kg/m", "added mass per length: lift per speed ahead and across", axes="yz", min=0.0
    )


def hull_lift(c: Context) -> Any:
    """f = -|u| (0, a_y v_y(r), a_z v_z(r)) at r = lift_center - (l sgn u, 0, 0), wet share.

    Slender body with a trailing edge (Newman, Marine Hydrodynamics); a = ``lift``, l =
    ``lift_arm``. About the middle: Y = -a_y (|u| v - l u r), N = a_y l (u v - l |u| r), and alike
    in pitch. It takes back most of the Munk moment, at any speed.
    """
    p, u = c.parameters, c.nu_r[0]
    place = p.lift_center - ca.vertcat(p.lift_arm * ca.sign(u), 0, 0)
    across = c.at(place)[1:]
    return wrench(-wet(c) * ca.fabs(u) * ca.vertcat(0, p.lift * across), place)
