"""Guidance laws: path following, station keeping, steering, for one goal."""

from __future__ import annotations

import math
from typing import NamedTuple

from .guidance_path import (
    Offset,
    Point,
    bearing,
    distance,
    from_circle,
    from_leg,
    integral_rate,
    line_of_sight,
)

NEUTRAL, MANUAL, STAY, FOLLOW, STEER, BEAT = range(6)
"""What a craft does: nothing, manual control, stay, follow a leg, steer a heading, beat."""


class Goal(NamedTuple):
    """What is wanted. SI, rad, depths positive down."""

    motion: int
    end: Point
    """Where to stay, where a leg ends; of steering the depth alone."""
    start: Point = (0.0, 0.0, 0.0)
    """Where a leg begins."""
    speed: float = 0.0
    radius: float = 0.0
    """Radius of acceptance about the end of a leg."""
    circle: float = 0.0
    """Radius of the circle to stay on, negative for anticlockwise; 0 to come to rest."""
    heading: float | None = None
    """Heading to steer; None keeps the last one."""


class Law(NamedTuple):
    """Settings of the guidance laws. SI."""

    lookahead: float
    integral_gain: float
    drift_limit: float
    capture_radius: float
    approach_gain: float = math.inf
    depth_tolerance: float = math.inf
    vanes: bool = False
    """Whether it stays at the drift limit, with its bow to the point, once it drifts so far."""


class Past(NamedTuple):
    """What was so at the last instant, for one goal."""

    heading: float
    arrived: bool = False
    away: bool = False
    integral: float = 0.0


class Command(NamedTuple):
    """What to do now, and what to remember of it."""

    motion: int
    heading: float
    speed: float
    depth: float
    distance: float = 0.0
    across: float = 0.0
    arrived: bool = False
    away: bool = False
    integral_rate: float = 0.0


def command(goal: Goal, law: Law, here: Point, past: Past) -> Command:
    """Return what leads to ``goal`` from ``here``, whose down is the depth."""
    if goal.motion == STEER:
        heading = past.heading if goal.heading is None else goal.heading
        return Command(STEER, heading, goal.speed, goal.end[2])
    if goal.motion == STAY or past.arrived:
        return _stay(goal, law, here, past)._replace(arrived=past.arrived)
    if distance(here, goal.end) <= goal.radius:
        deep_enough = abs(here[2] - goal.end[2]) <= law.depth_tolerance
        return _stay(goal, law, here, past)._replace(arrived=deep_enough)
    return _follow(goal, law, here, past)


def _follow(goal: Goal, law: Law, here: Point, past: Past) -> Command:
    offset, length = from_leg(goal.start, goal.end, here), distance(goal.start, goal.end)
    wanted = Command(FOLLOW, 0.0, goal.speed, goal.end[2], distance(here, goal.end))
    if length == 0.0:
        return wanted._replace(heading=bearing(here, goal.end))
    if offset.along >= length:
        return wanted._replace(heading=bearing(here, goal.end), across=offset.across)
    share = max(0.0, offset.along / length)
    depth = goal.start[2] + share * (goal.end[2] - goal.start[2])
    return _led(offset, law, past, wanted._replace(depth=depth))


def _stay(goal: Goal, law: Law, here: Point, past: Past) -> Command:
    off, depth = distance(here, goal.end), goal.end[2]
    if goal.circle:
        offset = from_circle(goal.end, goal.circle, here)
        return _led(offset, law, past, Command(STAY, 0.0, goal.speed, depth, off))
    if law.vanes:
        beyond = max(off - law.drift_limit, 0.0)
        heading = bearing(here, goal.end) if beyond else past.heading
        return Command(STAY, heading, min(goal.speed, law.approach_gain * beyond), depth, off)
    if off <= (law.capture_radius if past.away else law.drift_limit):
        return Command(STAY, past.heading, 0.0, depth, off)
    speed = min(goal.speed, law.approach_gain * off)
    return Command(STAY, bearing(here, goal.end), speed, depth, off, away=True)


def _led(offset: Offset, law: Law, past: Past, wanted: Command) -> Command:
    """Return ``wanted`` with the heading that leads onto a path."""
    integral, lookahead, gain = past.integral, law.lookahead, law.integral_gain
    return wanted._replace(
        heading=line_of_sight(offset, integral, lookahead, gain),
        across=offset.across,
        integral_rate=integral_rate(offset.across, integral, lookahead, gain),
    )
