"""Lift and drag of foils over angle of attack and flap, from the tables of [Silva2018].

They stand here because equations of motion (as expressions) and sail controllers (as numbers)
read the same tables.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..errors import InputError, unknown

DATA_FILES = ("sail_naca0015.csv", "foil_naca63010.csv")

SAIL_ENTRIES = ("verbatim", "patched")
HIGH_ALPHA = ("table", "physical")

STEP = math.radians(5.0)
"""Distance of the tables' rows, in angle of attack and in flap, rad."""

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class FoilTable:
    """C_L and C_D of a foil: one row per flap (0, 5, ... deg), in it one value per |alpha|.

    |alpha| goes from 0 to 180 deg in steps of 5. Between the points both coefficients are
    linear in |alpha| and in the flap. C_L is odd in alpha and C_D even: the flap is given by
    its size, and lies towards the side of the lift. A flap beyond the rows is taken as the
    nearest one.
    """

    lift: Rows
    drag: Rows

    def coefficients(self, alpha: float, flap: float = 0.0) -> tuple[float, float]:
        """Return (C_L, C_D) at angle of attack ``alpha`` and ``flap``, rad."""
        wrapped = math.remainder(alpha, math.tau)
        column, share = _interval(abs(wrapped), len(self.lift[0]))
        row, flap_share = _interval(flap, len(self.lift))
        below = min(row + 1, len(self.lift) - 1)
        lift, drag = (
            (1.0 - flap_share) * _between(rows[row], column, share)
            + flap_share * _between(rows[below], column, share)
            for rows in (self.lift, self.drag)
        )
        return (-lift if wrapped < 0.0 else lift), drag


@cache
def sail_naca0015(entry: str = "verbatim", high_alpha: str = "table") -> FoilTable:
    """Return the sail's table: NACA 0015, flaps 0 to 30 deg; [Silva2018], table A.2.

    ``entry``: "verbatim", or "patched": C_L of flap 15, alpha 175 deg is -0.6 where the source
    prints -1.6 between neighbours of -0.142, -1.2, 0.2 and -1.4.
    ``high_alpha``: "table", or "physical": C_L beyond 90 deg negated, as the lift of a plate
    that meets the flow with its trailing edge has it, C_L(180 deg - alpha) = -C_L(alpha). That
    is right for the part of the lift that comes from alpha; near 180 deg it also negates what
    comes from the flap.

    Raises InputError for another text.
    """
    _require("entry", entry, SAIL_ENTRIES)
    rows = _read("sail_naca0015.csv")
    flaps = sorted({flap for flap, *_ in rows})
    lift = [[c_l for f, _alpha, c_l, _c_d in rows if f == flap] for flap in flaps]
    drag = [[c_d for f, _alpha, _c_l, c_d in rows if f == flap] for flap in flaps]
    if entry == "patched":
        lift[3][35] = -0.6
    return _table(lift, drag, high_alpha)


@cache
def foil_naca63010(high_alpha: str = "table") -> FoilTable:
    """Return the table of keel and rudder: NACA 63-010, no flap; [Silva2018], table A.1.

    The row of 180 deg, which the source lacks, mirrors that of 0. ``high_alpha`` as of
    `sail_naca0015`. Raises InputError for another text.
    """
    rows = _read("foil_naca63010.csv")
    _zero, c_l, c_d = rows[0]
    lift = [*(row[1] for row in rows), -c_l]
    drag = [*(row[2] for row in rows), c_d]
    return _table([lift], [drag], high_alpha)


def _table(lift: list[list[float]], drag: list[list[float]], high_alpha: str) -> FoilTable:
    _require("high_alpha", high_alpha, HIGH_ALPHA)
    if high_alpha == "physical":
        lift = [[*row[:19], *(-c_l for c_l in row[19:])] for row in lift]
    return FoilTable(tuple(map(tuple, lift)), tuple(map(tuple, drag)))


def _require(what: str, found: str, allowed: tuple[str, ...]) -> None:
    if found not in allowed:
        raise InputError(unknown(what, found, allowed))


def _read(name: str) -> list[list[float]]:
    _head, *lines = Path(__file__).with_name(name).read_text("ascii").split()
    return [[float(digits) for digits in line.split(",")] for line in lines]


def _interval(angle: float, count: int) -> tuple[int, float]:
    """Return the row at or below ``angle`` of ``count`` rows, and the share of the next one."""
    place = min(max(angle / STEP, 0.0), count - 1.0)
    index = int(place)
    return index, place - index


def _between(row: tuple[float, ...], index: int, share: float) -> float:
    return row[index] if share == 0.0 else (1.0 - share) * row[index] + share * row[index + 1]
