"""Rows of a run that a live page has seen, thinned out as they become many."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import Run

_MOST_ROWS = 4000


class History:
    """Rows of a run under way; of more than `_MOST_ROWS` every second one is dropped."""

    def __init__(self, manifest: Mapping[str, Any], folder: Path, names: Sequence[str]) -> None:
        self._manifest, self._folder = dict(manifest), folder
        self._names = {name: place for place, name in enumerate(names)}
        self._units = {name: manifest["signals"][name]["unit"] for name in names}
        self._rows: list[FloatArray] = []
        self._times: list[float] = []
        self._every = 0.0

    def add(self, time: float, row: FloatArray) -> Run:
        """Keep a row, and return a run of it alone."""
        if not self._times or time - self._times[-1] >= self._every:
            self._times.append(time)
            self._rows.append(row)
        if len(self._rows) > _MOST_ROWS:
            self._times, self._rows = self._times[::2], self._rows[::2]
            self._every = 1.5 * (self._times[1] - self._times[0])
        signals = {name: row[place : place + 1] for name, place in self._names.items()}
        return self._run(np.array([time]), signals)

    def fill(self, record: Run) -> None:
        """Take the rows of a record that are later than those here; what it lacks is NaN."""
        since = self._times[-1] if self._times else -np.inf
        later = np.flatnonzero(record.time > since)
        chosen = later[:: max(1, len(later) // (_MOST_ROWS // 2))]
        rows = np.full((len(chosen), len(self._names)), np.nan)
        for name, place in self._names.items():
            column = record.signals.get(name)
            if isinstance(column, np.ndarray):
                rows[:, place] = column[chosen]
        self._times += record.time[chosen].tolist()
        self._rows += list(rows)

    def columns(self, names: Iterable[str]) -> tuple[FloatArray, dict[str, Any]]:
        """Return the times, and those of the signals that there are."""
        wanted = [name for name in names if name in self._names]
        places = [self._names[name] for name in wanted]
        table = np.array([row[places] for row in self._rows]).reshape(len(self._rows), len(places))
        return np.array(self._times), dict(zip(wanted, table.T, strict=True))

    def _run(self, time: FloatArray, signals: dict[str, Any]) -> Run:
        units = self._units
        return Run(self._folder, time, signals, units, self._manifest, [], {}, False, ())
