"""Courses of a sailing boat that cannot tack: beating, and turning by wearing round."""

from __future__ import annotations

import math
from typing import NamedTuple


class Laid(NamedTuple):
    """A course that can be sailed: rad clockwise from north."""

    course: float
    tack: int
    """1 if it lies to starboard of where the wind comes from, -1 to port."""
    beats: bool
    """Whether it is not the one asked for, but the nearest on its tack."""


def laid(wanted: float, eye: float, tack: int, closest: float, margin: float) -> Laid:
    """Return the course to sail for the one that is ``wanted``, being on ``tack``.

    With off = wanted - eye in +-180 deg, ``eye`` the direction that the wind comes from: it is
    ``wanted`` if abs(off) is at least ``closest``, and ``closest`` + ``margin`` on the other tack;
    else ``closest`` off the wind on this tack. So a boat beats in long boards.
    """
    off = math.remainder(wanted - eye, math.tau)
    if abs(off) >= closest + (margin if off * tack < 0.0 else 0.0):
        return Laid(wanted, side(off), False)
    return Laid(eye + tack * closest, tack, True)


def side(off: float) -> int:
    """Return the tack of a direction ``off`` the wind, rad: 1 to starboard of its eye, else -1."""
    return 1 if off >= 0.0 else -1


def turn(before: float, course: float, eye: float) -> float:
    """Return the turn from ``before`` to ``course`` that keeps out of the wind's eye, rad.

    Beyond 180 deg it is the longer way, through dead downwind: wearing round.
    """
    shorter = math.remainder(course - before, math.tau)
    off = math.remainder(before - eye, math.tau)
    # Where the turn ends, counted on through the eye: a change of sign has passed it.
    if off * (off + shorter) < 0.0:
        return shorter - math.copysign(math.tau, shorter)
    return shorter


def turned(before: float, turn: float, most: float, heading: float, lead: float) -> float:
    """Return the heading wanted, ``most`` on from ``before`` at most along ``turn``; rad.

    It waits while it is more than ``lead`` ahead of the boat's ``heading``.
    """
    after = before + min(max(turn, -most), most)
    ahead = math.remainder(after - heading, math.tau)
    return before if abs(ahead) > lead and ahead * turn > 0.0 else after
