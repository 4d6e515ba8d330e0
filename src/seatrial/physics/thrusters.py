"""Fixed thrusters of a craft: the places that those who sum and who allocate them share."""

from __future__ import annotations

import math
from typing import Any

from ..errors import InputError
from ..model.component import Component, Parameter

COUNT = 16
"""Most thrusters that a craft has."""


class OfEach:
    """A vector per thruster, as parameters NAME_1 ... NAME_COUNT; reading gives all of them."""

    def __init__(self, unit: str, description: str, count: int = COUNT) -> None:
        self._unit, self._description, self._count = unit, description, count

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        for number in range(1, self._count + 1):
            text = f"{self._description} of thruster {number}"
            parameter = Parameter(0.0, self._unit, text, axes="xyz")
            parameter.__set_name__(owner, f"{name}_{number}")
            setattr(owner, parameter.name, parameter)

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        return self if component is None else self.of(component)

    def of(self, values: Any) -> list[Any]:
        """Return the vectors in ``values``: a component, or a plant's symbols."""
        return [getattr(values, f"{self._name}_{n}") for n in range(1, self._count + 1)]


class FixedThrusters(Component):
    """Mix-in: up to 16 thrusters at positions r_i, m, with unit vectors d_i, in body axes.

    x bow, y starboard, z down, from the body origin; d_i is the direction of the force on the
    craft of a positive thrust. A direction of (0, 0, 0) is no thruster.
    """

    position = OfEach("m", "position from the body origin")
    direction = OfEach("1", "direction of the positive thrust, a unit vector, or 0 for none,")

    def effects(self) -> list[list[float] | None]:
        """Return (d_i, r_i x d_i), force and moment per newton, of each; None for no thruster.

        Raises InputError for a direction that is neither zero nor of length 1 within 1e-6.
        """
        return [
            effect(self.name, f"direction_{number}", r, d) if any(d) else None
            for number, (r, d) in enumerate(zip(self.position, self.direction, strict=True), 1)
        ]


def effect(
    owner: str, name: str, position: tuple[float, ...], direction: tuple[float, ...]
) -> list[float]:
    """Return d and r x d of a thruster: force and moment per newton, body axes.

    Raises InputError naming the direction, ``owner.name``, unless its length is 1 within 1e-6.
    """
    length = math.hypot(*direction)
    if abs(length - 1.0) > 1e-6:
        raise InputError(
            f"{owner}.{name} is {direction}, of length {length:.6g}: give a unit vector, or "
            "(0, 0, 0) for no thruster"
        )
    (x, y, z), (a, b, c) = position, direction
    return [a, b, c, y * c - z * b, z * a - x * c, x * b - y * a]
