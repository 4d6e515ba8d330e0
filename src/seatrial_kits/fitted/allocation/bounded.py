"""Weighted least squares with bounds, by an active-set method, in scalars of one order."""

from __future__ import annotations

import math
from collections.abc import Sequence

Column = Sequence[float]

_SLACK = 1e-12
"""Share of the largest gradient that rounding may leave."""


def weighted_least_squares(
    columns: Sequence[Column],
    wanted: Column,
    weights: Column,
    effort: Column,
    low: Column,
    high: Column,
) -> list[float]:
    """Return the x that minimises |W (B x - tau)|^2 + sum eps_i x_i^2 within low <= x <= high.

    B has n ``columns`` of m; tau = ``wanted`` (m), W = diag(``weights``) (m), eps = ``effort``
    (n, positive, so that x is unique). ``low`` is not above ``high``; alike, they fix an x.

    The active-set method of Härkegård (2002) for control allocation ([Fossen2021], ch. 11):
    x moves to the least squares of the variables that are free, up to the first bound in its way,
    which becomes active; there, of the active bounds from which the gradient leads inwards, the
    one with the steepest is released. Each step takes no chance: the same numbers give the same x,
    in native code too.
    """
    scaled = [weighted(column, weights) for column in columns]
    goal = weighted(wanted, weights)
    x = [within(0.0, least, most) for least, most in zip(low, high, strict=True)]
    free = [least < most for least, most in zip(low, high, strict=True)]
    rest, released = short_of(goal, scaled, x), -1
    for _ in range(10 * (len(x) + 1)):  # each bound comes and goes a few times at most
        move = _to_the_least(scaled, effort, rest, x, free)
        share, blocking = _share_within(x, move, low, high)
        ends = [
            most if step > 0.0 else least for step, least, most in zip(move, low, high, strict=True)
        ]
        moved = [
            within(at + share * step, least, most)
            for at, step, least, most in zip(x, move, low, high, strict=True)
        ]
        # Exactly on its bound, whatever rounding left.
        x = [
            end if i == blocking else at
            for i, (end, at) in enumerate(zip(ends, moved, strict=True))
        ]
        rest = short_of(goal, scaled, x)
        if blocking >= 0:
            if blocking == released and share == 0.0:
                break  # rounding has led inwards
            released = -1
            free = [one and i != blocking for i, one in enumerate(free)]
            continue
        descent = [
            dot(column, rest) - eps * at for column, eps, at in zip(scaled, effort, x, strict=True)
        ]
        released = _inwards(descent, x, free, low, high)
        if released < 0:
            break
        free = [one or i == released for i, one in enumerate(free)]
    return x


def weighted(column: Column, weights: Column) -> list[float]:
    """Return a column, row by row times its weight."""
    return [weight * one for weight, one in zip(weights, column, strict=True)]


def within(value: float, least: float, most: float) -> float:
    """Return a value, or the limit beyond which it is."""
    return min(max(value, least), most)


def dot(a: Column, b: Column) -> float:
    """Return the scalar product of a and b, summed from the first on."""
    total = 0.0
    for one, other in zip(a, b, strict=True):
        total += one * other
    return total


def short_of(goal: Column, columns: Sequence[Column], x: Column) -> list[float]:
    """Return goal - B x."""
    rest = list(goal)
    for column, share in zip(columns, x, strict=True):
        rest = [left - share * one for left, one in zip(rest, column, strict=True)]
    return rest


def _to_the_least(
    columns: Sequence[Column], effort: Column, rest: Column, x: Column, free: Sequence[bool]
) -> list[float]:
    """Return the move of the free variables to their least squares; the others stay.

    QR decomposition by Householder's reflections of B above diag(sqrt(eps)), row by row from the
    first: of a column, m rows of what is left are other than 0, and its own on the diagonal. The
    column of a variable that is not free is 0, and so is its move. Rows of B should come with
    the largest first: each keeps its own precision then (Cox & Higham 1998).
    """
    left = [
        [one if is_free else 0.0 for one in c] for c, is_free in zip(columns, free, strict=True)
    ]
    triangle: list[tuple[float, float, list[float]]] = []
    for eps, at, is_free in zip(effort, x, free, strict=True):
        pivot, *left = left
        root = math.sqrt(eps)
        size = math.copysign(math.sqrt(dot(pivot, pivot) + eps), pivot[0])
        mirror = [pivot[0] + size, *pivot[1:], root]
        by = 1.0 / (size * mirror[0])
        left = [_mirrored([*other, 0.0], mirror, by) for other in left]
        rest = _mirrored([*rest, -root * at if is_free else 0.0], mirror, by)
        triangle.append((-size, rest[0], [other[0] for other in left]))
        left, rest = [other[1:] for other in left], rest[1:]
    move: list[float] = []
    for (size, aim, row), is_free in reversed(list(zip(triangle, free, strict=True))):
        # Exactly 0 for the others, whatever rounding left.
        move = [(aim - dot(row, move)) / size if is_free else 0.0, *move]
    return move


def _mirrored(column: Column, mirror: Column, by: float) -> list[float]:
    """Return (1 - by v v') c, a reflection of c = ``column`` along v = ``mirror``."""
    share = dot(mirror, column) * by
    return [one - share * v for one, v in zip(column, mirror, strict=True)]


def _share_within(x: Column, move: Column, low: Column, high: Column) -> tuple[float, int]:
    """Return the largest share of a move, up to 1, within the bounds, and the bound it meets.

    That is the number of a variable, -1 for none.
    """
    share, blocking = 1.0, -1
    for i, (at, step, least, most) in enumerate(zip(x, move, low, high, strict=True)):
        way = (most if step > 0.0 else least) - at
        if abs(way) < share * abs(step):
            share, blocking = way / step, i
    return share, blocking


def _inwards(descent: Column, x: Column, free: Sequence[bool], low: Column, high: Column) -> int:
    """Return the active bound from which the descent leads inwards the steepest, -1 for none."""
    steepest, found, largest = 0.0, -1, 0.0
    rows = zip(descent, x, free, low, high, strict=True)
    for i, (slope, at, is_free, least, most) in enumerate(rows):
        largest = max(largest, abs(slope))
        inward = -slope if at == most else slope
        if not is_free and least < most and inward > steepest:
            steepest, found = inward, i
    return found if steepest > _SLACK * largest else -1
