"""Obstacles as text: a shape and its numbers each, separated by semicolons."""

from __future__ import annotations

import math

from seatrial.errors import InputError, unknown

from .shapes import Box, Capsule, Cylinder, Shape, Sphere

_NUMBERS = {
    "sphere": "NORTH EAST DOWN RADIUS",
    "cylinder": "NORTH EAST DOWN NORTH EAST DOWN RADIUS",
    "capsule": "NORTH EAST DOWN NORTH EAST DOWN RADIUS",
    "box": "NORTH EAST DOWN LENGTH WIDTH HEIGHT HEADING",
}
"""Numbers by shape, in m; the heading in degrees."""


def read_obstacles(text: str) -> tuple[Shape, ...]:
    """Return the shapes of a text such as ``sphere 10 0 5 1; box 20 5 8 2 2 4 30``.

    A sphere has centre and radius, a cylinder or capsule the ends of its axis and its radius, a
    box its centre, length, width, height and heading (deg, of its length). All are in m, {n}.
    Raises InputError naming the obstacle for one that is none.
    """
    return tuple(_shape(part.split()) for part in text.split(";") if part.strip())


def _shape(words: list[str]) -> Shape:
    kind, *written = words
    if kind not in _NUMBERS:
        raise InputError(unknown("obstacle", kind, _NUMBERS))
    form = _NUMBERS[kind]
    try:
        numbers = [float(word) for word in written]
    except ValueError:
        numbers = []
    if len(numbers) != len(form.split()) or not all(map(math.isfinite, numbers)):
        raise InputError(
            f"obstacle {' '.join(words)!r} is not of the form '{kind} {form}' (m, heading in deg)"
        )
    shape = _made(kind, numbers)
    sizes = shape.size if isinstance(shape, Box) else (numbers[-1],)
    if not all(size > 0.0 for size in sizes):
        raise InputError(f"obstacle {' '.join(words)!r}: sizes must be above 0 m")
    if isinstance(shape, Cylinder | Capsule) and shape.begin == shape.end:
        raise InputError(f"obstacle {' '.join(words)!r}: the ends of its axis are one point")
    return shape


def _made(kind: str, numbers: list[float]) -> Shape:
    first = (numbers[0], numbers[1], numbers[2])
    if kind == "sphere":
        return Sphere(first, numbers[3])
    second = (numbers[3], numbers[4], numbers[5])
    if kind == "box":
        return Box(first, second, math.radians(numbers[6]))
    return (Cylinder if kind == "cylinder" else Capsule)(first, second, numbers[6])
