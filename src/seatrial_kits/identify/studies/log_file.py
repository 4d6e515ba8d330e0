"""Reading logs: the quantities that an experiment names, at equal times and in SI."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError
from seatrial.system.files import FileModel
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.logs.formats import read_log as read_any
from seatrial.trial.logs.quantities import QUANTITIES, Column, chosen
from seatrial_kits.logs.paired.common_time import together, unwrapped

from ..gravity import acceleration_along
from ..output_error import AxisLog
from .experiment import ColumnEntry, Experiment

_MEASURED = ("acceleration", "acceleration_x", "depth", "heading")
"""Readings whose instants the others are brought to, the first that there is."""
_LEAST_ROWS = 50
_UNEVEN = 0.01
"""Share of the sample period by which the time between two rows may differ from it."""


@dataclass(frozen=True)
class Columns:
    """The columns of a log that an experiment names, in SI, by quantity."""

    path: Path
    time: FloatArray
    values: Mapping[str, FloatArray]
    named: Mapping[str, ColumnEntry]
    place: Callable[[int], str]
    """Place of each row in the file."""

    def command(self, name: str) -> FloatArray:
        """Return the commands (n,); raises InputError beyond -1 to 1, or if they never change."""
        command, column = self.values[name], self.named[name].name
        beyond = np.flatnonzero(np.abs(command) > 1.0 + 1e-9)
        if len(beyond):
            where, found = self._cell(int(beyond[0]), column), command[beyond[0]]
            raise InputError(f"{where}: a command from -1 to 1 is needed, found {found:g}")
        if np.ptp(command) == 0.0:
            raise InputError(f"{self.path}: the command {column!r} never changes")
        return command

    def heading(self) -> FloatArray:
        """Return the heading (n,) unwrapped; raises InputError where turns cannot be counted."""
        column = self.named["heading"].name
        return unwrapped(self.time, self.values["heading"], lambda row: self._cell(row, column))

    def period(self) -> float:
        """Return the sample period, s; raises InputError where rows are not equally spaced."""
        time = self.time
        if len(time) < _LEAST_ROWS:
            raise InputError(f"{self.path}: {len(time)} rows, at least {_LEAST_ROWS} are needed")
        steps = np.diff(time)
        usual = float(np.median(steps))
        wrong = np.flatnonzero(np.abs(steps - usual) > _UNEVEN * usual)
        if len(wrong):
            row = int(wrong[0])
            missing = round(steps[row] / usual) - 1
            gap = f": {missing} row{'s' if missing > 1 else ''} missing" if missing > 0 else ""
            raise InputError(
                f"{self.place(row + 1)}: the time goes from {time[row]:g} s to "
                f"{time[row + 1]:g} s, rows {usual:g} s apart are needed{gap}"
            )
        return float((time[-1] - time[0]) / (len(time) - 1))

    def _cell(self, row: int, column: str) -> str:
        return f"{self.place(row)}, column {column!r}"


def read_log(experiment: Experiment, path: Path, format_name: str | None = None) -> AxisLog:
    """Return the log of the experiment's axis in a log of any format.

    Raises InputError naming file, line and column: for a column that is missing, a unit that
    does not measure what it should, text in a cell, times that are not equally
    spaced in a table, fewer than 50 rows, a command beyond -1 to 1 or one that never changes, and
    a heading that turns by more than 90 degrees between two rows, whose turns cannot be counted.
    """
    columns = read_columns(path, experiment.file.columns, format_name)
    period, command = columns.period(), columns.command("command")
    if "acceleration" in columns.values:
        measured = _without_gravity(experiment, columns)
    elif "depth" in columns.values:
        measured = columns.values["depth"]
    else:
        measured = columns.heading()
    reading = "acceleration" if "acceleration" in columns.values else "place"
    return AxisLog(command, measured, period, reading, experiment.rotation)  # type: ignore[arg-type]


def _without_gravity(experiment: Experiment, columns: Columns) -> FloatArray:
    entry, axis = experiment.file.columns.acceleration, experiment.file.axis
    assert entry is not None
    assert axis != "yaw"
    reading = columns.values["acceleration"]
    level = np.zeros_like(reading)
    roll, pitch = (columns.values.get(name, level) for name in ("roll", "pitch"))
    return acceleration_along(axis, reading, roll, pitch, reads=entry.reads)


def read_columns(path: Path, columns: FileModel, format_name: str | None = None) -> Columns:
    """Return the columns that an experiment's table names, in SI.

    Those of a log whose channels have different times are brought to even times, of the usual
    period of what was measured. Raises InputError as `read_any`, `chosen` and `together` do.
    """
    named = {what: entry for what in QUANTITIES if (entry := getattr(columns, what, None))}
    wanted = {what: Column(entry.name, entry.unit) for what, entry in named.items()}
    log = read_any(path, format_name, wanted.pop("time", None))
    found = chosen(log, wanted, wanted, units_needed=True)
    axis = next(what for what in _MEASURED if what in wanted)
    rows = together(found, axis, wanted, even=True)
    return Columns(log.path, rows.time, rows.values, named, rows.place)
