"""Angles of propulsors that turn: the one that gives a thrust, within range and rate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .bounded import Array
from .extended_thrust import Demand, Shares, components

_STAY = 0.1
"""Share of a thrust that a turn through the whole range must gain."""


class Turning(NamedTuple):
    """A propulsor that turns. rad, shares of its largest thrust."""

    along: Array
    """Wrench at share 1 in its axis, and in the next one 90 deg from it."""
    abeam: Array
    least: float
    most: float
    """Ends of the range of its angle."""
    astern: float
    ahead: float
    """Largest shares, both positive."""


def as_one(parts: Sequence[Turning]) -> Turning:
    """Return propulsors on one steering angle as one that turns, with the same share for each."""
    return parts[0]._replace(
        along=np.sum([part.along for part in parts], axis=0),
        abeam=np.sum([part.abeam for part in parts], axis=0),
        astern=min(part.astern for part in parts),
        ahead=min(part.ahead for part in parts),
    )


def fitting(direction: float, least: float, most: float, now: float) -> float | None:
    """Return the angle of a direction, any number of turns, in a range, nearest to ``now``.

    ``now`` lies in the range; None if no angle in the range has the direction. rad.
    """
    angle = now + math.remainder(direction - now, math.tau)
    if angle < least:
        angle += math.tau * math.ceil((least - angle) / math.tau)
    elif angle > most:
        angle -= math.tau * math.ceil((angle - most) / math.tau)
    return angle if least <= angle <= most else None


def angle_for(part: Turning, force: Array, now: float) -> float:
    """Return the angle that gives a force (a, b), shares along axis and abeam, from ``now``, rad.

    Of the angle that gives it ahead and the one that gives it astern, where the thrust astern is
    enough, the nearer one. Where the range has neither, the end that gives the most of it; the
    other end must give a tenth more for a turn through the whole range.
    """
    size, direction = math.hypot(force[0], force[1]), math.atan2(force[1], force[0])
    ahead = fitting(direction, part.least, part.most, now)
    astern = fitting(direction + math.pi, part.least, part.most, now)
    if ahead is not None and (astern is None or size > part.astern):
        return ahead
    if ahead is not None and astern is not None:
        return ahead if abs(ahead - now) <= abs(astern - now) else astern
    if astern is not None and part.astern > 0.0:
        return astern
    return max((part.least, part.most), key=lambda end: _worth(part, end, direction, now))


def _worth(part: Turning, end: float, direction: float, now: float) -> float:
    """Return the share of a force that an end of the range gives, less what the turn costs."""
    given = math.cos(end - direction)
    given = given if part.astern == 0.0 else abs(given)
    return given - _STAY * abs(end - now) / max(part.most - part.least, 1e-9)


def angles_for(
    demand: Demand, others: Shares, parts: list[Turning], now: list[float], idle: float
) -> list[float]:
    """Return the angles with which propulsors that turn, and others, give a demand, rad.

    Extended thrust (`components`) has a force for each, within the circle of its largest thrust.
    The rest is found anew where one cannot give its force: within the circle of its thrust astern
    if it goes astern, else with it as a part that has a direction, an end of its range. A
    propulsor with less than the share ``idle`` to give keeps its angle.
    """
    angles, circles, free = list(now), [1.0] * len(parts), list(range(len(parts)))
    while free:
        start = np.array([angles[k] for k in free])
        along = np.stack([circles[k] * parts[k].along for k in free], axis=1)
        abeam = np.stack([circles[k] * parts[k].abeam for k in free], axis=1)
        found = components(demand, others, along, abeam, start)
        forces = {k: circles[k] * force for k, force in zip(free, found, strict=True)}
        used = [k for k in free if math.hypot(forces[k][0], forces[k][1]) >= idle]
        for k in free:
            angles[k] = angle_for(parts[k], forces[k], now[k]) if k in used else now[k]
        short = [k for k in used if not _gives(parts[k], forces[k], angles[k])]
        if not short:
            break
        limited = []
        for k in short:
            astern = forces[k] @ _direction(angles[k]) < 0.0
            if astern and circles[k] > parts[k].astern > 0.0:
                circles[k] = parts[k].astern
            else:
                limited.append(k)
        others = with_directions(others, [parts[k] for k in limited], [angles[k] for k in limited])
        free = [k for k in free if k not in limited]
    return angles


def _direction(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def _gives(part: Turning, force: Array, angle: float) -> bool:
    """Return whether a propulsor gives a force at an angle, within its largest shares."""
    ahead, aside = force @ _direction(angle), force @ _direction(angle + 0.5 * math.pi)
    return bool(abs(aside) < 1e-9 and -part.astern - 1e-9 < ahead < part.ahead + 1e-9)


def with_directions(others: Shares, parts: list[Turning], angles: list[float]) -> Shares:
    """Return ``others`` and propulsors that turn, each at its angle, as parts with a direction."""
    columns = [
        p.along * math.cos(a) + p.abeam * math.sin(a) for p, a in zip(parts, angles, strict=True)
    ]
    return Shares(
        np.column_stack([others.columns, *columns]),
        np.concatenate([others.low, [-p.astern for p in parts]]),
        np.concatenate([others.high, [p.ahead for p in parts]]),
    )
