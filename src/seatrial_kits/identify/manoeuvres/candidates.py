"""Parameters that manoeuvres in the horizontal plane may tell, by kind of craft."""

from __future__ import annotations

from collections.abc import Mapping

_SIX_DOF = (
    *("linear_damping_force.u", "quadratic_damping_force.u", "added_mass.xx"),
    *("linear_damping_force.v", "quadratic_damping_force.v", "added_mass.yy"),
    *("linear_damping_moment.r", "quadratic_damping_moment.r", "added_inertia.zz"),
    "crossflow_coefficient",
)
CANDIDATES: Mapping[str, tuple[str, ...]] = {
    "marine-craft": _SIX_DOF,
    "fitted-craft": (*_SIX_DOF, "body_lift_drag", "body_lift_efficiency", "foil_lift_1"),
    "mmg-ship": (
        *("resistance", "added_mass.x", "added_mass.y", "added_inertia"),
        *("X.vv", "X.rr"),
        *("Y.v", "Y.r", "Y.vvv", "Y.vvr", "Y.vrr"),
        *("N.v", "N.r", "N.vvv", "N.vvr", "N.vrr"),
    ),
    "manoeuvring-ship": (
        *("state_matrix.vv", "state_matrix.vr", "state_matrix.rv", "state_matrix.rr"),
        *("rudder_vector.v", "rudder_vector.r"),
        *("X.u", "X.vv", "X.rv", "X.dd"),
        *("Y.v", "Y.r", "Y.vvv", "Y.vvr", "Y.d"),
        *("N.v", "N.r", "N.vvv", "N.vvr", "N.d"),
    ),
}
"""Scalars of a craft's parameters by the name of its component."""
