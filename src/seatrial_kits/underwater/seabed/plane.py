"""Seabed as a plane, level or sloping."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .vectors import Vector, dot


@dataclass(frozen=True)
class Plane:
    """Depth = depth + tan(slope) (north cos(direction) + east sin(direction)), m, positive down.

    ``slope`` is its angle with the horizontal, rad, 0 to less than pi/2; ``direction`` is where
    it falls away to, rad, clockwise from north.
    """

    depth: float
    slope: float = 0.0
    direction: float = 0.0

    @property
    def gradient(self) -> tuple[float, float]:
        """Change of the depth per metre north and east."""
        steepness = math.tan(self.slope)
        return steepness * math.cos(self.direction), steepness * math.sin(self.direction)

    def depth_at(self, north: float, east: float) -> float:
        """Return the depth, m."""
        to_north, to_east = self.gradient
        return self.depth + to_north * north + to_east * east

    def normal_at(self, north: float, east: float) -> Vector:
        """Return the unit normal into the water, {n}: (0, 0, -1) where it is level."""
        to_north, to_east = self.gradient
        cosine = math.cos(self.slope)
        return (cosine * to_north, cosine * to_east, -cosine)

    def ray(self, origin: Sequence[float], direction: Sequence[float], reach: float) -> float:
        """Return the distance, m, along a unit vector; inf if it is beyond ``reach``."""
        normal = self.normal_at(0.0, 0.0)
        # Distance of the origin from the plane, positive in the water.
        above = dot(normal, (origin[0], origin[1], origin[2] - self.depth))
        if above <= 0.0:
            return 0.0
        approach = -dot(normal, direction)
        if approach <= 0.0:
            return math.inf
        distance = above / approach
        return distance if distance <= reach else math.inf
