"""A skeg: the term of the equations of motion, and the craft that has one."""

from __future__ import annotations

from typing import Any

import casadi as ca

from seatrial.errors import InputError
from seatrial.model.component import Parameter
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.terms.context import Context, wrench


def skeg(c: Context) -> Any:
    """Return the load (6,) of a thin vertical fin, N and N.m, {b}: f_y = -rho A a |u| v_y / 2.

    v_y is the velocity across the craft at the fin's place, u that along it, A the area, and a the
    slope of the lift coefficient, per rad: linear theory of a thin foil. Limits: angles of attack
    below the stall, some 15 degrees; no drag. Raises InputError for a craft without a skeg.
    """
    p = c.parameters
    if not hasattr(p, "skeg_area"):
        raise InputError("terms: skeg is of a skeg-craft, which has the skeg's parameters")
    u, across = c.nu_r[0], c.at(p.skeg_place)[1]
    force = -p.density * p.skeg_area * p.skeg_slope * ca.fabs(u) * across / 2
    return wrench(ca.vertcat(0, force, 0), p.skeg_place)


class SkegCraft(MarineCraft):
    """`MarineCraft` with the parameters of a skeg, for the term ``skeg``."""

    skeg_area = Parameter(0.0, "m2", "area of the skeg", min=0.0)
    skeg_slope = Parameter(3.0, "1/rad", "slope of its lift coefficient", min=0.0)
    skeg_place = Parameter(0.0, "m", "its centre of pressure, body axes", axes="xyz")
