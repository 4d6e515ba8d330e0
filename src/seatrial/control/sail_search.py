"""Search for the best sail angle and flap in the sail's table."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

from ..foils import STEP, FoilTable

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

        alpha = beta - angle + pi                        source 001, eq. 2.20
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
    count = len(table.lift[0]) if most_side is None else _BROADSIDE + 1
    columns = _columns(count, beta, least, most)
    ends_between_rows = math.remainder(beta - most + math.pi, math.tau) >= 0.0
    highest, chosen = -math.inf, (0, 0.0, 0.0, 0.0)
    for row, (lift, drag) in enumerate(zip(table.lift, table.drag, strict=True)):
        offered = [(angle, lift[column], drag[column]) for column, angle in columns]
        offered.append((most, *table.coefficients(beta - most + math.pi, row * STEP)))
        forces = [(angle, d * c - lft * s, lft * c + d * s) for angle, lft, d in offered]
        if most_side is not None:
            neighbours = forces[-1:] + forces[:-1] if ends_between_rows else forces[:-1]
            forces += _just_reached(neighbours, most_side)
        for angle, drive, side in forces:
            keeps = most_side is None or abs(side) <= most_side
            rank = drive if keeps else -_BEYOND - abs(side)
            if rank > highest:
                highest, chosen = rank, (row, angle, drive, side)
    row, angle, drive, side = chosen
    return Setting(angle, row * STEP, drive, side)


def _just_reached(forces: list[_Forces], side: float) -> list[_Forces]:
    """Return where the side force is ``side``, to port or starboard, between neighbours.

    Coefficients are linear in alpha between the table's rows, so forces are too.
    """
    found = []
    for before, after in pairwise(forces):
        for target in (side, -side):
            if (before[2] - target) * (after[2] - target) < 0.0:
                share = (target - before[2]) / (after[2] - before[2])
                angle, drive = (
                    b + share * (a - b) for b, a in zip(before[:2], after[:2], strict=True)
                )
                found.append((angle, drive, target))
    return found


def _columns(count: int, beta: float, least: float, most: float) -> list[tuple[int, float]]:
    """Return which of the first columns (alpha) give an angle in the range, and the angle."""
    found = []
    for column in range(count):
        angle = math.remainder(beta - column * STEP + math.pi, math.tau)
        if least - _ROUNDING <= angle <= most + _ROUNDING:
            found.append((column, min(max(angle, least), most)))
    return found
