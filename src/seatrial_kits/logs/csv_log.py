"""CSV files as logs: a line of names, perhaps one of units, then numbers."""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, time
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.trial.logs.channels import Array, Channel, Log, channel, empty_cells
from seatrial.trial.logs.clock_times import of_day, parsed_time, past_midnight
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import QUANTITIES, Column, times_of
from seatrial.trial.logs.reading_progress import open_text
from seatrial.trial.records.run_folder import ends_with_newline

from .run_log import of_craft

_SEPARATORS = (";", "\t", ",")
_WITH_UNIT = re.compile(r"(.+?)\s*[\[(]([^\[\]()]+)[\])]")
_EMPTY = ("", "nan")
"""Cells without a value."""
_CHUNK = 50_000
"""Rows that are held as text at once."""
_MOST_WRONG = 1000
"""Texts in the place of numbers that are kept, of a column."""
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass
class _Table:
    """The columns of a file: names, units, values, and the line of each row.

    They grow in place: what many arrays leave behind, as they become one, is as large again.
    """

    path: Path
    names: list[str]
    units: list[str | None]
    decimal_comma: bool
    time_place: int
    """Place of the column of the time."""
    lines: array[int] = field(default_factory=lambda: array("q"))
    values: list[array[float]] = field(default_factory=list)
    wrong: list[dict[int, str]] = field(default_factory=list)
    """Of each column, the first texts in the place of numbers, by row."""
    first: datetime | time | None = None
    """The time of the first row, if it is no number."""
    notes: tuple[str, ...] = ()

    def take(self, lines: list[int], rows: list[list[str]]) -> None:
        """Add rows, which stand in ``lines``."""
        done = len(self.lines)
        if not self.values:
            self.values = [array("d") for _ in self.names]
            self.wrong = [{} for _ in self.names]
            self.first = _clock_time(rows[0][self.time_place])
        self.lines.extend(lines)
        for place, cells in enumerate(zip(*rows, strict=True)):
            if place == self.time_place and self.first is not None:
                moments = (_seconds(self, *each) for each in zip(lines, cells, strict=True))
                self.values[place].extend(moments)
                continue
            numbers = _numbers(cells, self.decimal_comma)
            self.values[place].frombytes(numbers.tobytes())
            wrong = self.wrong[place]
            for row in np.flatnonzero(~np.isfinite(numbers)) if len(wrong) < _MOST_WRONG else ():
                if cells[row].lower() not in _EMPTY:
                    wrong[done + int(row)] = cells[row]

    def channels(self) -> dict[str, Channel]:
        """Return the columns as channels, whose times are to be set."""
        if not self.values:
            return {
                name: Channel(name, unit, np.empty(0), np.empty(0), np.empty(0, np.int64))
                for name, unit in zip(self.names, self.units, strict=True)
            }
        lines = np.asarray(self.lines)
        untimed = np.zeros(len(lines))
        found = {}
        for place, (name, unit) in enumerate(zip(self.names, self.units, strict=True)):
            made = channel(name, unit, untimed, self.values[place], lines)
            found[name] = replace(made, wrong=self.wrong[place])
        return found


def _read(path: Path, time: Column | None) -> Log:
    """Return the log in a CSV file.

    Columns are separated by commas, or by semicolons or tabs, with which a comma in a number is a
    decimal one. The first line has the names, ``name``, ``name [unit]`` or ``name (unit)``; the
    second may have the units. The time is the column ``time`` unless another is named: a number,
    in s without a unit, or ISO 8601, a date or a time of day. Other cells may be empty, or ``nan``.
    A last line that is cut is left out. Text that is not UTF-8 is that of Windows, code page 1252.

    Raises InputError, with line and column, for a file that is no such table, one without a column
    of the time, and a time that cannot be read.
    """
    column = time or Column("time")
    table = _table(path, column.name)
    channels = table.channels()
    craft = of_craft(channels)
    served = {what: [what, *craft.get(what, ())] for what in QUANTITIES}
    notes = (*table.notes, *empty_cells(channels))
    log = Log(path, channels, served, notes=notes, row="line", table=True)
    moments = channels[column.name].values
    if not len(moments):
        seconds = moments
    elif table.first is None:
        seconds = times_of(log, column)
    elif isinstance(table.first, datetime):
        seconds = moments
    else:
        day = past_midnight(moments)
        seconds = np.asarray(day - day[0])
    timed = {name: replace(each, time=seconds) for name, each in channels.items()}
    start = table.first if isinstance(table.first, datetime) else None
    return replace(log, channels=timed, start=start)


def _clock_time(cell: str) -> datetime | time | None:
    return None if math.isfinite(_number(cell, True)) else parsed_time(cell)


def _seconds(table: _Table, line: int, cell: str) -> float:
    """Return a date and time, s from the first, or a time of day, s since midnight."""
    moment, first = _clock_time(cell), table.first
    if type(moment) is not type(first):
        form = "date and time" if isinstance(first, datetime) else "time of day"
        raise InputError(
            f"{table.path}, line {line}, column {table.names[table.time_place]!r}: a {form} by "
            f"ISO 8601 is needed, as in the first row, found {cell!r}"
        )
    if isinstance(first, datetime):
        return (moment - first).total_seconds()  # type: ignore[operator]
    return of_day(moment)  # type: ignore[arg-type]


# ---------------------------------------------------------------------- cells


def _table(path: Path, time: str) -> _Table:
    """Return the table in a file, read by `_CHUNK` rows. Raises InputError."""
    try:
        with open_text(path, _encoding(path), newline="") as file:
            head = file.readline()
            separator = next((each for each in _SEPARATORS if each in head), ",")
            file.seek(0)
            reader = csv.reader(file, strict=True, delimiter=separator)
            table = _headed(path, [name.strip() for name in next(reader, [])], separator, time)
            rows = _whole_rows(table, reader, separator)
            line, first = next(rows, (0, []))
            if first and all(map(_is_unit, first)):
                table.units = [cell or None for cell in first]
            elif first:
                rows = chain([(line, first)], rows)
            while chunk := list(islice(rows, _CHUNK)):
                table.take([line for line, _ in chunk], [row for _, row in chunk])
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text at byte {error.start}") from None
    except csv.Error as error:
        raise InputError(f"{path}: not CSV: {error}") from None
    return table


def _encoding(path: Path) -> str:
    """Return the encoding of a text, by its first line."""
    with path.open("rb") as file:
        first = file.readline()
    try:
        first.decode("utf-8")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _headed(path: Path, header: list[str], separator: str, time: str) -> _Table:
    """Return an empty table with the names and units of a header."""
    with_units = [_WITH_UNIT.fullmatch(name) for name in header]
    names = [match[1] if match else name for name, match in zip(header, with_units, strict=True)]
    units = [match[2] if match else None for match in with_units]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{path}, line 1: the column {twice!r} occurs twice")
    if time not in names:
        raise InputError(
            f"{path}, line 1: time: {unknown('column', time, names)}; --columns time=NAME names it"
        )
    return _Table(path, names, units, separator != ",", names.index(time))


def _whole_rows(table: _Table, reader: Any, separator: str) -> Iterator[tuple[int, list[str]]]:
    """Yield line and cells of rows; a last one that is cut is left out, with a note."""
    width, cut = len(table.names), None
    for row in reader:
        if cut is not None:
            raise cut
        if row and len(row) != width:
            cut = InputError(
                f"{table.path}, line {reader.line_num}: {len(row)} values, the header has "
                f"{width}{_hint(row, width, separator)}"
            )
        elif row:
            yield reader.line_num, [cell.strip() for cell in row]
    if cut is not None:
        if ends_with_newline(table.path):
            raise cut
        table.notes = (f"line {reader.line_num} is cut, and left out",)


def _hint(row: list[str], width: int, separator: str) -> str:
    """Return what explains a row that is twice too long."""
    if separator == "," and len(row) == 2 * width:
        return "; with decimal commas, ';' or a tab has to separate the columns"
    return ""


def _is_unit(cell: str) -> bool:
    return not math.isfinite(_number(cell, True)) and _clock_time(cell) is None


def _numbers(cells: Sequence[str], decimal_comma: bool) -> Array:
    """Return the numbers of cells, NaN for any other text."""
    try:
        return np.array(cells, np.float64)
    except ValueError:
        return np.array([_number(cell, decimal_comma) for cell in cells])


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
