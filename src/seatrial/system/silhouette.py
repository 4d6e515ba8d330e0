"""Outlines of a vehicle's shape above the water: areas that the wind meets."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .shape import Hull, ShapePart

_COLUMNS = 400
_ROUND = [math.tau * i / 24 for i in range(24)]

Points = Any
"""(n, 3), m: corners of a convex body."""


@dataclass(frozen=True)
class Silhouette:
    """Area, m2, of an outline above the water line, and its centroid, m, along and upwards."""

    area: float
    along: float
    up: float


def silhouettes(parts: Sequence[ShapePart], waterline: float) -> tuple[Silhouette, Silhouette]:
    """Return what is seen from ahead and from abeam of parts, each area once.

    ``waterline`` is z of the water line, body axes. Jets of water (parts that stretch with a port)
    and files are left out.
    """
    bodies = [body for part in parts for body in _bodies(part, parts)]
    return tuple(_outline(bodies, axis, waterline) for axis in (1, 0))  # type: ignore[return-value]


def _outline(bodies: list[Points], axis: int, waterline: float) -> Silhouette:
    """Return the union of the bodies' projections along the other horizontal axis."""
    flat = [np.column_stack([body[:, axis], waterline - body[:, 2]]) for body in bodies]
    flat = [points for points in flat if points[:, 1].max() > 0.0]
    if not flat:
        return Silhouette(0.0, 0.0, 0.0)
    every = np.concatenate(flat)
    edges = np.linspace(every[:, 0].min(), every[:, 0].max(), _COLUMNS + 1)
    middles, width = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
    spans = [_span(points, middles) for points in flat]
    area = along = up = 0.0
    for column, x in enumerate(middles.tolist()):
        own = [(low[column], high[column]) for low, high in spans if not np.isnan(low[column])]
        for low, high in _union([(max(low, 0.0), high) for low, high in own if high > 0.0]):
            piece = (high - low) * width
            area, along, up = area + piece, along + piece * x, up + piece * 0.5 * (low + high)
    if not area:
        return Silhouette(0.0, 0.0, 0.0)
    return Silhouette(float(area), float(along / area), float(up / area - waterline))


def _span(points: Points, columns: Any) -> tuple[Any, Any]:
    """Return least and greatest height of a convex body over each column, NaN beside it."""
    ordered = sorted(map(tuple, points.tolist()))
    low, high = _chain(ordered, 1.0), _chain(ordered, -1.0)
    beside = {"left": np.nan, "right": np.nan}
    return np.interp(columns, low[:, 0], low[:, 1], **beside), np.interp(
        columns, high[:, 0], high[:, 1], **beside
    )


def _chain(ordered: list[tuple[float, float]], side: float) -> Any:
    """Return the lower (``side`` 1) or upper (-1) edge of the convex outline, left to right."""
    chain: list[tuple[float, float]] = []
    for point in ordered:
        while len(chain) > 1 and side * _turn(chain[-2], chain[-1], point) <= 0.0:
            chain.pop()
        chain.append(point)
    return np.array(chain)


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _union(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if joined and low <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(high, joined[-1][1])
        else:
            joined.append((low, high))
    return joined


def _bodies(part: ShapePart, parts: Sequence[ShapePart]) -> list[Points]:
    """Return the convex bodies of a part, in body axes."""
    if part.stretch is not None or part.file is not None:
        return []
    found = _of_hull(part.hull) if part.hull is not None else [_convex(part)]
    while True:
        R = _rotation(part.turned)
        found = [points @ R.T + np.array(part.at) for points in found]
        carrier = next((each for each in parts if part.on and each.name == part.on), None)
        if carrier is None:
            return found
        part = carrier


def _convex(part: ShapePart) -> Points:
    if part.box is not None:
        halves = [(-0.5 * size, 0.5 * size) for size in part.box]
        return np.array(list(itertools.product(*halves)))
    if part.plate is not None:
        half = 0.5 * part.plate.thickness
        return np.array([(x, y, z) for x, z in part.plate.outline for y in (-half, half)])
    body = part.cylinder or part.capsule
    assert body is not None
    half = 0.5 * body.length + (body.radius if part.capsule else 0.0)
    ring = [(body.radius * math.cos(a), body.radius * math.sin(a)) for a in _ROUND]
    return np.array([(x, y, z) for x in (-half, half) for y, z in ring])


def _of_hull(hull: Hull) -> list[Points]:
    """Return the slices between sections, from the water line to the deck."""
    stations = np.linspace(-0.5 * hull.length, 0.5 * hull.length, len(hull.beam))
    rings = [
        [
            (x, side * 0.5 * beam * flare, z)
            for side in (-1, 1)
            for z, flare in ((0.0, 1.0), (-hull.freeboard, hull.flare))
        ]
        for x, beam in zip(stations.tolist(), hull.beam, strict=True)
    ]
    return [np.array(a + b) for a, b in itertools.pairwise(rings)]


def _rotation(turned: Sequence[float]) -> Any:
    from ..physics.craft.kinematics import rotation

    return np.array(rotation(*(math.radians(angle) for angle in turned)))
