"""Rudder in a propeller's race, by the MMG standard method."""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import casadi as ca

from seatrial.physics.craft.terms.context import Context, wrench

from .fins import upright
from .flow import STILL, through_water
from .thrust import Push

_FUJII = (6.13, 2.25)
"""Of f_alpha."""


class BladeForce(NamedTuple):
    """Force of a rudder's blade, N."""

    normal: Any
    """F_N."""
    aft: Any
    """(1 - t_R) F_N sin(delta)."""
    across: Any
    """F_N cos(delta), to port of an upright rudder; the hull's share is not in it."""


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
    u = slot.wake_ratio * _behind(c, slot, pushed)
    drift = ca.dot(across, through_water(c, slot, slot.flow_aft))
    v = straightened(slot, drift)
    slope = _FUJII[0] * slot.aspect_ratio / (slot.aspect_ratio + _FUJII[1])
    force = blade(slot, p.density, slope, angle, (u, v))
    sideways = force.across * across
    at_hull = ca.vertcat(slot.hull_position, slot.position[1:])
    own = wrench(sideways - ca.vertcat(force.aft, 0, 0), slot.position)
    return own + wrench(slot.hull_share * sideways, at_hull)


def in_race(slot: SimpleNamespace, density: Any, advance: Any, loading: Any) -> Any:
    """Return u_R / eps of `rudder`, m/s, behind a propulsor.

    ``advance`` is u_P, m/s, ``loading`` T / D^2, N/m2, of which less than 0 makes no race.
    """
    disk = 8 * ca.fmax(loading, 0) / (math.pi * density)
    race = advance + slot.race_gain * (ca.sqrt(advance**2 + disk + STILL**2) - ca.fabs(advance))
    q = slot.covered * race * ca.fabs(race) + (1 - slot.covered) * advance * ca.fabs(advance)
    return ca.sign(q) * ca.sqrt(ca.fabs(q) + STILL)


def straightened(slot: SimpleNamespace, drift: Any) -> Any:
    """Return v_R = gamma_R ``drift`` of `rudder`, m/s; the drift is positive to port."""
    return drift * ca.if_else(drift > 0, slot.straightening[0], slot.straightening[1])


def blade(
    slot: SimpleNamespace, density: Any, slope: Any, angle: Any, inflow: tuple[Any, Any]
) -> BladeForce:
    """Return the force of the blade of `rudder` in the ``inflow`` (u_R, v_R), m/s.

    ``slope`` is f_alpha, 1/rad, ``angle`` delta, rad, that turns the craft to starboard.
    """
    u, v = inflow
    alpha = angle - ca.atan2(v, u + STILL)
    normal = density / 2 * slot.area * slope * (u**2 + v**2) * ca.sin(alpha)
    aft = (1 - slot.deduction) * normal * ca.sin(angle)
    return BladeForce(normal, aft, normal * ca.cos(angle))


def _behind(c: Context, slot: SimpleNamespace, pushed: Sequence[Push]) -> Any:
    """Return u_R / eps behind the propulsor that the slot names, m/s, or behind none."""
    u, loading = through_water(c, slot)[0], 0
    for number, push in enumerate(pushed, 1):
        behind = ca.eq(slot.behind, number)
        u = ca.if_else(behind, push.advance, u)
        loading = ca.if_else(behind, push.loading, loading)
    return in_race(slot, c.parameters.density, u, loading)
