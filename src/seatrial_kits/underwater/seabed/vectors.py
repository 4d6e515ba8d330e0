"""Vectors of three numbers in north-east-down, and the hit of a ray."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Hit:
    """First intersection of a ray."""

    distance: float
    """From the ray's origin, m; 0 if that is inside."""
    normal: Vector
    """Unit vector out of what was met, {n}."""
    target: str
    """bottom, surface, or the kind of the obstacle."""


@dataclass(frozen=True)
class Nearest:
    """The nearest thing to a point."""

    distance: float
    """To its face, m; negative inside."""
    normal: Vector
    """Unit vector out of it, {n}."""
    target: str
    """bottom, or the kind of the obstacle."""


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def minus(a: Sequence[float], b: Sequence[float]) -> Vector:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def along(origin: Sequence[float], direction: Sequence[float], distance: float) -> Vector:
    """Return origin + distance direction."""
    return (
        origin[0] + distance * direction[0],
        origin[1] + distance * direction[1],
        origin[2] + distance * direction[2],
    )


def unit(v: Sequence[float]) -> Vector:
    """Return v / |v|; straight up, (0, 0, -1), for a vector of length 0."""
    length = math.hypot(*v)
    return (v[0] / length, v[1] / length, v[2] / length) if length else (0.0, 0.0, -1.0)
