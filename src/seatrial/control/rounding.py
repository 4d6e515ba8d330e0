"""A course round marks that are left to port or to starboard."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..errors import InputError
from ..model.waypoints import Place

SIDES = {"port": 1, "starboard": -1, "any": 0}
"""The side on which a mark is left, and on which hand the course goes past it: 1 to its right."""
_LARGEST = math.radians(60.0)
"""Between two points of the arc round a mark, at most."""


def read_sides(text: str) -> list[int]:
    """Return the side of each word of ``port starboard any``. Raises InputError."""
    for word in text.split():
        if word not in SIDES:
            raise InputError(f"sides: {word!r} is none of {', '.join(SIDES)}")
    return [SIDES[word] for word in text.split()]


def rounded(
    start: Place, marks: Sequence[Place], sides: Sequence[int], clearance: float
) -> list[tuple[Place, int]]:
    """Return the points of a course round the marks, each with how many marks are passed there.

    From ``start``, in {n}, m. A mark to be left on no side is a point itself. Another is passed at
    ``clearance``: on points of a circle about it, from abeam of the course that comes to it to
    abeam of the one that goes on, at most 60 degrees apart, where the course turns towards the
    mark; at one point, abeam of the mean of both, where it turns away or goes on straight. So a
    string laid along the course, drawn tight, touches each mark on the side that is asked for.
    """
    found: list[tuple[Place, int]] = []
    before = start
    for number, (mark, side) in enumerate(zip(marks, sides, strict=True), 1):
        if not side:
            found.append((mark, number))
            before = mark
            continue
        arriving = _direction(before, mark)
        last = number == len(marks)
        turn = 0.0 if last else math.remainder(_direction(mark, marks[number]) - arriving, math.tau)
        if math.pi - abs(turn) < 1e-9:  # back where it came from: round the mark
            turn = -side * math.pi
        # Abeam: to the right of a mark that is left to port.
        abeam = arriving + side * math.pi / 2
        inward = turn * side < 0.0
        steps = math.ceil(abs(turn) / _LARGEST - 1e-9) if inward else 0
        angles = (
            [abeam + turn * i / steps for i in range(steps + 1)] if steps else [abeam + turn / 2]
        )
        for i, angle in enumerate(angles, 1):
            north, east = (
                mark[0] + clearance * math.cos(angle),
                mark[1] + clearance * math.sin(angle),
            )
            found.append(((north, east, mark[2]), number if i == len(angles) else number - 1))
        before = mark
    return found


def _direction(begin: Place, end: Place) -> float:
    return math.atan2(end[1] - begin[1], end[0] - begin[0])
