"""Fins, stern planes and rudders outside a race, in the flow at their place.

The span s of a foil lies along (0, sin(roll), -cos(roll)) in body axes, e = s x x_b is the
direction of the force of a positive angle: to port for a vertical rudder (roll 0), which turns
the craft to starboard, and up for a stern plane whose span points to starboard (roll 90 deg),
which puts the bow down.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context, smooth_step, wrench

from .flow import STILL, through_water
from .lift import lift_slope

_STALLING = 0.5
"""Of the angle of stall: range over which the flow separates."""
_FLAT = 1.17
"""Normal force coefficient of a plate across the flow, of low aspect ratio (Hoerner, 1965)."""
_OSWALD = 0.9


def upright(roll: Any) -> Any:
    """Return e, the direction of the force of a small positive angle, {b}."""
    return ca.vertcat(0, -ca.cos(roll), -ca.sin(roll))


def fin(c: Context, slot: SimpleNamespace, angle: Any) -> Any:
    """Return the load (6,) of a movable fin: lift across the flow, drag along it.

    Turned by the angle delta, chord and normal are x cos(delta) + e sin(delta) and e cos(delta) -
    x sin(delta). With the components a, b along them of the velocity through the water at its
    place, alpha = atan2(-b, |a|), V^2 = a^2 + b^2, and below the angle of stall (Whicker & Fehlner,
    1958)

        C_L = C_La alpha + C_Dc / AR alpha |alpha|,   C_D = C_D0 + C_L^2 / (0.9 pi AR)

    C_La of `lift_slope`, C_Dc = ``crossflow_drag``. Over 1.5 times that angle it goes over to a
    separated plate's C_N = 1.17 sin(alpha) / (0.44 + 0.56 |sin(alpha)|) (Hoerner, Fluid-Dynamic
    Drag, 1965, scaled), with C_L = C_N cos(alpha), C_D = C_D0 + C_N sin(alpha). Astern it lifts as
    ahead. Limits: no flow along the span, no unsteady lift, no downwash of one foil on another.
    """
    across = upright(slot.roll)
    ahead = ca.vertcat(1, 0, 0)
    cos, sin = ca.cos(angle), ca.sin(angle)
    chord, normal = cos * ahead + sin * across, cos * across - sin * ahead
    velocity = through_water(c, slot)
    a, b = ca.dot(velocity, chord), ca.dot(velocity, normal)
    lift, drag = coefficients(slot, ca.atan2(-b, ca.fabs(a) + STILL))
    pressure = c.parameters.density / 2 * slot.area * ca.sqrt(a**2 + b**2 + STILL**2)
    lifted = ca.fabs(a) * normal - ca.sign(a) * b * chord
    return wrench(pressure * (lift * lifted - drag * (a * chord + b * normal)), slot.position)


def coefficients(slot: SimpleNamespace, alpha: Any) -> tuple[Any, Any]:
    """Return (C_L, C_D) of a `fin` at ``alpha``, rad, within +- pi/2."""
    aspect, size = slot.aspect_ratio, ca.fabs(alpha)
    attached = (lift_slope(aspect) + slot.crossflow_drag / aspect * size) * alpha
    induced = attached**2 / (_OSWALD * ca.pi * aspect)
    cos, sin = ca.cos(alpha), ca.sin(alpha)
    plate = _FLAT * sin / (0.44 + 0.56 * ca.fabs(sin))
    stalled = smooth_step((size - slot.stall) / (_STALLING * slot.stall))
    lift = attached + stalled * (plate * cos - attached)
    drag = slot.profile_drag + induced + stalled * (plate * sin - induced)
    return lift, drag


def linear_fin(c: Context, slot: SimpleNamespace, angle: Any) -> Any:
    """Return the load (6,) rho/2 V^2 A C_L delta (-|delta|, 1) along (x, e) at its place.

    V^2 = u^2 + (e . v)^2 at the body origin: T. I. Fossen's fins of REMUS-100, which know their
    angle and not that of the flow. C_L is ``lift``, 1/rad; the drag is of delta^2.
    """
    across, v = upright(slot.roll), c.nu_r[:3]
    pressure = c.parameters.density / 2 * (v[0] ** 2 + ca.dot(across, v) ** 2)
    scale = pressure * slot.area * slot.lift
    force = scale * (angle * across - ca.vertcat(angle**2, 0, 0))
    return wrench(force, slot.position)
