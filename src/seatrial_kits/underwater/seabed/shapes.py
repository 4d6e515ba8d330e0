"""Obstacles of simple shapes: spheres, cylinders, capsules, boxes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from .vectors import Hit, Nearest, Vector, along, dot, minus, unit

_Met = tuple[float, Vector]
"""Distance along a ray, m, and the normal there."""


class Shape:
    """Base of the shapes: a closed surface with an outside."""

    kind: ClassVar[str]

    def nearest(self, point: Sequence[float]) -> Nearest:
        """Return the face that is nearest to a point, {n}, m."""
        raise TypeError(f"{type(self).__name__} has no faces")

    @property
    def bound(self) -> tuple[Vector, float]:
        """Centre, {n}, and radius, m, of a sphere around it."""
        raise TypeError(f"{type(self).__name__} has no faces")

    def ray(self, origin: Sequence[float], direction: Sequence[float]) -> Hit | None:
        """Return where a ray along a unit vector enters, at once if it begins inside, or None."""
        centre, radius = self.bound
        out = minus(origin, centre)
        half, beyond = dot(out, direction), dot(out, out) - radius * radius
        if beyond > 0.0 and (half > 0.0 or half * half < beyond):
            return None  # it passes by: most rays do
        if beyond <= 0.0 and self.nearest(origin).distance <= 0.0:
            return Hit(0.0, (-direction[0], -direction[1], -direction[2]), self.kind)
        first = min(self._entries(origin, direction), default=None)
        return None if first is None else Hit(*first, self.kind)

    def _entries(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        raise TypeError(f"{type(self).__name__} has no faces")


@dataclass(frozen=True)
class Sphere(Shape):
    """All points within ``radius``, m, of ``centre``, {n}."""

    kind: ClassVar[str] = "sphere"
    centre: Vector
    radius: float

    @property
    def bound(self) -> tuple[Vector, float]:
        """Centre, {n}, and radius, m, of a sphere around it."""
        return self.centre, self.radius

    def nearest(self, point: Sequence[float]) -> Nearest:
        """Return the face that is nearest to a point, {n}, m."""
        out = minus(point, self.centre)
        return Nearest(math.hypot(*out) - self.radius, unit(out), self.kind)

    def _entries(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        yield from _enter_sphere(self.centre, self.radius, origin, direction)


@dataclass(frozen=True)
class _Round(Shape):
    """A body of ``radius``, m, about the line between two different points, {n}."""

    begin: Vector
    end: Vector
    radius: float

    @cached_property
    def axis(self) -> Vector:
        """Unit vector from the begin to the end, {n}."""
        return unit(minus(self.end, self.begin))

    @cached_property
    def length(self) -> float:
        """From the begin to the end, m."""
        return math.dist(self.begin, self.end)

    @cached_property
    def bound(self) -> tuple[Vector, float]:
        """Centre, {n}, and radius, m, of a sphere around it."""
        middle = along(self.begin, self.axis, 0.5 * self.length)
        return middle, 0.5 * self.length + self.radius

    def _across(self, v: Sequence[float]) -> Vector:
        return along(v, self.axis, -dot(v, self.axis))

    def _enter_side(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        out, step = self._across(minus(origin, self.begin)), self._across(direction)
        square, half = dot(step, step), dot(out, step)
        under = half * half - square * (dot(out, out) - self.radius**2)
        if square == 0.0 or under < 0.0:
            return
        distance = (-half - math.sqrt(under)) / square
        place = dot(minus(along(origin, direction, distance), self.begin), self.axis)
        if distance >= 0.0 and 0.0 <= place <= self.length:
            yield distance, unit(along(out, step, distance))


@dataclass(frozen=True)
class Capsule(_Round):
    """All points within ``radius``, m, of the line between two points, {n}."""

    kind: ClassVar[str] = "capsule"

    def nearest(self, point: Sequence[float]) -> Nearest:
        """Return the face that is nearest to a point, {n}, m."""
        place = min(max(dot(minus(point, self.begin), self.axis), 0.0), self.length)
        out = minus(point, along(self.begin, self.axis, place))
        return Nearest(math.hypot(*out) - self.radius, unit(out), self.kind)

    def _entries(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        yield from self._enter_side(origin, direction)
        yield from _enter_sphere(self.begin, self.radius, origin, direction)
        yield from _enter_sphere(self.end, self.radius, origin, direction)


@dataclass(frozen=True)
class Cylinder(_Round):
    """A cylinder with flat ends at two points, {n}, of ``radius``, m: a pile, a pipe."""

    kind: ClassVar[str] = "cylinder"

    def nearest(self, point: Sequence[float]) -> Nearest:
        """Return the face that is nearest to a point, {n}, m."""
        middle = along(self.begin, self.axis, 0.5 * self.length)
        out = minus(point, middle)
        place, sideways = dot(out, self.axis), self._across(out)
        beyond = abs(place) - 0.5 * self.length
        outside = math.hypot(*sideways) - self.radius
        end, side = along((0.0, 0.0, 0.0), self.axis, math.copysign(1.0, place)), unit(sideways)
        if beyond > 0.0 and outside > 0.0:
            edge = along(along((0.0, 0.0, 0.0), end, beyond), side, outside)
            return Nearest(math.hypot(beyond, outside), unit(edge), self.kind)
        return Nearest(*((beyond, end) if beyond > outside else (outside, side)), self.kind)

    def _entries(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        yield from self._enter_side(origin, direction)
        for centre, sign in ((self.begin, -1.0), (self.end, 1.0)):
            normal = along((0.0, 0.0, 0.0), self.axis, sign)
            approach = -dot(direction, normal)
            if approach <= 0.0:
                continue
            distance = dot(minus(origin, centre), normal) / approach
            met = minus(along(origin, direction, distance), centre)
            if distance >= 0.0 and math.hypot(*met) <= self.radius:
                yield distance, normal


@dataclass(frozen=True)
class Box(Shape):
    """A box about ``centre``, {n}, with edges of ``size``: length, width, height, m.

    Its length lies along ``heading``, rad, clockwise from north; its height is vertical.
    """

    kind: ClassVar[str] = "box"
    centre: Vector
    size: Vector
    heading: float = 0.0

    @cached_property
    def bound(self) -> tuple[Vector, float]:
        """Centre, {n}, and radius, m, of a sphere around it."""
        return self.centre, 0.5 * math.hypot(*self.size)

    def nearest(self, point: Sequence[float]) -> Nearest:
        """Return the face that is nearest to a point, {n}, m."""
        own = self._own(minus(point, self.centre))
        beyond = [abs(x) - 0.5 * edge for x, edge in zip(own, self.size, strict=True)]
        outside = [math.copysign(max(b, 0.0), x) for b, x in zip(beyond, own, strict=True)]
        if any(outside):
            return Nearest(math.hypot(*outside), unit(self._turned(outside)), self.kind)
        deepest = max(range(3), key=lambda k: beyond[k])
        face = [math.copysign(1.0, own[k]) if k == deepest else 0.0 for k in range(3)]
        return Nearest(beyond[deepest], self._turned(face), self.kind)

    def _entries(self, origin: Sequence[float], direction: Sequence[float]) -> Iterator[_Met]:
        own, step = self._own(minus(origin, self.centre)), self._own(direction)
        enters, leaves, face = -math.inf, math.inf, 0
        for k, edge in enumerate(self.size):
            if step[k] == 0.0:
                if abs(own[k]) > 0.5 * edge:
                    return
                continue
            near = (-math.copysign(0.5 * edge, step[k]) - own[k]) / step[k]
            if near > enters:
                enters, face = near, k
            leaves = min(leaves, (math.copysign(0.5 * edge, step[k]) - own[k]) / step[k])
        if 0.0 <= enters <= leaves:
            normal = [-math.copysign(1.0, step[k]) if k == face else 0.0 for k in range(3)]
            yield enters, self._turned(normal)

    def _own(self, v: Sequence[float]) -> Vector:
        """Return a vector of {n} in the box's axes."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])

    def _turned(self, v: Sequence[float]) -> Vector:
        """Return a vector of the box's axes in {n}."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        return (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def _enter_sphere(
    centre: Sequence[float], radius: float, origin: Sequence[float], direction: Sequence[float]
) -> Iterator[_Met]:
    out = minus(origin, centre)
    half = dot(out, direction)
    under = half * half - dot(out, out) + radius * radius
    if half < 0.0 <= under:
        distance = -half - math.sqrt(under)
        yield distance, unit(along(out, direction, distance))
