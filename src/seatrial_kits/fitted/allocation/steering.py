"""Angles of propulsors that turn: the one that gives a thrust, within range and rate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from .bounded import Column
from .extended_thrust import Demand, Shares, Vector, components, turned

_STAY = 0.1
"""Share of a thrust that a turn through the whole range must gain."""


class Turning(NamedTuple):
    """A propulsor that turns. rad, shares of its largest thrust."""

    along: Column
    """Wrench at share 1 in its axis, and in the next one 90 deg from it."""
    abeam: Column
    least: float
    most: float
    """Ends of the range of its angle."""
    astern: float
    ahead: float
    """Largest shares, both positive."""


def as_one(parts: Sequence[Turning]) -> Turning:
    """Return propulsors on one steering angle as one that turns, with the same share for each."""
    return parts[0]._replace(
        along=[math.fsum(row) for row in zip(*(part.along for part in parts), strict=True)],
        abeam=[math.fsum(row) for row in zip(*(part.abeam for part in parts), strict=True)],
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


def angle_for(part: Turning, force: Column, now: float) -> float:
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
    least, most = (_worth(part, end, direction, now) for end in (part.least, part.most))
    return part.most if most > least else part.least


def _worth(part: Turning, end: float, direction: float, now: float) -> float:
    """Return the share of a force that an end of the range gives, less what the turn costs."""
    given = math.cos(end - direction)
    given = given if part.astern == 0.0 else abs(given)
    return given - _STAY * abs(end - now) / max(part.most - part.least, 1e-9)


def angles_for(
    demand: Demand, others: Shares, parts: Sequence[Turning], now: Sequence[float], idle: float
) -> list[float]:
    """Return the angles with which propulsors that turn, and others, give a demand, rad.

    Extended thrust (`components`) has a force for each, within the circle of its largest thrust.
    The rest is found anew where one cannot give its force: within the circle of its thrust astern
    if it goes astern, else with it as a part that has a direction, an end of its range. A
    propulsor with less than the share ``idle`` to give keeps its angle.
    """
    steered = [_Steered(angle, 1.0, turns=True, is_given=False) for angle in now]
    while not all(one.is_given for one in steered):  # each is narrowed twice at most
        vectors = [_vector(part, one) for part, one in zip(parts, steered, strict=True)]
        found = components(demand, others, vectors)
        steered = [
            _narrowed(part, one, force, angle, idle)
            for part, one, force, angle in zip(parts, steered, found, now, strict=True)
        ]
    return [one.angle for one in steered]


class _Steered(NamedTuple):
    """How a propulsor stands in the search: its angle, and whether it gives its force there."""

    angle: float
    circle: float
    """Largest share in any direction."""
    turns: bool
    is_given: bool


def _vector(part: Turning, one: _Steered) -> Vector:
    """Return a propulsor for `components`: within its circle, or at its angle."""
    size = one.circle if one.turns else 1.0
    along, abeam = ([size * own for own in column] for column in (part.along, part.abeam))
    return Vector(along, abeam, one.angle, one.turns, -part.astern, part.ahead)


def _narrowed(part: Turning, one: _Steered, force: Column, now: float, idle: float) -> _Steered:
    """Return a propulsor at the angle for its force, from ``now``, within what it can give."""
    if not one.turns:
        return one._replace(is_given=True)
    force = (one.circle * force[0], one.circle * force[1])
    if math.hypot(force[0], force[1]) < idle:
        return one._replace(angle=now, is_given=True)
    angle = angle_for(part, force, now)
    ahead, aside = _by_direction(force, angle)
    if abs(aside) < 1e-9 and -part.astern - 1e-9 < ahead < part.ahead + 1e-9:
        return one._replace(angle=angle, is_given=True)
    if ahead < 0.0 and one.circle > part.astern > 0.0:
        return _Steered(angle, part.astern, turns=True, is_given=False)
    return _Steered(angle, one.circle, turns=False, is_given=False)


def _by_direction(force: Column, angle: float) -> tuple[float, float]:
    """Return the components of a force (a, b) in a direction and 90 deg from it."""
    c, s = math.cos(angle), math.sin(angle)
    return force[0] * c + force[1] * s, force[1] * c - force[0] * s


def with_directions(others: Shares, parts: Sequence[Turning], angles: Sequence[float]) -> Shares:
    """Return ``others`` and propulsors that turn, each at its angle, as parts with a direction."""
    columns = [turned(p.along, p.abeam, a) for p, a in zip(parts, angles, strict=True)]
    return Shares(
        [*others.columns, *columns],
        [*others.low, *[-p.astern for p in parts]],
        [*others.high, *[p.ahead for p in parts]],
    )
