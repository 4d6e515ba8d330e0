"""Zones of a fence: polygons and circles in which a vehicle must be, or must not."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..vehicle import Vehicle
from .plan_checks import Refusal, bad_parameter, check_place, of_item
from .plan_items import Item

RETURN_POINT: int = mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT
INCLUSION_VERTEX: int = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
EXCLUSION_VERTEX: int = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION
INCLUSION_CIRCLE: int = mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
EXCLUSION_CIRCLE: int = mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION

_VERTICES = (INCLUSION_VERTEX, EXCLUSION_VERTEX)
_CIRCLES = (INCLUSION_CIRCLE, EXCLUSION_CIRCLE)
_SUPPORTED = (RETURN_POINT, *_VERTICES, *_CIRCLES)
_INCLUSIONS = (INCLUSION_VERTEX, INCLUSION_CIRCLE)


@dataclass(frozen=True)
class Zone:
    """A polygon of at least 3 ``corners``, or a circle of ``radius`` m about the only one."""

    inclusion: bool
    group: int
    """Group of an inclusion."""
    corners: tuple[Ned, ...]
    radius: float

    def contains(self, place: Ned) -> bool:
        """Return whether a place in {n} is in it, whatever its depth.

        A polygon contains what a line to the north, which crosses its edges, leaves an odd
        number of times.
        """
        north, east, _ = place
        if len(self.corners) == 1:
            (at_north, at_east, _), *_ = self.corners
            return math.hypot(north - at_north, east - at_east) <= self.radius
        inside = False
        for (n1, e1, _), (n2, e2, _) in pairwise((*self.corners, self.corners[0])):
            if (e1 > east) != (e2 > east):
                inside ^= north < n1 + (n2 - n1) * (east - e1) / (e2 - e1)
        return inside


def check_fence(items: Sequence[Item], vehicle: Vehicle) -> Refusal | None:
    """Refuse what is no part of a fence, places that are none, circles without a radius, and
    polygons that are not whole.

    A polygon is a run of at least 3 vertices of one kind, each of which has their number in
    parameter 1.
    """
    for sequence, item in enumerate(items):
        refusal = _check_item(item, vehicle)
        if refusal is not None:
            return of_item(sequence, item, refusal)
    for start, length in _runs(items):
        if length == 0:
            refusal = bad_parameter(1, items[start].number(1), "the number of alike vertices")
            return of_item(start, items[start], refusal)
    return None


def zones_of(items: Sequence[Item], vehicle: Vehicle) -> list[Zone]:
    """Return the zones of a fence that `check_fence` found good."""
    zones = []
    for start, length in _runs(items):
        item = items[start]
        places = [part.place(vehicle) for part in items[start : start + length]]
        corners = tuple(place for place in places if place is not None)
        if item.command != RETURN_POINT:
            inclusion = item.command in _INCLUSIONS
            zones.append(Zone(inclusion, round(item.number(2)), corners, item.number(1)))
    return zones


def is_allowed(zones: Sequence[Zone], place: Ned) -> bool:
    """Return whether a place in {n} is in no exclusion, and in all inclusions of some group."""
    if any(zone.contains(place) for zone in zones if not zone.inclusion):
        return False
    inclusions = [zone for zone in zones if zone.inclusion]
    outside = {zone.group for zone in inclusions if not zone.contains(place)}
    return not inclusions or any(zone.group not in outside for zone in inclusions)


def _check_item(item: Item, vehicle: Vehicle) -> Refusal | None:
    if item.command not in _SUPPORTED:
        return Refusal(mavlink.MAV_MISSION_UNSUPPORTED, "is not part of a fence")
    if item.command in _CIRCLES and not item.parameters[0] > 0.0:
        return bad_parameter(1, item.parameters[0], "a radius above 0 m")
    return check_place(item, item.place(vehicle))


def _runs(items: Sequence[Item]) -> list[tuple[int, int]]:
    """Return where each zone starts, and of how many items it is; 0 for half a polygon."""
    runs, start = [], 0
    while start < len(items):
        length = _vertices(items[start:]) if items[start].command in _VERTICES else 1
        runs.append((start, length))
        start += max(length, 1)
    return runs


def _vertices(items: Sequence[Item]) -> int:
    count = items[0].number(1)
    if not 3.0 <= count <= len(items) or count % 1.0:
        return 0
    alike = {(item.command, item.number(1), item.number(2)) for item in items[: int(count)]}
    return int(count) if len(alike) == 1 else 0
