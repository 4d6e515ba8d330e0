"""Propellers at a hull: thrust that falls with the speed of advance and near the surface."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ...model.component import Component, Input, Parameter
from ..thrusters import OfEach
from .context import Context, smooth_step, wrench

COUNT = 8
"""Most propellers that a hull has."""
_AXES = tuple(f"t{number}" for number in range(1, COUNT + 1))
_SMALL = 1e-8
"""Of the squared share of thrust at rest, below which its root is smoothed."""


class Propellers(Component):
    """Mix-in: up to 8 propellers at the hull, which get their thrust at rest as ``thrust``.

    Propeller k is at ``propeller_position_k``, m, and pushes along ``propeller_direction_k``, a
    unit vector, both in body axes; a direction of 0 is no propeller. ``bollard_thrust`` T0 is its
    full thrust at rest, ``advance_loss`` kappa the share of it that is lost per speed of advance,
    ``propeller_radius`` R, and ``ring_drag`` c the drag across of the ring round it.
    """

    propeller_position = OfEach("m", "position from the body origin", COUNT)
    propeller_direction = OfEach(
        "1", "direction of the positive thrust, a unit vector, or 0", COUNT
    )
    bollard_thrust = Parameter(1.0, "N", "full thrust at rest", axes=_AXES, min=1e-9)
    advance_loss = Parameter(0.0, "s/m", "share lost per speed of advance", axes=_AXES, min=0.0)
    propeller_radius = Parameter(0.05, "m", "radius of the propeller", axes=_AXES, min=1e-6)
    ring_drag = Parameter(0.0, "N.s2/m2", "drag across of its ring", axes=_AXES, min=0.0)

    thrust = Input("N", "thrust of each propeller as at rest", axes=_AXES, optional=True)


def propellers(c: Context) -> Any:
    """F = B (T - g kappa T0 sqrt(|T| / T0) u_a) e, and the drag of the rings; g = sgn T.

    u_a is g e . v, the speed of advance, held in -1 m/s to 1 / kappa: the bilinear form
    T_nn n |n| - T_n|n| |n| u_a (Fossen). At T = 0 the root is smoothed within 1e-4 T0. Of a hull
    that floats, B = S((d / R + 1/2) / 1.8) with d the depth of the propeller: all from 1.3 R down,
    nothing from R/2 above the surface (shape after Minsaas, Faltinsen and Persson, 1983).

    A ring at the trailing end drags as the hull goes ahead: f = -s c max(u, 0) (0, v_y, v_z), with
    s = S(1/2 + d / (2.2 R)). Astern the rings lead, and their wake passes over the hull: nothing.
    """
    p, load = c.parameters, ca.DM.zeros(6)
    ahead = ca.fmax(c.nu_r[0], 0)
    places, directions = Propellers.propeller_position.of(p), Propellers.propeller_direction.of(p)
    for k, (place, direction) in enumerate(zip(places, directions, strict=True)):
        v, radius = c.at(place), p.propeller_radius[k]
        pushed = _thrust(c, k, direction.T @ v) * direction
        dragged = p.ring_drag[k] * ahead * ca.vertcat(0, v[1:])
        if c.is_floating:
            depth = c.depth(place) / radius
            pushed *= smooth_step((depth + 0.5) / 1.8)
            dragged *= smooth_step(0.5 + depth / 2.2)
        load += wrench(pushed - dragged, place)
    return load


def _thrust(c: Context, k: int, along: Any) -> Any:
    """Return the thrust of a propeller whose speed through the water is ``along`` its axis, N."""
    p = c.parameters
    T, full, kappa = c.inputs.thrust[k], p.bollard_thrust[k], p.advance_loss[k]
    share = T / full
    root = share / ca.sqrt(ca.sqrt(share**2 + _SMALL))
    advance = ca.fmin(ca.fmax(ca.sign(T) * along, -1), 1 / kappa)
    return T - kappa * full * root * advance
