"""Drag by coefficients and projected areas, an axis across another too: the form of Morison."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ....model.component import Component, Parameter
from .context import Context
from .hull_points import wet


class Morison(Component):
    """Mix-in: coefficients of `morison`."""

    drag_coefficient = Parameter(
        0.0,
        "1",
        "C_d in morison, row by row: force along x, y, z by velocity u, v, w",
        axes=[force + velocity for force in "xyz" for velocity in "uvw"],
    )
    projected_area = Parameter(
        0.0, "m2", "S in morison: area that the flow along each axis sees", axes="xyz", min=0.0
    )


def morison(c: Context) -> Any:
    """Return the drag -1/2 rho C_d S |v_r| v_r at the body origin, axis by axis.

    [Paulino2015], eq. 3.39, with its matrices: C_d is full, so that a velocity along one axis may
    pull along another (cross-damping); S is diagonal. Its inertia, C_m rho V (v_c' - v'), is that
    of ``added_mass``, in whose place C_m rho V stands: M nu_r' of `six_dof` has it, with the
    pressure gradient of moving water beside it, which 3.39 leaves out for a body in it.

    Limits: no moment (``coupled-damping`` has those of sway and heave); constant coefficients.
    Off the diagonal, not every C_d takes energy: C_d S with its own diagonal has to. Of
    a hull that floats, the share under water is damped.
    """
    p, v = c.parameters, c.nu_r[:3]
    coefficients = ca.reshape(p.drag_coefficient, 3, 3).T
    force = -p.density / 2 * coefficients @ (p.projected_area * ca.fabs(v) * v)
    load = ca.vertcat(force, 0, 0, 0)
    return wet(c) * load if c.is_floating else load
