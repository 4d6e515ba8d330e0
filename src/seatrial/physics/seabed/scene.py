"""Seabed, obstacles and surface together, for rays and contact."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from .grid import Grid
from .plane import Plane
from .shapes import Shape
from .vectors import Hit, Nearest, Vector, along


@dataclass(frozen=True, eq=False)
class Scene:
    """What a ray in the water can meet; ``bed`` is None where there is no bottom."""

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
