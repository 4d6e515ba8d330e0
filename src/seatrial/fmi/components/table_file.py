"""Files of values over time, CSV and Parquet, read into what `table.table_component` takes."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from ...errors import InputError, listed
from ...files.whole_file import stamp
from ...model.units import conversion, unit
from .table import RESERVED, TYPES

SUFFIXES = (".csv", ".parquet")
LARGEST = 32 * 2**20
"""Bytes of a file: an FMU of it carries all values as text."""
_TIMES = {"time": "s", "t": "s", "time_ns": "ns"}
"""Names of the column of times, however they are written, and its unit where it has none."""
_NS = 1_000_000_000
_LATEST_S = 9.0e9  # in ns, in 64 bits
_MARK = re.compile(
    r"(?P<name>.*?)(?:\s+\[(?P<spaced>[^\]]*)\]|(?<=\S)\[(?P<tight>[^\]\d][^\]]*)\])"
)
"""``depth [m]``; ``x[1]`` is an element of an array, ``x [1]`` has the unit 1."""
_SEPARATORS = ",;\t"
_WORDS = {"true": True, "false": False}
_WORD = re.compile(r"[^\W\d]")
_INTEGER = re.compile(r"[+-]?\d{1,10}")


Row = Callable[[int], str]
"""Returns what a row is called in messages."""


@dataclass(frozen=True)
class _Column:
    """A column as its heading has it."""

    name: str
    unit: str
    kind: str
    """A name of `TYPES`; empty: as its first cell."""
    held: bool
    place: str
    """For messages."""


Content = tuple[list[_Column], list[list[Any]], Row]
"""Columns, their cells, and what rows are called."""


def frozen_table(path: Path, types: Mapping[str, type] | None = None) -> str:
    """Return a file of values over time as the text of a table.

    A column is called by its heading; behind it, in brackets, stand its unit and words that say
    how it is read: ``gear [integer]``, ``rudder [rad held]``. ``types`` are those of columns for
    which somebody else says them. A CSV file has commas, semicolons or tabs, a heading and a column
    of times, ``time``, ``t`` or ``time_ns``; columns of true and false are switches, of words text,
    all others real. A Parquet file has its own types, and units in the fields' metadata.

    Raises InputError naming file, line and column for what is no such file, for times that go
    back, cells that are empty, no finite number, or not of their column's type.
    """
    return _frozen(path, stamp(path), tuple(sorted((types or {}).items(), key=str)))


@lru_cache(maxsize=32)
def _frozen(path: Path, stamped: tuple[int, int], types: tuple[tuple[str, type], ...]) -> str:
    if stamped[1] > LARGEST:
        raise InputError(f"{path}: {stamped[1]} bytes, at most {LARGEST} are read")
    columns, cells, row = (_csv if path.suffix == ".csv" else _parquet)(path)
    if not cells[0]:
        raise InputError(f"{path}: has no rows")
    columns = _typed(columns, {kind: name for name, kind in TYPES.items()}, dict(types))
    by_name = {column.name.lower(): i for i, column in reversed([*enumerate(columns)])}
    timed = next((by_name[name] for name in _TIMES if name in by_name), None)
    if timed is None:
        raise InputError(
            f"{path}: no column of times ({', '.join(_TIMES)}); the columns are "
            f"{listed([column.name for column in columns])}"
        )
    if len(columns) == 1:
        raise InputError(f"{path}: has no column but that of times")
    times = _times(path, columns[timed], cells[timed], row)
    made = [
        _values(path, column, values, row)
        for i, (column, values) in enumerate(zip(columns, cells, strict=True))
        if i != timed
    ]
    return json.dumps(
        {"file": path.name, "times_ns": times, "columns": made}, separators=(",", ":")
    )


def _typed(
    columns: Sequence[_Column], names: Mapping[type, str], types: Mapping[str, type]
) -> list[_Column]:
    """Return columns with the types that somebody else says. Raises InputError for bad names."""
    seen: set[str] = set()
    for column in columns:
        if not column.name or column.name in RESERVED:
            raise InputError(
                f"{column.place}: an output cannot be called {column.name!r}; rename the column"
            )
        if column.name in seen:
            raise InputError(f"{column.place}: the column {column.name!r} occurs twice")
        seen.add(column.name)
    return [
        replace(column, kind=names.get(types[column.name], column.kind))
        if column.name in types
        else column
        for column in columns
    ]


def _times(path: Path, column: _Column, values: Sequence[Any], row: Row) -> list[int]:
    """Return times in ns. Raises InputError for those that go back."""
    own = column.unit or _TIMES[column.name.lower()]
    try:
        factor, offset = conversion(own, "s")
    except InputError as error:
        raise InputError(f"{column.place}: {error}") from None
    found: list[int] = []
    for i, value in enumerate(values):
        place = f"{path}, {row(i)}, column {column.name!r}"
        t = factor * _real(value, place) + offset
        if abs(t) > _LATEST_S:
            raise InputError(f"{place}: {value!r} is beyond {_LATEST_S:g} s")
        found.append(value if own == "ns" and isinstance(value, int) else round(t * _NS))
        if found[-1] < max(found[-2:]):
            raise InputError(
                f"{place}: the time goes back from {found[-2] / _NS!r} s to {found[-1] / _NS!r} s"
            )
    return found


def _values(path: Path, column: _Column, values: Sequence[Any], row: Row) -> list[Any]:
    kind = column.kind or _kind(values)
    convert = {"real": _real, "integer": _integer, "boolean": _boolean, "text": _text}[kind]
    places = (f"{path}, {row(i)}, column {column.name!r}" for i in range(len(values)))
    found = [convert(value, place) for value, place in zip(values, places, strict=True)]
    linear = kind == "real" and not column.held
    return [column.name, kind, column.unit, "linear" if linear else "held", found]


def _kind(values: Sequence[Any]) -> str:
    """Return what a column is, where nothing says it."""
    if values[0].strip().lower() in _WORDS:
        return "boolean"
    words = all(_WORD.match(value) and not _is_number(value) for value in values)
    return "text" if words else "real"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _real(cell: Any, place: str) -> float:
    try:
        value = math.nan if "_" in str(cell) else float(cell)  # Python's own way of writing
    except (ValueError, TypeError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{place}: a finite number is needed, found {_shown(cell)}")
    return value


def _integer(cell: Any, place: str) -> int:
    text = str(cell).strip().removesuffix(".0")
    if isinstance(cell, bool) or not _INTEGER.fullmatch(text) or not -(2**31) <= int(text) < 2**31:
        raise InputError(f"{place}: an integer of 32 bits is needed, found {_shown(cell)}")
    return int(text)


def _boolean(cell: Any, place: str) -> bool:
    text = str(cell).strip().lower().removesuffix(".0")
    if text not in (*_WORDS, "0", "1"):
        raise InputError(f"{place}: true or false is needed, found {_shown(cell)}")
    return text in ("true", "1")


def _text(cell: Any, place: str) -> str:
    if not isinstance(cell, str) or not cell or "\0" in cell:
        raise InputError(f"{place}: a text is needed, found {_shown(cell)}")
    return cell


def _shown(cell: Any) -> str:
    return "an empty cell" if cell is None or cell == "" else repr(cell)[:80]


def _headed(heading: str, place: str) -> _Column:
    """Return the column of a heading, with what stands in brackets behind its name."""
    marked = _MARK.fullmatch(heading.strip())
    if marked is None:
        return _Column(heading.strip(), "", "", False, place)
    name = marked["name"].strip()
    column = _Column(name, "", "", False, f"{place}, column {name!r}")
    words = re.split(r"[,\s]+", (marked["spaced"] or marked["tight"] or "").strip())
    kinds = [word for word in words if word in TYPES]
    written = " ".join(word for word in words if word not in (*TYPES, "held", "-"))
    return replace(
        column,
        kind=kinds[-1] if kinds else "",
        held="held" in words,
        unit=_unit(written, column.place) if written else "",
    )


def _unit(written: str, place: str) -> str:
    try:
        unit(written)
    except InputError as error:
        words = listed([*TYPES, "held"])
        raise InputError(f"{place}: {error}; beside units, {words} can stand in brackets") from None
    return written


def _csv(path: Path) -> Content:
    try:
        text = path.read_text("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text at byte {error.start}") from None
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    lines = text.splitlines()
    first = next((i for i, line in enumerate(lines) if line.strip()), len(lines))
    if first < len(lines) and lines[first].strip('"').lower().startswith("sep="):
        first += 1  # a hint for spreadsheets, which OMSimulator writes
    if first >= len(lines):
        raise InputError(f"{path}: has no heading")
    separator = max(_SEPARATORS, key=lines[first].count)
    reader = csv.reader(lines[first:], delimiter=separator, strict=True, skipinitialspace=True)
    where, rows, numbers = f"{path}, line {first + 1}", list[list[str]](), list[int]()
    try:
        heading = next(reader)
        for row in reader:
            line = first + reader.line_num
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(heading):
                raise InputError(
                    f"{path}, line {line}: {len(row)} values, the heading has {len(heading)}"
                )
            rows.append([cell.strip() for cell in row])
            numbers.append(line)
    except csv.Error as error:
        raise InputError(f"{path}, line {first + reader.line_num}: not CSV: {error}") from None
    columns = [_headed(name, where) for name in heading]
    cells = [list(column) for column in zip(*rows, strict=True)] or [[] for _ in columns]
    return columns, cells, lambda i: f"line {numbers[i]}"


def _parquet(path: Path) -> Content:
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise InputError(
            f"{path}: Parquet needs pyarrow, which is not installed: "
            'pip install "seatrial[parquet]"'
        ) from None
    try:
        table = parquet.ParquetFile(path).read()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except pa.ArrowException as error:
        raise InputError(f"{path}: not Parquet: {error}") from None
    columns, cells = [], []
    for field, column in zip(table.schema, table.columns, strict=True):
        headed = _headed(field.name, str(path))
        said = (field.metadata or {}).get(b"unit", b"").decode("utf-8", "replace")
        if said and not headed.unit and said != "1":
            headed = replace(headed, unit=_unit(said, headed.place))
        columns.append(replace(headed, kind=headed.kind or _arrow_kind(pa.types, field, path)))
        cells.append(column.to_pylist())
    if not columns:
        raise InputError(f"{path}: has no columns")
    return columns, cells, lambda i: f"row {i + 1}"


def _arrow_kind(types: Any, field: Any, path: Path) -> str:
    """Return the type of a column in Parquet. Raises InputError for one of times and so on."""
    known = {
        "boolean": types.is_boolean,
        "integer": types.is_integer,
        "real": types.is_floating,
        "text": types.is_string,
    }
    for kind, fits in known.items():
        if fits(field.type):
            return kind
    raise InputError(
        f"{path}, column {field.name!r}: numbers, switches or texts are needed, found {field.type}"
    )
