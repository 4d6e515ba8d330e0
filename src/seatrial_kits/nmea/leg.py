"""Leg between two waypoints, and a vessel's place on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

_LEAST_CLOSING = 0.05
"""m/s, below which there is no time of arrival."""


@dataclass(frozen=True)
class LegStatus:
    """Where a vessel is on a leg; distances in m, bearings in rad clockwise from north."""

    number: int
    """That of its waypoint; the leg begins at the one before."""
    begin: tuple[float, float]
    """North and east, m."""
    end: tuple[float, float]
    cross_track: float
    """Positive to starboard of the leg."""
    direction: float
    """Of the leg; to the waypoint where both ends are one."""
    bearing: float
    """From the vessel to the waypoint."""
    distance: float
    passed: bool
    """Whether the waypoint is abeam or behind."""
    arrived: bool
    """Whether the vessel is within the waypoint's circle."""
    closing: float | None
    """Speed towards the waypoint, m/s, None without a velocity."""

    @property
    def time(self) -> float | None:
        """Time to the waypoint at the speed towards it, s; None if it does not come nearer."""
        if self.closing is None or self.closing < _LEAST_CLOSING:
            return None
        return self.distance / self.closing


def leg_status(
    number: int,
    begin: Sequence[float],
    end: Sequence[float],
    radius: float,
    position: Sequence[float],
    velocity: Sequence[float] | None,
) -> LegStatus:
    """Return a vessel's place on leg ``number``, all north and east of the origin, m and m/s."""
    north, east = end[0] - position[0], end[1] - position[1]
    bearing, distance = math.atan2(east, north), math.hypot(north, east)
    along = (end[0] - begin[0], end[1] - begin[1])
    direction = math.atan2(along[1], along[0]) if any(along) else bearing
    ahead = north * math.cos(direction) + east * math.sin(direction)
    closing = None
    if velocity is not None:
        closing = velocity[0] * math.cos(bearing) + velocity[1] * math.sin(bearing)
    return LegStatus(
        number,
        (begin[0], begin[1]),
        (end[0], end[1]),
        north * math.sin(direction) - east * math.cos(direction),
        direction,
        bearing,
        distance,
        bool(any(along) and ahead <= 0.0),
        distance <= radius,
        closing,
    )
