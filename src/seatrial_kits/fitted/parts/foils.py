"""Foils of a craft, by their kinds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context

from .coefficients import Part
from .fins import fin, linear_fin
from .rudder import rudder
from .sail import sail
from .thrust import Push

_ALONE: dict[str, Callable[[Context, SimpleNamespace, Any], Any]] = {
    "fin": fin,
    "linear-fin": linear_fin,
    "sail": sail,
}


def foil_load(
    c: Context, parts: Sequence[Part], angles: Sequence[Any], pushed: Sequence[Push]
) -> Any:
    """Return the load (6,) of all foils at their ``angles``, rad, N and N.m, body axes.

    ``pushed`` is what the propulsors do: rudders are behind them.
    """
    load: Any = ca.DM.zeros(6)
    for (kind, slot), angle in zip(parts, angles, strict=True):
        if kind == "rudder":
            load += rudder(c, slot, angle, pushed)
        else:
            load += _ALONE[kind](c, slot, angle)
    return load
