"""Log of a real trial as a CSV file: its columns, with units, as a record of SI."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import conversion

from .figures.record import Array, Record

UNITS = {
    "time": "s",
    "north": "m",
    "east": "m",
    "latitude": "rad",
    "longitude": "rad",
    "heading": "rad",
    "helm": "rad",
    "roll": "rad",
    "depth": "m",
    "pitch": "rad",
    "power": "W",
}
"""What columns hold, and the unit of the record."""
_NEEDED = ("time", "heading")
_PLACES = (("north", "east"), ("latitude", "longitude"))


@dataclass(frozen=True)
class Column:
    """A column by its name in the file, and its unit if the file does not say it."""

    name: str
    unit: str | None = None


def read_columns(texts: Sequence[str]) -> dict[str, Column]:
    """Return columns by what they hold, from texts ``WHAT=NAME`` or ``WHAT=NAME:UNIT``.

    Several may stand in one text, with commas. Raises InputError for another form, or for a WHAT
    that is none of `UNITS`.
    """
    columns: dict[str, Column] = {}
    for part in (part.strip() for text in texts for part in text.split(",")):
        what, equals, name = part.partition("=")
        name, colon, unit = name.partition(":")
        if not (equals and name) or (colon and not unit):
            raise InputError(f"--columns: WHAT=NAME or WHAT=NAME:UNIT is needed, found {part!r}")
        if what not in UNITS:
            raise InputError(f"--columns: {unknown('column', what, UNITS)}")
        columns[what] = Column(name, unit or None)
    return columns


def read_log(path: Path, columns: Mapping[str, Column]) -> Record:
    """Return the record in a CSV file.

    The first line has the names; the second may have the units. A column of `UNITS` that
    ``columns`` does not have is the one of that name, if there is one; without a unit it is in SI
    units and rad. Latitude and longitude become north and east of the first row. Helm is positive
    to turn to starboard.

    Raises InputError, with file, line and column, for a column that is missing, a unit of another
    quantity, a cell that is no finite number, and as `Record` does.
    """
    header, units, lines, rows = _cells(path)
    named = {what: columns.get(what, Column(what)) for what in UNITS
             if what in columns or what in header}  # fmt: skip
    for what, column in named.items():
        if column.name not in header:
            raise InputError(f"{path}, line 1: {what}: {unknown('column', column.name, header)}")
    lacking = [what for what in _NEEDED if what not in named]
    if lacking or not any(all(part in named for part in place) for place in _PLACES):
        raise InputError(
            f"{path}: columns of time, heading, and north and east (or latitude and longitude) are "
            f"needed, found {', '.join(named) or 'none'}; name them with --columns"
        )
    values = {
        what: _column(path, (lines, rows), header.index(column.name), column, units, UNITS[what])
        for what, column in named.items()
    }
    if "latitude" in values:
        values |= _local(values.pop("latitude"), values.pop("longitude"))
    try:
        return Record(**values)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def read_series(path: Path, what: str, column: Column, unit: str) -> Array:
    """Return one more column of a CSV file, in ``unit``; raises InputError as `read_log`."""
    header, units, lines, rows = _cells(path)
    if column.name not in header:
        raise InputError(f"{path}, line 1: {what}: {unknown('column', column.name, header)}")
    return _column(path, (lines, rows), header.index(column.name), column, units, unit)


def _local(latitude: Array, longitude: Array) -> dict[str, Array]:
    """Return north and east of the first row, m."""
    from pymap3d import geodetic2ned

    north, east, _ = geodetic2ned(
        latitude, longitude, 0.0, latitude[0], longitude[0], 0.0, deg=False
    )
    return {"north": north, "east": east}


def _cells(path: Path) -> tuple[list[str], dict[str, str], list[int], list[list[str]]]:
    """Return names, units by name, and the rows with the number of their lines."""
    lines: list[int] = []
    rows: list[list[str]] = []
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = [name.strip() for name in next(reader, [])]
            for row in reader:
                if row and len(row) != len(header):
                    raise InputError(
                        f"{path}, line {reader.line_num}: {len(row)} values, the header has "
                        f"{len(header)}"
                    )
                if row:
                    lines.append(reader.line_num)
                    rows.append([cell.strip() for cell in row])
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: not CSV in UTF-8: {error}") from None
    units: dict[str, str] = {}
    if rows and not any(map(_is_number, rows[0])):
        units = dict(zip(header, rows.pop(0), strict=True))
        lines.pop(0)
    return header, units, lines, rows


def _column(
    path: Path,
    cells: tuple[list[int], list[list[str]]],
    place: int,
    column: Column,
    units: Mapping[str, str],
    unit: str,
) -> Array:
    where = f"{path}: column {column.name!r}"
    written = units.get(column.name)
    if column.unit and written and column.unit != written:
        raise InputError(f"{where}: the file has it in {written}, not {column.unit}")
    try:
        factor, offset = conversion(column.unit or written or unit, unit)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    values = []
    for line, row in zip(*cells, strict=True):
        if not _is_number(row[place]):
            raise InputError(
                f"{path}, line {line}, column {column.name!r}: a finite number is needed, "
                f"found {row[place]!r}"
            )
        values.append(float(row[place]))
    return np.array(values) * factor + offset


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False
