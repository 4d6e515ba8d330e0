"""Damping that couples sway with yaw and heave with pitch."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ....model.component import Component, Parameter
from .context import Context
from .hull_points import wet


class CoupledDamping(Component):
    """Mix-in: coefficients of `coupled_damping`, hydrodynamic derivatives with their own signs."""

    coupled_damping_force = Parameter(
        0.0, "N.s/rad", "Y_r and Z_q: sway and heave force by yaw and pitch rate", axes="rq"
    )
    coupled_damping_moment = Parameter(
        0.0, "N.s", "N_v and M_w: yaw and pitch moment by sway and heave velocity", axes="vw"
    )
    quadratic_coupled_damping_force = Parameter(
        0.0, "N.s2/rad2", "Y_r|r| and Z_q|q|: the same, quadratic", axes="rq"
    )
    quadratic_coupled_damping_moment = Parameter(
        0.0, "N.s2/m", "N_v|v| and M_w|w|: the same, quadratic", axes="vw"
    )


def coupled_damping(c: Context) -> Any:
    """Return the damping of sway and yaw, heave and pitch by each other's velocity.

        Y = Y_r r + Y_r|r| r|r|,   N = N_v v + N_v|v| v|v|
        Z = Z_q q + Z_q|q| q|q|,   M = M_w w + M_w|w| w|w|

    v, w, q, r of nu_r. Derivatives as SNAME (1950) has them, the quadratic ones as Prestero (MIT
    2001): Y_r > 0 pushes to starboard in a turn to starboard. In the order of the parameters:
    ``coupled_damping_force`` (Y_r, Z_q), ``coupled_damping_moment`` (N_v, M_w).

    Limits: constant coefficients, so valid about one speed ahead; whoever takes those of a report
    with lift in them leaves out ``hull-lift``. Not every set of signs takes energy: the damping
    matrix with its own diagonal has to. Of a hull that floats, the share under water is damped.
    """
    p = c.parameters
    across, turning = c.nu_r[1:3], ca.vertcat(c.nu_r[5], c.nu_r[4])
    force = _along(p.coupled_damping_force, p.quadratic_coupled_damping_force, turning)
    moment = _along(p.coupled_damping_moment, p.quadratic_coupled_damping_moment, across)
    load = ca.vertcat(0, force, 0, moment[1], moment[0])
    return wet(c) * load if c.is_floating else load


def _along(linear: Any, quadratic: Any, velocity: Any) -> Any:
    return (linear + quadratic * ca.fabs(velocity)) * velocity
