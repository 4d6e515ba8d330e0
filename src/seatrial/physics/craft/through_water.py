"""Velocity of a craft through the water as outputs: at its body origin, and at a named place."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ...model.component import Component, Parameter, terminal
from ...model.ports import Output

_NU = ("u", "v", "w", "p", "q", "r")


class ThroughWater(Component):
    """Mix-in: nu_r = nu - (R^T v_c, 0), for speed logs and for parts in somebody's own Python.

    v_c is the velocity of the water in {n}, of current and waves, at the body origin. ``flow`` is
    that of the point ``flow_place`` r through the water there:

        flow = v_r + omega x r - R^T (s (R r)_z, 0)

    with the shear s of the current over depth. A fin at r feels -``flow``.
    """

    flow_place = Parameter(
        0.0, "m", "place of the output flow from the body origin, body axes", axes="xyz"
    )

    nu_r = Output(
        ("m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"),
        "velocity of the body origin through the water and angular velocity, body axes",
        axes=_NU,
    )
    flow = Output("m/s", "velocity of flow_place through the water, body axes", axes=_NU[:3])

    water_terminals: ClassVar = {"water": terminal("nu_r")}


def flow_outputs(R: Any, nu_r: Any, u: SimpleNamespace, p: SimpleNamespace) -> dict[str, Any]:
    """Return the outputs of `ThroughWater`, m/s and rad/s in {b}, of ``nu_r`` (6,).

    ``R`` is the rotation body to {n}; a trial's shear is among the inputs ``u`` if there is sea.
    """
    flow = nu_r[:3] + ca.cross(nu_r[3:], p.flow_place)
    if hasattr(u, "water_shear"):
        below = R[2, :] @ p.flow_place
        flow = flow - R.T @ ca.vertcat(u.water_shear * below, 0)
    return {"nu_r": nu_r, "flow": flow}
