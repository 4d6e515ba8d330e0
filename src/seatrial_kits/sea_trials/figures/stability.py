"""Figures of a curve of righting arms, and the criteria of the IMO's code on intact stability."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seatrial.physics.sea.numbers import Array

ANGLES = np.radians(np.arange(0.0, 181.0, 1.0))
"""Angles of heel that a curve is asked for, rad."""


class Criterion(NamedTuple):
    """A figure, and the least that is allowed."""

    name: str
    found: float
    least: float
    unit: str

    @property
    def holds(self) -> bool:
        """Whether it is kept."""
        return self.found >= self.least


class Stability(NamedTuple):
    """A curve GZ, m, at `ANGLES`, by its figures; SI and radians."""

    arms: Array
    GM: float
    """Its slope at rest, m."""

    @property
    def vanishing(self) -> float:
        """Least angle from which on the arm capsizes; pi if there is none, 0 without GM."""
        after = np.flatnonzero(self.arms[1:-1] <= 0.0)
        if not len(after) or self.GM <= 0.0:
            return math.pi if self.GM > 0.0 else 0.0
        k = int(after[0])
        before, beyond = self.arms[k], self.arms[k + 1]
        return float(ANGLES[k] + (ANGLES[k + 1] - ANGLES[k]) * before / (before - beyond))

    @property
    def largest(self) -> tuple[float, float]:
        """Largest arm before that, m, and its angle."""
        k = int(np.argmax(np.where(self.vanishing >= ANGLES, self.arms, -np.inf)))
        return float(self.arms[k]), float(ANGLES[k])

    def area(self, start: float, end: float) -> float:
        """Return the area below the curve between two angles, m rad, to where it vanishes."""
        phi = np.linspace(start, max(start, min(end, self.vanishing)), 401)
        return float(np.trapezoid(np.interp(phi, ANGLES, self.arms), phi))

    def criteria(self) -> list[Criterion]:
        """Return those of the International Code on Intact Stability, 2008, part A, 2.2."""
        thirty, forty = math.radians(30.0), math.radians(40.0)
        _, angle = self.largest
        beyond = np.where((thirty - 1e-9 <= ANGLES) & (self.vanishing >= ANGLES), self.arms, 0.0)
        return [
            Criterion("area to 30 deg", self.area(0.0, thirty), 0.055, "m.rad"),
            Criterion("area to 40 deg", self.area(0.0, forty), 0.090, "m.rad"),
            Criterion("area from 30 to 40 deg", self.area(thirty, forty), 0.030, "m.rad"),
            Criterion("largest arm from 30 deg on", float(beyond.max()), 0.20, "m"),
            Criterion("angle of the largest arm", math.degrees(angle), 25.0, "deg"),
            Criterion("GM", self.GM, 0.15, "m"),
        ]
