"""Places of what a camera has seen, and headings that stay clear of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

OBSTACLE = 2
"""Kind of a detection that is avoided."""
_PREFERENCE = math.radians(30.0)
"""By how much the other side has to be better, once a side is chosen."""
_WEIGHT = 0.4
"""Of a new sighting in the place of what was seen before."""

Track = list[float]
"""North and east, m; instant of the last sighting, s; number of sightings."""


class Sighting(NamedTuple):
    """A detection as a place: north and east, m, and how far away it seems, m."""

    north: float
    east: float
    distance: float


def placed(
    bearing: float, size: float, diameter: float, here: Sequence[float], heading: float
) -> Sighting | None:
    """Return where a sphere of ``diameter`` is that is seen at ``bearing`` with ``size``, rad."""
    if size <= 0.0:
        return None
    distance = 0.5 * diameter / math.sin(0.5 * min(size, math.pi))
    towards = heading + bearing
    return Sighting(
        here[0] + distance * math.cos(towards), here[1] + distance * math.sin(towards), distance
    )


def watched(
    tracks: Sequence[Track], sightings: Sequence[Sighting], t: float, forget: float
) -> list[Track]:
    """Return the tracks with the sightings of a frame; what was not seen for ``forget`` is gone.

    A sighting belongs to the nearest track within 5 m and a third of its distance.
    """
    kept = [list(track) for track in tracks if t - track[2] <= forget]
    for seen in sightings:
        gate = 5.0 + seen.distance / 3.0
        near = [(math.dist(track[:2], seen[:2]), track) for track in kept]
        near = [each for each in near if each[0] <= gate]
        if not near:
            kept.append([seen.north, seen.east, t, 1.0])
            continue
        _, track = min(near, key=lambda each: each[0])
        track[0] += _WEIGHT * (seen.north - track[0])
        track[1] += _WEIGHT * (seen.east - track[1])
        track[2:] = [t, track[3] + 1.0]
    return kept


def clear_heading(
    wanted: float,
    places: Sequence[Sequence[float]],
    here: Sequence[float],
    clearance: float,
    eye: float,
    closest: float,
    side: float,
) -> float:
    """Return the heading nearest to ``wanted`` that passes all places at ``clearance``, rad.

    A place at the distance r shuts out asin(clearance / r) to both sides of its bearing, a quarter
    turn within the clearance. Headings closer to the wind's ``eye`` than ``closest`` are none;
    ``side``, of which the sign counts, is how the heading was turned before. If there is none it is
    ``wanted``.
    """
    cones = []
    for place in places:
        north, east = place[0] - here[0], place[1] - here[1]
        distance = math.hypot(north, east)
        half = math.asin(clearance / distance) if distance > clearance else math.pi / 2
        cones.append((math.atan2(east, north), half))
    if all(_off(wanted, bearing) >= half for bearing, half in cones):
        return wanted
    best, least = wanted, math.inf
    for bearing, half in cones:
        for edge in (bearing - half, bearing + half):
            free = all(_off(edge, b) >= h - 1e-9 for b, h in cones)
            if not free or _off(edge, eye) < closest:
                continue
            turned = math.remainder(edge - wanted, math.tau)
            cost = abs(turned) + (_PREFERENCE if turned * side < 0.0 else 0.0)
            if cost < least:
                best, least = wanted + turned, cost
    return best


def _off(one: float, other: float) -> float:
    return abs(math.remainder(one - other, math.tau))
