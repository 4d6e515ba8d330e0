"""Waves where the parts of a craft are: the motion of the water beyond that at the body origin."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from seatrial.model.expressions import Vector
from seatrial.physics.craft.kinematics import rotation
from seatrial.physics.craft.seaway import PORTS, Places
from seatrial.physics.craft.surrounded import Surroundings, surrounding
from seatrial.physics.sea.numbers import Array
from seatrial.physics.sea.waves import Waves

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


@dataclass(frozen=True)
class AtParts:
    """Surroundings of a craft and, in waves, the velocity of the water at the places of its parts.

    A part at r, in {b}, meets the velocity of the waves at x + R r, with stretching, where it is
    below the surface, and that of the surface above it; a submerged craft's own ``water_velocity``
    has that at its origin already, which is taken off, a surface craft's has none.
    """

    around: Surroundings
    waves: Waves | None
    places: Places
    positions: Array
    """Places of the parts, body axes (2 COUNT, 3), m; 0 where there is none."""
    carried: bool
    """Whether ``water_velocity`` has the waves at the body origin: of a submerged craft."""

    def at(self, t: float, state: Vector) -> Vector:
        """Return all of `PARTS_PORTS`, stacked."""
        around = self.around(t, state)
        if self.waves is None:
            return np.concatenate([around, np.zeros(self.positions.size)])
        x, psi = self.places.x, self.places.psi
        R = np.array(rotation(*state[psi - 2 : psi + 1].tolist()))
        met = self._velocity(t, state[x : x + 3] + self.positions @ R.T)
        if self.carried:
            met -= self._velocity(t, state[x : x + 3])
        return np.concatenate([around, met.ravel()])

    def _velocity(self, t: float, points: Array) -> Array:
        assert self.waves is not None
        surface = -self.waves.elevation(t, points[..., :2])
        below = np.concatenate(
            [points[..., :2], np.maximum(points[..., 2], surface)[..., None]], axis=-1
        )
        return self.waves.motion(t, below).velocity


def part_positions(propulsors: list[Part], foils: list[Part]) -> Array:
    """Return the places of parts, as `AtParts` has them."""
    found = np.zeros((len(_SORTS), COUNT, 3))
    for row, parts in zip(found, (propulsors, foils), strict=True):
        for place, part in zip(row, parts, strict=False):
            place[:] = part.slot.position
    return found.reshape(-1, 3)


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
