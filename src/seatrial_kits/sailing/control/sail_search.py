"""Search for the best sail angle and flap in the sail's table."""

from __future__ import annotations

import math
from typing import NamedTuple

from seatrial.physics.foils import STEP, FoilTable

_ROUNDING = 1e-12
"""rad: an angle at the edge of the range is inside."""

_BROADSIDE = 18
"""The table's column of 90 deg."""

_BEYOND = 1e3
"""Worse than any drive coefficient there is."""

_Forces = tuple[float, float, float]
"""Angle, drive and side of a `Setting`."""


class Setting(NamedTuple):
    """A sail angle and flap, rad, with the forces along bow and beam that they give.

    ``drive`` and ``side`` are coefficients: force over 0.5 density area V^2, positive to the
    bow and to starboard.
    """

    angle: float
    flap: float
    drive: float
    side: float


def setting(table: FoilTable, beta: float, angle: float, flap: float) -> Setting:
    """Return what a sail ``angle`` and ``flap``, rad, give in a wind that blows to ``beta``.

        alpha = beta - angle + pi                        [Silva2018], eq. 2.20
        drive = -C_L sin(beta) + C_D cos(beta)           eq. 3.34
        side  = C_L cos(beta) + C_D sin(beta)            eq. 2.21

    ``beta`` is the direction of the apparent wind from the bow, to starboard positive, rad.
    """
    c_l, c_d = table.coefficients(beta - angle + math.pi, flap)
    s, c = math.sin(beta), math.cos(beta)
    return Setting(angle, flap, c_d * c - c_l * s, c_l * c + c_d * s)


def best_setting(
    table: FoilTable, beta: float, least: float, most: float, most_side: float | None = None
) -> Setting:
    """Return the setting with the greatest drive.

    Searched are every flap and every alpha of the table that give an angle from ``least`` to
    ``most``, rad, 0 or more (boom to port), and ``most`` itself with every flap. Of equals, that
    of the smallest flap, then of the smallest alpha.

    With ``most_side``, only settings with at most that side force are taken, among them those
    between two rows of alpha at which it is just reached; if there is none, the one with the
    least side force is taken. Then alpha is at most 90 deg, apart from ``most`` itself: on the
    way to settings beyond, the sail would pass those with the greatest drag.
    """
    s, c = math.sin(beta), math.cos(beta)
    rows = list(zip(table.lift, table.drag, strict=True))
    ends = [
        _forces(most, *table.coefficients(beta - most + math.pi, row * STEP), s, c)
        for row in range(len(rows))
    ]
    ends_between_rows = math.remainder(beta - most + math.pi, math.tau) >= 0.0
    before = ends if ends_between_rows else None
    best = _Best(-math.inf, 0, (0.0, 0.0, 0.0))
    for column in range(len(table.lift[0]) if most_side is None else _BROADSIDE + 1):
        alone = math.remainder(beta - column * STEP + math.pi, math.tau)
        if not least - _ROUNDING <= alone <= most + _ROUNDING:
            continue
        angle = min(max(alone, least), most)
        here = [_forces(angle, lift[column], drag[column], s, c) for lift, drag in rows]
        for row, forces in enumerate(here):
            best = _better(best, row, forces, most_side)
        if most_side is not None and before is not None:
            for row, (one, other) in enumerate(zip(before, here, strict=True)):
                best = _just_reached(best, row, one, other, most_side)
        before = here
    for row, forces in enumerate(ends):
        best = _better(best, row, forces, most_side)
    angle, drive, side = best.forces
    return Setting(angle, best.row * STEP, drive, side)


class _Best(NamedTuple):
    """The best forces so far, with their rank and the table's row."""

    rank: float
    row: int
    forces: _Forces


def _forces(angle: float, c_l: float, c_d: float, s: float, c: float) -> _Forces:
    return angle, c_d * c - c_l * s, c_l * c + c_d * s


def _better(best: _Best, row: int, forces: _Forces, most_side: float | None) -> _Best:
    """Return the better of two; of equals that of the smaller flap, else the former."""
    _angle, drive, side = forces
    keeps = most_side is None or abs(side) <= most_side
    rank = drive if keeps else -_BEYOND - abs(side)
    if rank > best.rank or (rank == best.rank and row < best.row):
        return _Best(rank, row, forces)
    return best


def _just_reached(best: _Best, row: int, before: _Forces, after: _Forces, side: float) -> _Best:
    """Return the best, settings between neighbours with just that side force included.

    Coefficients are linear in alpha between the table's rows, so forces are too.
    """
    for target in (side, -side):
        if (before[2] - target) * (after[2] - target) < 0.0:
            share = (target - before[2]) / (after[2] - before[2])
            angle, drive = (b + share * (a - b) for b, a in zip(before[:2], after[:2], strict=True))
            best = _better(best, row, (angle, drive, target), side)
    return best
