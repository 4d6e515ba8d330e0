"""Extended thrust: rectangular components of propulsors that turn, within circles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from .bounded import Column, dot, short_of, weighted_least_squares

EFFORT = 1e-8
"""Weight of the sum of squares of shares: of all that give the demand, the least are taken."""
_STEPS, _SETTLED = 25, 1e-6
"""Most steps of the sequence, and the turn in rad with which it ends."""


class Demand(NamedTuple):
    """A wrench that is asked for, rows of N or N.m, and the weight of each."""

    wanted: Column
    weights: Column


class Shares(NamedTuple):
    """Parts with a direction: what each gives at share 1, by columns, and the shares it has."""

    columns: Sequence[Column]
    low: Column
    high: Column


class Vector(NamedTuple):
    """A propulsor that turns within a circle, or one that has its angle for good."""

    along: Column
    """Wrench at share 1 in its axis, and in the next one 90 deg from it."""
    abeam: Column
    angle: float
    """Where it begins, or stays, rad."""
    turns: bool
    low: float
    high: float
    """Shares at its angle, of one that does not turn."""


def shares_of(demand: Demand, parts: Shares) -> list[float]:
    """Return the shares of parts with a direction that give a demand, as they can."""
    effort = [EFFORT] * len(parts.low)
    return weighted_least_squares(parts.columns, *demand, effort, parts.low, parts.high)


def components(
    demand: Demand, others: Shares, parts: Sequence[Vector]
) -> list[tuple[float, float]]:
    """Return the rectangular components of propulsors that turn, along and abeam, as shares.

    The components (a, b) of all of them, and the shares of the ``others``, have the least

        |W (B x - tau)|^2 + eps |x|^2,    a^2 + b^2 <= 1 of each

    (Sørdalen 1997; [Fossen2021], ch. 11): B is constant, so that no direction is singular.
    The circles are met by sequential quadratic programming: axes that are turned by the
    direction of the last solution, from that of the part, bound the component ahead by 1, and the
    multiplier of that bound, which is the curvature of the circle, weighs the one abeam. The
    sequence converges quadratically. Components that it leaves outside their circle are cut off.
    Of a part that does not turn they are at its angle, as its shares allow.
    """
    angles, curvatures = [part.angle for part in parts], [0.0 for _ in parts]
    ahead, aside = [0.0 for _ in parts], [0.0 for _ in parts]
    wide = [1.0 if part.turns else 0.0 for part in parts]
    low = [*others.low, *[-1.0 if part.turns else part.low for part in parts], *[-w for w in wide]]
    high = [*others.high, *[1.0 if part.turns else part.high for part in parts], *wide]
    first, last = len(others.low), len(others.low) + len(parts)
    for _ in range(_STEPS):
        at = list(zip(parts, angles, strict=True))
        fore = [turned(part.along, part.abeam, angle) for part, angle in at]
        columns = [
            *others.columns,
            *fore,
            *[turned(part.abeam, [-a for a in part.along], angle) for part, angle in at],
        ]
        effort = [EFFORT] * last + [EFFORT + own for own in curvatures]
        x = weighted_least_squares(columns, *demand, effort, low, high)
        ahead, aside = x[first:last], x[last:]
        missing = short_of(demand.wanted, columns, x)
        rest = [w * w * one for w, one in zip(demand.weights, missing, strict=True)]
        pulls = [dot(column, rest) - EFFORT * a for column, a in zip(fore, ahead, strict=True)]
        curvatures = [
            max(pull, 0.0) if a == 1.0 else 0.0 for pull, a in zip(pulls, ahead, strict=True)
        ]
        turns = [
            math.atan2(b, a) if part.turns else 0.0
            for part, a, b in zip(parts, ahead, aside, strict=True)
        ]
        angles = [angle + turn for angle, turn in zip(angles, turns, strict=True)]
        if not any(
            abs(turn) > _SETTLED and math.hypot(a, b) > 1.0
            for turn, a, b in zip(turns, ahead, aside, strict=True)
        ):
            break
    sizes = [
        min(math.hypot(a, b), 1.0) if part.turns else a
        for part, a, b in zip(parts, ahead, aside, strict=True)
    ]
    return [
        (size * math.cos(angle), size * math.sin(angle))
        for size, angle in zip(sizes, angles, strict=True)
    ]


def turned(along: Column, abeam: Column, angle: float) -> list[float]:
    """Return the wrench at share 1 of a propulsor at an angle, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return [c * a + s * b for a, b in zip(along, abeam, strict=True)]
