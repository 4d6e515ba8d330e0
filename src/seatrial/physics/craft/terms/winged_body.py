"""Lift, drag, side force and moments of a winged body, an underwater glider say."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ....model.component import Component, Parameter
from .context import Context
from .hull_points import wet

_STILL = 1e-20
"""m/s: keeps the derivatives finite where there is no flow."""
_RATES = ("p", "q", "r")


class WingedBody(Component):
    """Mix-in: coefficients of `winged_body`, the K of the literature on underwater gliders."""

    wing_drag = Parameter(
        0.0, "kg/m", "K_D0 and K_D: drag, and by alpha squared", axes=("zero", "alpha2"), min=0.0
    )
    wing_lift = Parameter(0.0, "kg/m", "K_L0 and K_L: lift, and by alpha", axes=("zero", "alpha"))
    wing_side = Parameter(0.0, "kg/m", "K_beta: side force by beta, negative resists")
    wing_pitch = Parameter(0.0, "kg", "K_M0: pitch moment at alpha = 0")
    wing_moment = Parameter(
        0.0, "kg", "K_MR, K_M, K_MY: roll by beta, pitch by alpha, yaw by beta",
        axes=("roll", "pitch", "yaw"),
    )  # fmt: skip
    wing_damping = Parameter(
        0.0, "kg.s", "K_p, K_q, K_r: moment by rate, negative damps", axes=_RATES, max=0.0
    )


def winged_body(c: Context) -> Any:
    """Return force and moment of the flow on a body with wings, tail and fins, as one.

    In the flow frame, whose x lies along the velocity through the water and whose z in the plane of
    x and z of the body, R its rotation to {b}:

        force   R (-(K_D0 + K_D alpha^2), K_beta beta, -(K_L0 + K_L alpha)) V^2
        moment  R (K_MR beta + K_p p, K_M0 + K_M alpha + K_q q, K_MY beta + K_r r) V^2

    alpha = atan2(w, u), beta = asin(v / V), V^2 = u^2 + v^2 + w^2, and p, q, r, all of nu_r
    (Graver, Underwater Gliders: Dynamics, Control and Design, Princeton, 2005; Zhang et al., Ocean
    Engineering 60, 2013). The coefficients contain the density of the water.

    Limits: made for small alpha and beta ahead, without stall; no damping at rest. Munk's moments
    are those of ``coriolis``, and not of K_M and K_MY. Of a hull that floats, the share under
    water is met.
    """
    p, (u, v, w) = c.parameters, ca.vertsplit(c.nu_r[:3])
    across = ca.sqrt(u**2 + w**2 + _STILL**2)
    V = ca.sqrt(across**2 + v**2)
    alpha, beta = ca.atan2(w, u + _STILL), ca.atan2(v, across)
    drag = p.wing_drag[0] + p.wing_drag[1] * alpha**2
    lift = p.wing_lift[0] + p.wing_lift[1] * alpha
    K, M, N = ca.vertsplit(p.wing_moment * ca.vertcat(beta, alpha, beta))
    moment = ca.vertcat(K, p.wing_pitch + M, N) + p.wing_damping * c.nu_r[3:]
    R = _to_body(alpha, beta)
    force = R @ ca.vertcat(-drag, p.wing_side * beta, -lift)
    return wet(c) * V**2 * ca.vertcat(force, R @ moment)


def _to_body(alpha: Any, beta: Any) -> Any:
    """Return the rotation from the flow frame to {b}: about -z by beta, then about y by -alpha."""
    c, s, cb, sb = ca.cos(alpha), ca.sin(alpha), ca.cos(beta), ca.sin(beta)
    return ca.vertcat(
        ca.horzcat(c * cb, -c * sb, -s), ca.horzcat(sb, cb, 0), ca.horzcat(s * cb, -s * sb, c)
    )
