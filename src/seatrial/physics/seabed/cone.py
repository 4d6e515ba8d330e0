"""First return within the cone of a beam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

from .scene import Scene
from .vectors import Hit, Vector, along, unit

_SPOKES = 12
_FINEST = 1e-5
"""Share of the cone's half angle to which the direction of the first return is found."""


@lru_cache(256)
def first_return(
    scene: Scene, origin: Vector, axis: Vector, half_angle: float, reach: float
) -> Hit | None:
    """Return what the cone about a unit vector, {n}, meets first within ``reach``, m, or None.

    ``half_angle`` is rad, from the axis to the edge. Rays on the axis and on two rings, twelve
    on each, begin; the direction of the shortest is then improved by ever smaller steps. What is
    so narrow that it lies between all of these rays is missed.
    """
    across = _across(axis)

    def ray(x: float, y: float) -> Hit | None:
        return scene.ray(origin, _tilted(axis, across, x, y), reach)

    if half_angle == 0.0:
        return ray(0.0, 0.0)
    spokes = [(math.cos(a), math.sin(a)) for a in (math.tau * k / _SPOKES for k in range(_SPOKES))]
    rings = [(s * half_angle * c, s * half_angle * d) for s in (0.5, 1.0) for c, d in spokes]
    tried = ((ray(x, y), x, y) for x, y in [(0.0, 0.0), *rings])
    found = [(hit, x, y) for hit, x, y in tried if hit is not None]
    if not found:
        return None
    best, x, y = min(found, key=lambda each: each[0].distance)
    step = 0.5 * half_angle
    while step > _FINEST * half_angle:
        moves = (_held(x + step * c, y + step * d, half_angle) for c, d in spokes[::2])
        others = [(hit, u, v) for u, v in moves if (hit := ray(u, v)) is not None]
        nearer = min(others, key=lambda each: each[0].distance, default=(best, x, y))
        if nearer[0].distance < best.distance:
            best, x, y = nearer
        else:
            step *= 0.5
    return best


def _held(x: float, y: float, most: float) -> tuple[float, float]:
    away = math.hypot(x, y)
    return (x, y) if away <= most else (x * most / away, y * most / away)


def _across(axis: Sequence[float]) -> tuple[Vector, Vector]:
    """Return two unit vectors across the axis and each other."""
    least = min(range(3), key=lambda k: abs(axis[k]))
    start = [1.0 if k == least else 0.0 for k in range(3)]
    first = unit(along(start, axis, -axis[least]))
    a, b, c = axis
    return first, (
        b * first[2] - c * first[1],
        c * first[0] - a * first[2],
        a * first[1] - b * first[0],
    )


def _tilted(axis: Vector, across: tuple[Vector, Vector], x: float, y: float) -> Vector:
    """Return the axis turned by hypot(x, y), rad, towards x and y of the vectors across."""
    angle = math.hypot(x, y)
    if angle == 0.0:
        return axis
    share = math.sin(angle) / angle
    sideways = along(along((0.0, 0.0, 0.0), across[0], x * share), across[1], y * share)
    return along(sideways, axis, math.cos(angle))
