"""``results.parquet`` and ``timing.parquet``: a row per case, in case order, as they come."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from seatrial.errors import InputError

from .cases import Case
from .columns import Column
from .ended import Ended
from .table_arrays import array_of

RESULTS = "results.parquet"
TIMING = "timing.parquet"
ROWS = 1000
"""Rows of a group: the file does not depend on how many came at a time."""
_TIMES = [
    Column("case", "integer", lambda _, ended: ended.number + 1),
    Column("host", "text", lambda _, ended: ended.host),
    Column("begun", "number", lambda _, ended: ended.begun, "s"),
    Column("wall", "number", lambda _, ended: ended.measured.wall, "s"),
]


def arrow() -> tuple[Any, Any]:
    """Return pyarrow and its Parquet module. Raises InputError if it is not installed."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            "a campaign's table needs pyarrow: python -m pip install 'seatrial[parquet]'"
        ) from None
    return pyarrow, pyarrow.parquet


class Tables:
    """Writes both tables of a folder; they are there, whole, once it is closed.

    Use it as a context manager.
    """

    def __init__(self, folder: Path, columns: Sequence[Column]) -> None:
        self._writers = [_Writer(folder / RESULTS, columns), _Writer(folder / TIMING, _TIMES)]

    def __enter__(self) -> Tables:
        return self

    def __exit__(self, *_: object) -> None:
        for writer in self._writers:
            writer.close()

    def add(self, case: Case, ended: Ended) -> None:
        """Add the row of the next case."""
        for writer in self._writers:
            writer.add(case, ended)


class _Writer:
    def __init__(self, path: Path, columns: Sequence[Column]) -> None:
        self._arrow, parquet = arrow()
        self._path, self._columns = path, columns
        self._partial = path.with_suffix(".partial")
        types = {
            "integer": self._arrow.int64(),
            "number": self._arrow.float64(),
            "truth": self._arrow.bool_(),
            "text": self._arrow.string(),
        }
        self._schema = self._arrow.schema(
            [
                self._arrow.field(
                    column.name,
                    types[column.kind],
                    metadata={"unit": column.unit} if column.unit else None,
                )
                for column in columns
            ]
        )
        self._writer = parquet.ParquetWriter(self._partial, self._schema, compression="zstd")
        self._rows: list[list[Any]] = []

    def add(self, case: Case, ended: Ended) -> None:
        self._rows.append([column.value(case, ended) for column in self._columns])
        if len(self._rows) == ROWS:
            self._flush()

    def close(self) -> None:
        if self._rows:
            self._flush()
        self._writer.close()
        with self._partial.open("rb+") as file:  # the log of what it holds goes after it
            os.fsync(file.fileno())
        self._partial.replace(self._path)

    def _flush(self) -> None:
        columns = zip(*self._rows, strict=True)
        arrays = [
            array_of(self._arrow, values, field.type)
            for values, field in zip(columns, self._schema, strict=True)
        ]
        self._writer.write_table(self._arrow.table(arrays, schema=self._schema), ROWS)
        self._rows = []


def read_rows(path: Path, names: Sequence[str] | None = None) -> Iterator[dict[str, Any]]:
    """Yield the rows of a table, of some columns or all, a group at a time.

    Raises InputError for a file that is no such table.
    """
    pyarrow, parquet = arrow()
    try:
        file = parquet.ParquetFile(path)
        if lacking := {*(names or ())} - {*file.schema_arrow.names}:
            raise InputError(f"{path}: this is no table of a campaign: it has no {min(lacking)}")
        for batch in file.iter_batches(columns=None if names is None else list(names)):
            yield from batch.to_pylist()
    except (OSError, pyarrow.ArrowException) as error:
        raise InputError(f"{path}: this is no table of a campaign: {error}") from None


def units_of(path: Path) -> dict[str, str]:
    """Return the columns of a table by name, each with its unit; empty without one."""
    _, parquet = arrow()
    schema = parquet.read_schema(path)
    return {f.name: (f.metadata or {}).get(b"unit", b"").decode() for f in schema}
