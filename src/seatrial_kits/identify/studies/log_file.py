"""Reading logs: columns of a CSV file, or of a run folder, at equal times and in SI."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import conversion
from seatrial.system.files import FileModel
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import MANIFEST, SIGNALS, read_manifest

from ..gravity import acceleration_along
from ..output_error import AxisLog
from .experiment import ColumnEntry, Experiment

_UNITS = {
    "time": "s",
    "command": "1",
    "port": "1",
    "starboard": "1",
    "acceleration": "m/s2",
    "acceleration_x": "m/s2",
    "acceleration_y": "m/s2",
    "roll": "rad",
    "pitch": "rad",
    "depth": "m",
    "heading": "rad",
}
_LEAST_ROWS = 50
_UNEVEN = 0.01
"""Share of the sample period by which the time between two rows may differ from it."""


@dataclass(frozen=True)
class Columns:
    """The columns of a log that an experiment names, in SI, by what they hold."""

    path: Path
    lines: list[int]
    """Line of each row in the file."""
    values: dict[str, FloatArray]
    named: Mapping[str, ColumnEntry]

    def command(self, name: str) -> FloatArray:
        """Return the commands (n,); raises InputError beyond -1 to 1, or if they never change."""
        command, column = self.values[name], self.named[name].name
        beyond = np.flatnonzero(np.abs(command) > 1.0 + 1e-9)
        if len(beyond):
            where, found = self._place(int(beyond[0]), column), command[beyond[0]]
            raise InputError(f"{where}: a command from -1 to 1 is needed, found {found:g}")
        if np.ptp(command) == 0.0:
            raise InputError(f"{self.path}: the command {column!r} never changes")
        return command

    def heading(self) -> FloatArray:
        """Return the heading (n,) unwrapped; raises InputError where turns cannot be counted."""
        angle: FloatArray = np.unwrap(self.values["heading"])
        fast = np.flatnonzero(np.abs(np.diff(angle)) > math.pi / 2)
        if len(fast):
            row = int(fast[0])
            turned = math.degrees(angle[row + 1] - angle[row])
            raise InputError(
                f"{self._place(row + 1, self.named['heading'].name)}: the heading turns by "
                f"{turned:.4g} deg from one row to the next; up to 90 deg can be distinguished "
                "from a turn the other way"
            )
        return angle

    def period(self) -> float:
        """Return the sample period, s; raises InputError where rows are not equally spaced."""
        time = self.values["time"]
        if len(time) < _LEAST_ROWS:
            raise InputError(f"{self.path}: {len(time)} rows, at least {_LEAST_ROWS} are needed")
        steps = np.diff(time)
        usual = float(np.median(steps))
        wrong = np.flatnonzero(~(np.abs(steps - usual) <= _UNEVEN * abs(usual)) | (steps <= 0.0))
        if len(wrong):
            row = int(wrong[0])
            missing = round(steps[row] / usual) - 1 if usual > 0.0 else 0
            gap = f": {missing} row{'s' if missing > 1 else ''} missing" if missing > 0 else ""
            raise InputError(
                f"{self.path}, line {self.lines[row + 1]}: the time goes from {time[row]:g} s to "
                f"{time[row + 1]:g} s, rows {usual:g} s apart are needed{gap}"
            )
        return float((time[-1] - time[0]) / (len(time) - 1))

    def _place(self, row: int, column: str) -> str:
        return f"{self.path}, line {self.lines[row]}, column {column!r}"


def read_log(experiment: Experiment, path: Path) -> AxisLog:
    """Return the log of the experiment's axis in a CSV file or a run folder.

    Raises InputError naming file, line and column: for a column that is missing, a unit that
    does not measure what it should, a cell that is no finite number, times that are not equally
    spaced, fewer than 50 rows, a command beyond -1 to 1 or one that never changes, and a heading
    that turns by more than 90 degrees between two rows, whose turns cannot be counted.
    """
    columns = read_columns(path, experiment.file.columns)
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


# ---------------------------------------------------------------------- cells


def read_columns(path: Path, columns: FileModel) -> Columns:
    """Return the columns that an experiment's table names, in SI; raises InputError."""
    named = {name: entry for name in _UNITS if (entry := getattr(columns, name, None))}
    folder_units: dict[str, str] = {}
    if path.is_dir():
        signals = read_manifest(path)["signals"]
        folder_units = {"time": "s", **{name: signal["unit"] for name, signal in signals.items()}}
        path = path / SIGNALS
    if not path.is_file():
        raise InputError(f"there is no log {path}")
    factors = {what: _conversion(path, what, entry, folder_units) for what, entry in named.items()}
    try:
        lines, cells = _cells(path, named)
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text at byte {error.start}") from None
    except csv.Error as error:
        raise InputError(f"{path}: not CSV: {error}") from None
    values = {what: np.array(column) * factors[what] for what, column in cells.items()}
    return Columns(path, lines, values, named)


def _conversion(
    path: Path, what: str, entry: ColumnEntry, folder_units: Mapping[str, str]
) -> float:
    unit = entry.unit or folder_units.get(entry.name)
    where = f"{path}: column {entry.name!r}"
    if unit is None:
        if folder_units:  # the column itself is missing: the reader of the header reports it
            return 1.0
        raise InputError(f"{where}: a unit is needed: only a folder with a {MANIFEST} has units")
    if entry.unit and entry.name in folder_units and entry.unit != folder_units[entry.name]:
        raise InputError(f"{where}: the run has it in {folder_units[entry.name]}, not {unit}")
    try:
        factor, offset = conversion(unit, _UNITS[what])
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if offset:
        raise InputError(f"{where}: unit {unit!r} has an offset")
    return factor


def _cells(
    path: Path, named: Mapping[str, ColumnEntry]
) -> tuple[list[int], dict[str, list[float]]]:
    """Return the line of each row, and the named columns as numbers in their own unit."""
    lines: list[int] = []
    cells: dict[str, list[float]] = {what: [] for what in named}
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.reader(file, strict=True)
        header = [name.strip() for name in next(reader, [])]
        for what, entry in named.items():
            if header.count(entry.name) > 1:
                raise InputError(f"{path}, line 1: the column {entry.name!r} occurs twice")
            if entry.name not in header:
                raise InputError(f"{path}, line 1: {what}: {unknown('column', entry.name, header)}")
        places = {what: header.index(entry.name) for what, entry in named.items()}
        for row in reader:
            if not row:
                continue
            if len(row) != len(header):
                raise InputError(
                    f"{path}, line {reader.line_num}: {len(row)} values, "
                    f"the header has {len(header)}"
                )
            lines.append(reader.line_num)
            for what, place in places.items():
                cells[what].append(_number(path, reader.line_num, header[place], row[place]))
    return lines, cells


def _number(path: Path, line: int, column: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(
            f"{path}, line {line}, column {column!r}: a finite number is needed, found {cell!r}"
        )
    return value
