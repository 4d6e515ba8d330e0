"""The record of a run: ``signals.csv``, one row per recorded time."""

from __future__ import annotations

import csv
import io
from array import array
from collections.abc import Sequence
from contextlib import suppress
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, unmatched
from ..model.component import NS
from ..system.references.values import storable
from ..system.system import System
from .compiled.decimals import rows_as_text
from .compiled.rows import Rows
from .master import Master


def output_names(system: System) -> list[str]:
    """Return the names of all outputs, ``component.port``, in the order of their declaration."""
    return [
        f"{name}.{variable.name}"
        for name, part in system.parts.items()
        for variable in part.instance.variables.values()
        if variable.causality == "output"
    ]


def matching(names: Sequence[str], patterns: Sequence[str]) -> list[str]:
    """Return the names that one of ``patterns`` (such as ``hull.*``) matches, in order.

    Raises InputError for a pattern that matches nothing.
    """
    for pattern in patterns:
        if pattern != "*" and not any(fnmatchcase(name, pattern) for name in names):
            raise InputError(unmatched("signal", pattern, names))
    return [name for name in names if any(fnmatchcase(name, p) for p in patterns)]


class Watched:
    """Keeps signals of a master in memory, at every communication step; it writes nothing."""

    at_once = False
    """Whether a point that Python has stepped to is recorded before the next step."""

    def __init__(self, master: Master, names: Sequence[str]) -> None:
        self._master = master
        all_places = {".".join(name): i for i, name in enumerate(master.names)}
        self.places = [all_places[name] for name in names]
        self._steps, self._signals = array("q"), master.signals
        self._columns: dict[str, array[float] | list[str]] = {
            name: list[str]() if isinstance(master.signals[place], str) else array("d")
            for name, place in zip(names, self.places, strict=True)
        }
        columns = self._columns.values()
        self._keeping = [(c.append, i) for c, i in zip(columns, self.places, strict=True)]
        self.rows = None if _has_text(master, self.places) else Rows(self.places, 1)
        """For `Master.advance`, which leaves there what `take` keeps; None where texts are."""

    def __len__(self) -> int:
        return len(self.places)

    def record(self, *, last: bool = False) -> None:
        """Keep the values of now, whether or not they are the ``last``."""
        if self._columns:
            signals = self._signals
            self._steps.append(self._master.steps)
            for keep, place in self._keeping:
                keep(signals[place])

    def keep(self, steps: NDArray[np.int64], table: NDArray[np.float64]) -> None:
        """Keep numbers after several numbers of steps: a row of ``table`` after each."""
        if self._columns:
            self._steps.frombytes(steps.tobytes())
            for column, values in zip(self._columns.values(), table.T, strict=True):
                assert not isinstance(column, list)
                column.frombytes(values.tobytes())

    def take(self) -> None:
        """Keep the points that the last block of steps left in ``rows``."""
        assert self.rows is not None
        self.keep(*_taken(self.rows))

    def watched(self) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64] | list[str]]]:
        """Return time and the signals, texts as lists, at every communication step so far."""
        columns: dict[str, NDArray[np.float64] | list[str]] = {
            name: column if isinstance(column, list) else np.array(column)
            for name, column in self._columns.items()
        }
        return _times(self._master, np.array(self._steps)), columns


def _has_text(master: Master, places: Sequence[int]) -> bool:
    return any(isinstance(master.signals[place], (str, bytes)) for place in places)


def _taken(rows: Rows) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the points that a block of steps left: numbers of steps, and values after each."""
    first, table = rows.taken()
    return first + rows.every * np.arange(len(table), dtype=np.int64), table


def _times(master: Master, steps: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the times after numbers of steps, s, as `Master.time` has them."""
    times: NDArray[np.float64] = (master.start_ns + steps * master.step_ns) / NS
    return times


class Recorder:
    """Writes the signals ``names`` of a master to a CSV file, and keeps those to ``watch``.

    Numbers are written so that they read back exactly; Booleans as 0 and 1; text quoted where
    it must be; bytes as base64 text. Each row is handed to the system at once: the file is whole
    up to the last one if the process is killed, and a row of which a full disk takes a part is
    taken back. What cannot be written raises OSError with the file's name.
    """

    at_once = True

    def __init__(
        self,
        path: Path,
        master: Master,
        names: Sequence[str],
        every: int,
        watch: Sequence[str] = (),
    ) -> None:
        self.every = every
        self._master = master
        self.names = list(names)
        places = {".".join(name): i for i, name in enumerate(master.names)}
        self._places = [places[name] for name in self.names]
        self._booleans = [
            column for column, i in enumerate(self._places) if isinstance(master.signals[i], bool)
        ]
        self._binaries = [
            column for column, i in enumerate(self._places) if isinstance(master.signals[i], bytes)
        ]
        self._path = path
        self._file = path.open("wb", buffering=0)
        self._whole = 0
        """Bytes of the rows that were written whole."""
        self._row = io.StringIO(newline="")
        csv.writer(self._row, lineterminator="\n").writerow(["time", *self.names])
        self._write_row()
        # Text is always quoted: a lone carriage return in it would end the row otherwise.
        self._writer = csv.writer(self._row, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
        self._watched = Watched(master, watch)
        self.rows = self._block()
        """For `Master.advance`, which leaves there what `take` records; None where texts are."""

    def record(self, *, last: bool = False) -> None:
        """Write a row if one is due at the master's time, or if it is the ``last``."""
        master = self._master
        signals = master.signals
        self._watched.record()
        if master.steps % self.every and not last:
            return
        row: list[Any] = [signals[i] for i in self._places]
        for column in self._booleans:
            row[column] = int(row[column])
        for column in self._binaries:
            row[column] = storable(row[column])
        self._writer.writerow([master.time, *row])
        self._write_row()

    def take(self) -> None:
        """Record the points that the last block of steps left in ``rows``."""
        assert self.rows is not None
        count = len(self._watched)
        steps, table = _taken(self.rows)
        self._watched.keep(steps, table[:, :count])
        due = steps % self.every == 0
        times = _times(self._master, steps[due])
        whole = [column + 1 for column in self._whole_numbers]
        self._write(*rows_as_text(np.column_stack([times, table[due, count:]]), whole))

    def watched(self) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64] | list[str]]]:
        """Return time and watched signals, texts as lists, at every communication step so far."""
        return self._watched.watched()

    def close(self) -> None:
        """Close the file."""
        try:
            self._file.close()
        except OSError as error:
            raise self._named(error) from None

    def _block(self) -> Rows | None:
        signals, places = self._master.signals, [*self._watched.places, *self._places]
        if _has_text(self._master, places):
            return None
        self._whole_numbers = [
            column for column, i in enumerate(self._places) if isinstance(signals[i], int)
        ]
        return Rows(places, 1 if self._watched else self.every)

    def _write_row(self) -> None:
        """Write the row that the writer has made."""
        row = self._row.getvalue().encode()
        self._row.seek(0)
        self._row.truncate()
        self._write(row, [len(row)])

    def _write(self, rows: bytes, ends: Sequence[int] | NDArray[np.int64]) -> None:
        """Write rows, of which it is known where each ends, each whole or not at all."""
        written = 0
        try:
            while written < len(rows):
                written += self._file.write(rows[written:])
        except OSError as error:
            self._whole += max((int(end) for end in ends if end <= written), default=0)
            with suppress(OSError):
                self._file.truncate(self._whole)
            raise self._named(error) from None
        self._whole += written

    def _named(self, error: OSError) -> OSError:
        return OSError(error.errno, error.strerror, str(self._path))
