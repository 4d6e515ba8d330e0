"""Rudder in a propeller's race, by the MMG standard method."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import casadi as ca

from ..craft.context import Context, wrench
from .fins import upright
from .flow import STILL, through_water
from .thrust import Push

_FUJII = (6.13, 2.25)
"""Of f_alpha."""


def rudder(c: Context, slot: SimpleNamespace, angle: Any, pushed: Sequence[Push]) -> Any:
    """Return the load (6,) of a rudder in the race of the propulsor ``behind``, or of none.

    Yasukawa & Yoshimura, J. Mar. Sci. Technol. 20 (2015): F_N = rho/2 A f_alpha U_R^2 sin(alpha_R)
    along the blade's normal, with U_R^2 = u_R^2 + v_R^2 and alpha_R = delta - atan2(v_R, u_R). Of
    the propulsor's speed of advance u_P, thrust T and diameter D

        u_S = u_P + kappa (sqrt(u_P^2 + 8 T / (pi rho D^2)) - |u_P|)
        u_R = eps sgn(q) sqrt(|q|),   q = eta u_S |u_S| + (1 - eta) u_P |u_P|

    which is MMG's form, K_T / J^2 written by thrust, continued to low speed and astern: a thrust
    astern makes no race. v_R = gamma_R (e . v), v the velocity through the water of the place
    ``flow_aft`` behind its own, e of `fins`; gamma_R by the sign of that drift, positive to port.
    The hull adds a_H of the force across, at x_H; t_R is taken off the force along x. f_alpha is
    Fujii's, 6.13 AR / (AR + 2.25). Behind none u_P is its own u, and T = 0. Limits: the drag is
    that of the normal force alone; the wake does not change with the drift.
    """
    p, across = c.parameters, upright(slot.roll)
    u = slot.wake_ratio * _in_race(c, slot, pushed)
    place = slot.position - ca.vertcat(slot.flow_aft, 0, 0)
    drift = ca.dot(across, through_water(c, place))
    v = drift * ca.if_else(drift > 0, slot.straightening[0], slot.straightening[1])
    slope = _FUJII[0] * slot.aspect_ratio / (slot.aspect_ratio + _FUJII[1])
    alpha = angle - ca.atan2(v, u + STILL)
    normal = p.density / 2 * slot.area * slope * (u**2 + v**2) * ca.sin(alpha)
    sideways = normal * ca.cos(angle) * across
    aft = (1 - slot.deduction) * normal * ca.sin(angle)
    at_hull = ca.vertcat(slot.hull_position, slot.position[1:])
    own = wrench(sideways - ca.vertcat(aft, 0, 0), slot.position)
    return own + wrench(slot.hull_share * sideways, at_hull)


def _in_race(c: Context, slot: SimpleNamespace, pushed: Sequence[Push]) -> Any:
    """Return sgn(q) sqrt(|q|) of `rudder`, m/s."""
    u, loading = through_water(c, slot.position)[0], 0
    for number, push in enumerate(pushed, 1):
        behind = ca.eq(slot.behind, number)
        u = ca.if_else(behind, push.advance, u)
        loading = ca.if_else(behind, ca.fmax(push.loading, 0), loading)
    disk = 8 * loading / (math.pi * c.parameters.density)
    race = u + slot.race_gain * (ca.sqrt(u**2 + disk + STILL**2) - ca.fabs(u))
    q = slot.covered * race * ca.fabs(race) + (1 - slot.covered) * u * ca.fabs(u)
    return ca.sign(q) * ca.sqrt(ca.fabs(q) + STILL)
