"""Seabed, obstacles and surface together, for rays and contact."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from .grid import Grid
from .plane import Plane
from .shapes import Shape
from .vectors import Hit, Nearest, Vector, along, unit


@dataclass(frozen=True, eq=False)
class Scene:
    """Surfaces that a ray in the water can meet; ``bed`` is None where there is no bottom."""

    bed: Plane | Grid | None
    obstacles: tuple[Shape, ...] = ()

    def ray(
        self,
        origin: Sequence[float],
        direction: Sequence[float],
        reach: float = math.inf,
        surface: bool = True,
    ) -> Hit | None:
        """Return what a ray along a unit vector, {n}, meets first within ``reach``, m, or None.

        The surface is the plane z = 0, met from below, unless ``surface`` is false.
        """
        return _first(self, tuple(origin), tuple(direction), reach, surface)

    def nearest(self, point: Sequence[float]) -> Nearest | None:
        """Return what is nearest to a point, {n}, of bottom and obstacles; None for nothing.

        Exact for a plane and for shapes. Over a grid the distance is that along the normal at
        the place below: exact in a contact that is shallow beside the cells.
        """
        found = [shape.nearest(point) for shape in self.obstacles]
        if self.bed is not None:
            normal = self.bed.normal_at(point[0], point[1])
            above = self.bed.depth_at(point[0], point[1]) - point[2]
            found.append(Nearest(-normal[2] * above, normal, "bottom"))
        return min(found, key=lambda each: each.distance, default=None)

    def hits(
        self, origin: Sequence[float], direction: Sequence[float], reach: float, surface: bool
    ) -> Iterator[Hit]:
        """Yield what a ray meets of each kind, as `ray` has it, in any order."""
        for shape in self.obstacles:
            if (hit := shape.ray(origin, direction)) is not None:
                yield hit
        if self.bed is not None:
            distance = self.bed.ray(origin, direction, reach)
            if distance < math.inf:
                north, east, _ = along(origin, direction, distance)
                yield Hit(distance, self.bed.normal_at(north, east), "bottom")
        if surface and direction[2] < 0.0 <= origin[2]:
            down: Vector = (0.0, 0.0, 1.0)
            yield Hit(origin[2] / -direction[2], down, "surface")


@lru_cache(4096)  # sensors look again, for the same instant
def _first(
    scene: Scene,
    origin: tuple[float, ...],
    direction: tuple[float, ...],
    reach: float,
    surface: bool,
) -> Hit | None:
    hits = scene.hits(origin, direction, reach, surface)
    first = min(hits, key=lambda hit: hit.distance, default=None)
    return first if first is not None and first.distance <= reach else None


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
