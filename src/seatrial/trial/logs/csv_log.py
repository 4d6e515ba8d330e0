"""CSV files as logs: a line of names, perhaps one of units, then numbers."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass, replace
from datetime import datetime, time
from pathlib import Path

import numpy as np

from ...errors import InputError, unknown
from .channels import Array, Channel, Log, channel
from .clock_times import of_day, parsed_time, past_midnight
from .formats import Format
from .quantities import QUANTITIES, Column, series
from .run_log import of_craft

_SEPARATORS = (";", "\t", ",")
_WITH_UNIT = re.compile(r"(.+?)\s*[\[(]([^\[\]()]+)[\])]")
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass(frozen=True)
class _Table:
    """The cells of a file: names and units of the columns, rows with the number of their lines."""

    path: Path
    names: list[str]
    units: list[str | None]
    lines: list[int]
    rows: list[list[str]]
    decimal_comma: bool

    def column(self, name: str) -> list[str]:
        """Return the cells of a column."""
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def channel(self, name: str, seconds: Array) -> Channel:
        """Return a column as a channel."""
        cells = self.column(name)
        values = [_number(cell, self.decimal_comma) for cell in cells]
        wrong = {row: cells[row] for row, value in enumerate(values) if not math.isfinite(value)}
        found = channel(name, self.units[self.names.index(name)], seconds, values, self.lines)
        return replace(found, wrong=wrong)


def _read(path: Path, time: Column | None) -> Log:
    """Return the log in a CSV file.

    Columns are separated by commas, or by semicolons or tabs, with which a comma in a number is a
    decimal one. The first line has the names, ``name``, ``name [unit]`` or ``name (unit)``; the
    second may have the units. The time is the column ``time`` unless another is named: a number,
    in s without a unit, or ISO 8601, a date or a time of day.

    Raises InputError, with line and column, for a file that is no such table, one without a column
    of the time, and a time that cannot be read.
    """
    table = _cells(path)
    column = time or Column("time")
    if column.name not in table.names:
        raise InputError(
            f"{path}, line 1: time: {unknown('column', column.name, table.names)}; "
            "--columns time=NAME names it"
        )
    rows = np.arange(len(table.rows), dtype=np.float64)
    craft = of_craft(table.names)
    served = {what: [what, *craft.get(what, ())] for what in QUANTITIES}
    log = Log(path, {name: table.channel(name, rows) for name in table.names}, served,
              row="line", table=True)  # fmt: skip
    first = _clock_time(table.column(column.name)[0]) if table.rows else None
    if not table.rows:
        seconds = rows
    elif first is None:
        seconds = series(log, "time", column).values
    else:
        seconds = _clock(table, column.name, first)
    timed = {name: replace(each, time=seconds) for name, each in log.channels.items()}
    return replace(log, channels=timed, start=first if isinstance(first, datetime) else None)


def _clock_time(cell: str) -> datetime | time | None:
    return None if math.isfinite(_number(cell, True)) else parsed_time(cell)


def _clock(table: _Table, name: str, first: datetime | time) -> Array:
    """Return the times of rows that have dates, or times of day, in s from the first."""
    moments = []
    for line, cell in zip(table.lines, table.column(name), strict=True):
        moment = _clock_time(cell)
        if type(moment) is not type(first):
            form = "date and time" if isinstance(first, datetime) else "time of day"
            raise InputError(
                f"{table.path}, line {line}, column {name!r}: a {form} by ISO 8601 is needed, as "
                f"in the first row, found {cell!r}"
            )
        moments.append(moment)
    if isinstance(first, datetime):
        return np.array([(each - first).total_seconds() for each in moments])  # type: ignore[operator]
    day = past_midnight([of_day(each) for each in moments])  # type: ignore[arg-type]
    return np.asarray(day - day[0])


# ---------------------------------------------------------------------- cells


def _cells(path: Path) -> _Table:
    lines: list[int] = []
    rows: list[list[str]] = []
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            head = file.readline()
            separator = next((each for each in _SEPARATORS if each in head), ",")
            file.seek(0)
            reader = csv.reader(file, strict=True, delimiter=separator)
            header = [name.strip() for name in next(reader, [])]
            for row in reader:
                if row and len(row) != len(header):
                    raise InputError(
                        f"{path}, line {reader.line_num}: {len(row)} values, the header has "
                        f"{len(header)}{_hint(row, len(header), separator)}"
                    )
                if row:
                    lines.append(reader.line_num)
                    rows.append([cell.strip() for cell in row])
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text at byte {error.start}") from None
    except csv.Error as error:
        raise InputError(f"{path}: not CSV: {error}") from None
    return _table(path, header, lines, rows, separator != ",")


def _table(
    path: Path, header: list[str], lines: list[int], rows: list[list[str]], decimal_comma: bool
) -> _Table:
    """Return the table, with the units that the header or the first row has."""
    with_units = [_WITH_UNIT.fullmatch(name) for name in header]
    names = [match[1] if match else name for name, match in zip(header, with_units, strict=True)]
    units = [match[2] if match else None for match in with_units]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path}, line 1: the column {twice!r} occurs twice")
    if rows and all(map(_is_unit, rows[0])):
        units = [cell or None for cell in rows.pop(0)]
        lines.pop(0)
    return _Table(path, names, units, lines, rows, decimal_comma)


def _hint(row: list[str], width: int, separator: str) -> str:
    """Return what explains a row that is twice too long."""
    if separator == "," and len(row) == 2 * width:
        return "; with decimal commas, ';' or a tab has to separate the columns"
    return ""


def _is_unit(cell: str) -> bool:
    return not math.isfinite(_number(cell, True)) and _clock_time(cell) is None


def _number(cell: str, decimal_comma: bool) -> float:
    """Return a finite number, NaN for any other text."""
    if decimal_comma and _DECIMAL_COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _recognises(path: Path, head: bytes) -> bool:
    """Return whether a file is text whose first line has a separator."""
    if path.is_dir() or b"\0" in head:
        return False
    first = head.splitlines()[0] if head.splitlines() else b""
    return any(separator.encode() in first for separator in _SEPARATORS)


CSV = Format("CSV", _recognises, _read, table=True)
