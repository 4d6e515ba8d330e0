"""Triangles of the parts of a vehicle's shape (`system.shape`), in the part's own axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.trial.criteria.expressions import FloatArray

_AROUND = 20
"""Corners of a circle."""
_BELOW = 8
"""Corners of a hull's section below water."""
_SHARP = 1e-4
"""Half the breadth of a bow that is sharp, over the length: a body stays closed."""
IntArray = np.ndarray[Any, np.dtype[np.integer[Any]]]


@dataclass(frozen=True)
class Mesh:
    """Corners, m, and the three corners of each triangle."""

    vertices: FloatArray
    faces: IntArray


def mesh_of(part: Mapping[str, Any]) -> Mesh | None:
    """Return the triangles of a part as a manifest has it; None of one with a file.

    A part that stretches reaches from its origin along x, any other is about its origin.
    """
    if "box" in part:
        length, breadth, height = (0.5 * size for size in part["box"])
        corners = [[-length, -height], [length, -height], [length, height], [-length, height]]
        found = _plate(corners, 2.0 * breadth)
    elif "cylinder" in part:
        radius, half = part["cylinder"]["radius"], 0.5 * part["cylinder"]["length"]
        found = _turned([[-half, 0.0], [-half, radius], [half, radius], [half, 0.0]])
    elif "capsule" in part:
        found = _turned(_capsule(**part["capsule"]))
    elif "hull" in part:
        found = _hull(**part["hull"])
    elif "plate" in part:
        found = _plate(**part["plate"])
    else:
        return None
    return _lifted(found, part)


def _capsule(radius: float, length: float) -> list[list[float]]:
    """Return the outline of a capsule, (x, distance from the axis), from end to end."""
    angle = np.linspace(0.0, 0.5 * np.pi, _AROUND // 4 + 1)
    along, out = radius * np.cos(angle), radius * np.sin(angle)
    back = np.stack([-0.5 * length - along, out], 1)
    ahead = np.stack([0.5 * length + along, out], 1)[::-1]
    outline: list[list[float]] = np.concatenate([back, ahead]).tolist()
    return outline


def _turned(outline: list[list[float]]) -> Mesh:
    """Return a body of revolution about x; its outline begins and ends on the axis."""
    angle = np.arange(_AROUND) * (2.0 * np.pi / _AROUND)
    rings = [[x, r * np.cos(a), r * np.sin(a)] for x, r in outline[1:-1] for a in angle]
    vertices = np.array([[outline[0][0], 0.0, 0.0], *rings, [outline[-1][0], 0.0, 0.0]])
    i = np.arange(_AROUND)
    j, last = (i + 1) % _AROUND, len(vertices) - 1
    ends = last - _AROUND
    faces = [np.stack([0 * i, 1 + j, 1 + i], 1), np.stack([0 * i + last, ends + i, ends + j], 1)]
    for ring in range(len(outline) - 3):
        a, b = 1 + ring * _AROUND + i, 1 + ring * _AROUND + j
        c, d = a + _AROUND, b + _AROUND
        faces += [np.stack([a, b, c], 1), np.stack([b, d, c], 1)]
    return Mesh(vertices, np.concatenate(faces))


def _lifted(mesh: Mesh, part: Mapping[str, Any]) -> Mesh:
    if "stretch" not in part:
        return mesh
    return Mesh(mesh.vertices - [mesh.vertices[:, 0].min(), 0.0, 0.0], mesh.faces)


def _plate(outline: list[list[float]], thickness: float) -> Mesh:
    """Return a convex outline in x and z, ``thickness`` across in y."""
    flat = np.array(outline, dtype=float)
    if _area(flat) < 0.0:
        flat = flat[::-1]
    count = len(flat)
    sides = [np.insert(flat, 1, y, axis=1) for y in (-0.5 * thickness, 0.5 * thickness)]
    first = np.array([[0, i, i + 1] for i in range(1, count - 1)])
    i = np.arange(count)
    j = (i + 1) % count
    edge = np.concatenate([np.stack([i, i + count, j], 1), np.stack([j, i + count, j + count], 1)])
    return Mesh(np.concatenate(sides), np.concatenate([first, first[:, ::-1] + count, edge]))


def _area(flat: FloatArray) -> float:
    x, z = flat.T
    return float(np.sum(x * np.roll(z, -1) - np.roll(x, -1) * z))


def _hull(
    length: float, beam: list[float], draught: list[float], freeboard: float, flare: float = 1.0
) -> Mesh:
    """Return a hull by its sections: half ellipses below water, flared straight sides above."""
    angle = np.linspace(0.0, np.pi, _BELOW + 1)
    count = len(beam)
    x = np.linspace(-0.5, 0.5, count) * length
    rows = []
    for station, (wide, deep) in enumerate(zip(beam, draught, strict=True)):
        half = max(0.5 * wide, _SHARP * length)
        below = np.stack([half * np.cos(angle), deep * np.sin(angle)], 1)  # starboard to port
        deck = np.array([[half * flare, -freeboard]])
        section = np.concatenate([deck, below, deck * [-1.0, 1.0]])
        rake = 0.04 * length if station == count - 1 else 0.0
        forward = np.full(len(section), x[station])
        forward[[0, -1]] += rake
        rows.append(np.column_stack([forward, section]))
    ring = len(rows[0])
    grid = np.arange(count * ring).reshape(count, ring)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    skin = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    s, e, p, q = grid[:-1, 0], grid[1:, 0], grid[1:, -1], grid[:-1, -1]
    deck_faces = np.concatenate([np.stack((s, p, e), -1), np.stack((s, q, p), -1)])
    fan = [[1, i, i + 1] for i in range(2, ring - 2)] + [[0, 1, ring - 2], [0, ring - 2, ring - 1]]
    stern, bow = grid[0][np.array(fan)], grid[-1][np.array(fan)][:, ::-1]
    faces = np.concatenate([skin, deck_faces, stern, bow])
    return Mesh(np.concatenate(rows), faces[:, ::-1])
