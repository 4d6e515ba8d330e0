"""Ballast: masses and volumes that change a craft's mass, centre of gravity, inertia, buoyancy.

All is quasi-static: forces of a mass that moves against the craft, and of water that enters with a
velocity of its own, are left out. Each mass is a point.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.symbolic import skew
from seatrial.physics.craft.terms.context import Context, wrench

from .coefficients import Part

Point = tuple[Any, Any]
"""Mass, kg, or volume, m3, and its place in body axes, m."""


def points(parts: Sequence[Part], shares: Sequence[Any]) -> list[Point]:
    """Return the masses that the ballast adds to the craft's own.

    A tank has share x mass at its position. A moving mass, which the craft's own mass includes at
    its position, is taken away there and added share x travel further along its axis.
    """
    found: list[Point] = []
    for (kind, s), share in zip(parts, shares, strict=True):
        if kind == "tank":
            found.append((share * s.mass, s.position))
        elif kind == "moving-mass":
            found.append((-s.mass, s.position))
            found.append((s.mass, s.position + share * s.travel * s.axis))
    return found


def volumes(parts: Sequence[Part], shares: Sequence[Any]) -> list[Point]:
    """Return the volumes, m3, that buoyancy engines displace beyond the craft's own: share x it."""
    return [
        (share * s.volume, s.position)
        for (kind, s), share in zip(parts, shares, strict=True)
        if kind == "buoyancy-engine"
    ]


def ballasted(
    p: SimpleNamespace, masses: Sequence[Point], displaced: Sequence[Point]
) -> SimpleNamespace:
    """Return the craft's parameters with ``masses`` added and volumes ``displaced`` beyond.

    CG, inertia about it and centre of buoyancy move with them (parallel axes). GM_T and GM_L are
    scaled so that W GM, stiffness of the hull's form, stays: `surface_weight` has the rest.
    """
    changed = dict(vars(p))
    if masses:
        mass = p.mass + sum(m for m, _ in masses)
        all_masses = [(p.mass, p.center_of_gravity), *masses]
        center = sum(m * r for m, r in all_masses) / mass
        xx, yy, zz, xy, xz, yz = ca.vertsplit(p.inertia)
        for m, r in all_masses:
            S = skew(r - center)
            J = -m * S @ S
            xx, yy, zz = xx + J[0, 0], yy + J[1, 1], zz + J[2, 2]
            xy, xz, yz = xy - J[0, 1], xz - J[0, 2], yz - J[1, 2]
        changed.update(
            mass=mass,
            center_of_gravity=center,
            inertia=ca.vertcat(xx, yy, zz, xy, xz, yz),
            GM_T=p.GM_T * p.mass / mass,
            GM_L=p.GM_L * p.mass / mass,
        )
    if displaced:
        lifts = [(p.density * p.gravity * volume, place) for volume, place in displaced]
        buoyancy = p.buoyancy + sum(lift for lift, _ in lifts)
        moment = p.buoyancy * p.center_of_buoyancy + sum(lift * r for lift, r in lifts)
        changed.update(buoyancy=buoyancy, center_of_buoyancy=moment / buoyancy)
    return SimpleNamespace(**changed)


def surface_weight(c: Context, masses: Sequence[Point]) -> Any:
    """Return the weight (6,) of ballast of a craft with a surface form of restoring.

    That form has no weight: it is counted from the equilibrium without ballast. Submerged and
    floating craft have all their weight at the CG.
    """
    load: Any = ca.DM.zeros(6)
    for mass, place in masses:
        load += wrench(mass * c.parameters.gravity * c.vertical, place)
    return load
