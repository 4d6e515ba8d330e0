"""Lift and drag of a slender body as of a wing, and damping that fades with the speed."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

from ....model.component import Component, Parameter
from .context import Context, wrench
from .hull_points import wet

_STILL = 1e-20
"""m/s: keeps the derivatives finite where there is no flow."""


class Slender(Component):
    """Mix-in: coefficients of `body_lift` and `fading_damping`."""

    body_lift_area = Parameter(0.01, "m2", "reference area S in body-lift", min=1e-9)
    body_lift_span = Parameter(0.1, "m", "span b in body-lift: aspect ratio b^2 / S", min=1e-9)
    body_lift_drag = Parameter(0.0, "1", "C_D0 in body-lift: drag without lift, on S", min=0.0)
    body_lift_efficiency = Parameter(0.7, "1", "Oswald's efficiency in body-lift", min=1e-9)
    fading_damping_force = Parameter(
        0.0, "N.s/m", "damping at rest in fading-damping, in surge and sway", axes="uv", min=0.0
    )
    fading_damping_rate = Parameter(
        0.0, "s/m", "rate at which it fades with the speed in fading-damping", min=0.0
    )


def body_lift(c: Context) -> Any:
    """Return lift and drag of the body as of a wing in the plane of x and z.

    With alpha = atan2(w, u) and U^2 = u^2 + v^2 + w^2, all of nu_r:

        C_L = pi AR alpha / (1 + sqrt(1 + (AR / 2)^2)),   C_D = C_D0 + C_L^2 / (pi e AR)
        (X, Z) = rho / 2 U^2 S (-C_D cos(alpha) + C_L sin(alpha),
                                -C_D sin(alpha) - C_L cos(alpha))

    Beard & McLain, Small Unmanned Aircraft, 2012, without their stall, as in Fossen, 2021, section
    8.4.2. Limits: forces act at the body origin; nothing comes of sway; made for motion ahead at
    small angles of attack: the lift is linear up to 180 degrees, where it changes its sign. Of a
    hull that floats, the share under water has lift.
    """
    p, (u, v, w) = c.parameters, ca.vertsplit(c.nu_r[:3])
    aspect = p.body_lift_span**2 / p.body_lift_area
    alpha = ca.atan2(w, u + _STILL)
    lift = math.pi * aspect * alpha / (1 + ca.sqrt(1 + (aspect / 2) ** 2))
    drag = p.body_lift_drag + lift**2 / (math.pi * p.body_lift_efficiency * aspect)
    pressure = p.density / 2 * (u**2 + v**2 + w**2) * p.body_lift_area * wet(c)
    cos, sin = ca.cos(alpha), ca.sin(alpha)
    X, Z = -drag * cos + lift * sin, -drag * sin - lift * cos
    return pressure * ca.vertcat(X, 0, Z, 0, 0, 0)


def fading_damping(c: Context) -> Any:
    """Return -d exp(-k U) (u, v) in surge and sway; d, k are ``fading_damping_force``, ``_rate``.

    u, v and U = |(u, v, w)| of nu_r ([Fossen2021]: linear damping that leaves the field to lift
    and quadratic drag as the craft gathers speed). Of a hull that floats, the share under water
    is damped.
    """
    p, velocity = c.parameters, c.nu_r[:3]
    speed = ca.sqrt(ca.sumsqr(velocity) + _STILL**2)
    faded = wet(c) * ca.exp(-p.fading_damping_rate * speed)
    return ca.vertcat(-faded * p.fading_damping_force * velocity[:2], 0, 0, 0, 0)


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
