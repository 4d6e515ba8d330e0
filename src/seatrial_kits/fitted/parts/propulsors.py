"""Propulsors of a craft, by their kinds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context

from .coefficients import Part
from .flow import through_water
from .screws import four_quadrant, propeller, wageningen_b
from .thrust import Drive, Push, azimuth, jet, thruster, tunnel

PUSHES: dict[str, Callable[[Context, Drive], Push]] = {
    "thruster": thruster,
    "azimuth": azimuth,
    "outboard": azimuth,
    "tunnel": tunnel,
    "propeller": propeller,
    "wageningen-b": wageningen_b,
    "four-quadrant": four_quadrant,
    "jet": jet,
}


def pushes(
    c: Context, parts: Sequence[Part], orders: Sequence[Any], angles: Sequence[Any]
) -> list[Push]:
    """Return what the propulsors do at their orders (-1 to 1) and angles, rad."""
    return [
        PUSHES[kind](c, Drive(slot, order, _turned(slot.axis, angle), through_water(c, slot)))
        for (kind, slot), order, angle in zip(parts, orders, angles, strict=True)
    ]


def steered(parts: Sequence[Part], angles: Sequence[Any]) -> list[Any]:
    """Return the angles, rad, that propulsors have: that of number ``turns_with``, or their own."""
    found = []
    for part, own in zip(parts, angles, strict=True):
        angle = own
        for number, other in enumerate(angles, 1):
            angle = ca.if_else(ca.eq(part.slot.turns_with, number), other, angle)
        found.append(angle)
    return found


def _turned(axis: Any, angle: Any) -> Any:
    """Return ``axis`` turned about z by ``angle``, from x to y."""
    x, y, z = ca.vertsplit(axis)
    cos, sin = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(cos * x - sin * y, sin * x + cos * y, z)
