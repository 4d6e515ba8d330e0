"""Waves where the parts of a craft are: the motion of the water beyond that at the body origin."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from seatrial.physics.craft.around import WavesAtParts
from seatrial.physics.craft.seaway import PORTS
from seatrial.physics.craft.surrounded import surrounding
from seatrial.physics.sea.orbital import Orbital

from .coefficients import Part
from .slots import COUNT

_SORTS = ("propulsor", "foil")
"""Sorts of parts that meet the water, in order."""
_PLACES = [f"{sort[0]}{k}_{axis}" for sort in _SORTS for k in range(1, COUNT + 1) for axis in "ned"]

PARTS_PORTS = (
    *PORTS,
    surrounding(
        "water_at_parts",
        "m/s",
        "velocity that waves give the water at each part, beyond that at the body origin, {n}",
        tuple(_PLACES),
    ),
)
"""What the equations of a craft with parts find among their inputs in its sea."""


def waves_at_parts(
    orbital: Orbital | None, propulsors: list[Part], foils: list[Part]
) -> WavesAtParts:
    """Return the waves at parts, each in its row of `PARTS_PORTS`; None: there are none."""
    rows = [
        (COUNT * sort + k, part.slot.position)
        for sort, parts in enumerate((propulsors, foils))
        for k, part in enumerate(parts)
    ]
    positions = np.array([position for _, position in rows], dtype=float).reshape(-1, 3)
    return WavesAtParts(orbital, tuple(row for row, _ in rows), positions, len(_SORTS) * COUNT)


def with_waves(parts: list[Part], sort: int, u: SimpleNamespace) -> list[Part]:
    """Return parts whose slots have ``waves``, the velocity (3,) at them in {n}, if there is sea.

    ``sort`` is 0 of propulsors, 1 of foils; ``u`` are the inputs of the equations, as symbols.
    """
    met: Any = getattr(u, "water_at_parts", None)
    if met is None:
        return parts
    first = 3 * COUNT * sort
    return [
        Part(kind, SimpleNamespace(**vars(slot), waves=met[first + 3 * k : first + 3 * k + 3]))
        for k, (kind, slot) in enumerate(parts)
    ]
