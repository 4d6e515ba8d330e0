"""Line-of-sight guidance onto straight legs and circles."""

from __future__ import annotations

import math
from typing import NamedTuple

Point = tuple[float, float, float]
"""North, east, down, m."""


class Offset(NamedTuple):
    """Where a craft is beside a path: m, rad clockwise from north."""

    course: float
    """Direction of the path abreast of the craft."""
    along: float
    """Distance along the path from its start; 0 on a circle."""
    across: float
    """Cross-track error, positive to starboard of the path."""


def from_leg(start: Point, end: Point, here: Point) -> Offset:
    """Return the offset from the straight line through two points ([Fossen2011], 10.3.2).

        course = atan2(E, N),   along = N' cos(course) + E' sin(course)
        across = -N' sin(course) + E' cos(course)

    (N, E) from start to end, (N', E') from start to here. Horizontal. A leg without a
    length leads north.
    """
    course = math.atan2(end[1] - start[1], end[0] - start[0])
    north, east = here[0] - start[0], here[1] - start[1]
    c, s = math.cos(course), math.sin(course)
    return Offset(course, c * north + s * east, c * east - s * north)


def from_circle(centre: Point, radius: float, here: Point) -> Offset:
    """Return the offset from a circle, m: clockwise for a positive radius, else the other way.

    At distance rho and bearing beta from the centre, with d the sign of the radius,

        course = beta + d 90 deg,   across = d (|radius| - rho)
    """
    way = math.copysign(1.0, radius)
    beta = math.atan2(here[1] - centre[1], here[0] - centre[0])
    rho = distance(centre, here)
    return Offset(beta + way * math.pi / 2, 0.0, way * (abs(radius) - rho))


def line_of_sight(offset: Offset, integral: float, lookahead: float, gain: float) -> float:
    """Return the heading that leads onto a path: course - atan((e + gain integral) / lookahead).

    e is the cross-track error; [Fossen2011], 10.3.2 (``lookahead``-based steering). With the
    integral of `integral_rate` it is that of Børhaug, Pavlov and Pettersen [Borhaug2008]. rad.
    """
    return offset.course - math.atan2(offset.across + gain * integral, lookahead)


def integral_rate(across: float, integral: float, lookahead: float, gain: float) -> float:
    """Return the rate of the integral, lookahead e / ((e + gain integral)^2 + lookahead^2), 1.

    The integral is in s, ``gain`` in m/s. Far from the path it grows slowly, so that coming
    from afar does not wind it up.
    """
    return lookahead * across / ((across + gain * integral) ** 2 + lookahead**2)


def distance(a: Point, b: Point) -> float:
    """Return the horizontal distance of two points, m."""
    return math.hypot(b[0] - a[0], b[1] - a[1])


def bearing(a: Point, b: Point) -> float:
    """Return the bearing of ``b`` from ``a``, rad clockwise from north."""
    return math.atan2(b[1] - a[1], b[0] - a[0])
