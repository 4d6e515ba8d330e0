"""Comparison of two runs: signal by signal, and parameter by parameter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Group
from rich.markup import escape
from rich.table import Table

from ...model.component import NS
from ...model.readable import number
from ..criteria.expressions import FloatArray
from .identity import IDENTITY
from .run_folder import SIGNALS, Run, load_run

_SHOWN_DIGITS = 12
"""Of a hash."""
_SETTINGS = ("seatrial", "engine", "variant", "seed", "start", "stop", "step", "algorithm")


@dataclass(frozen=True)
class Difference:
    """How far one signal is apart in two runs, on their common times.

    For text: ``absolute`` is None, ``relative`` the share of rows that differ. For a signal
    that one run lacks, or that has no common rows, both are None and ``note`` has the reason.
    """

    signal: str
    unit: str
    absolute: float | None = None
    """Greatest difference, in the signal's unit; infinite where only one is a number.

    Of an angle that never leaves one turn, the shorter way round.
    """
    relative: float | None = None
    """The same as a share of the greatest magnitude in the column."""
    time: float | None = None
    """When that was, s; None if there is no difference."""
    note: str = ""


@dataclass(frozen=True)
class Change:
    """A parameter or setting that is not the same in both runs; None where it is missing."""

    name: str
    a: Any
    b: Any


@dataclass(frozen=True)
class Comparison:
    """What `compare` found."""

    names: tuple[str, str]
    identical: bool
    """The records are the same, byte for byte."""
    rows: tuple[int, int, int]
    """Number of common times, and of rows in each record."""
    differences: tuple[Difference, ...]
    changes: tuple[Change, ...]

    @property
    def worst(self) -> float | None:
        """Greatest relative difference of any signal; None if none could be compared."""
        relative = [d.relative for d in self.differences if d.relative is not None]
        return max(relative, default=None)

    @property
    def summary(self) -> str:
        """``identical bytes``, or how nearly equal the records are, and on how many times."""
        common, rows_a, rows_b = self.rows
        return f"{self._likeness()} ({common} common times of {rows_a} and {rows_b})"

    def _likeness(self) -> str:
        if self.identical:
            return "identical bytes"
        if self.worst is None:
            return "nothing in common to compare"
        if self.worst == np.inf:
            return "not equal: only one run has a number somewhere"
        equal = f"equal within {number(self.worst, 2)} of each signal's greatest value"
        alone = sum(bool(d.note) for d in self.differences)
        return f"{equal}; {alone} signals not compared" if alone else equal

    def within(self, tolerance: float) -> bool:
        """Return whether all signals of both runs agree to the relative ``tolerance``."""
        complete = all(d.relative is not None for d in self.differences)
        return self.identical or (complete and self.worst is not None and self.worst <= tolerance)

    def table(self) -> Group:
        """Return tables for rich: signals, the least alike first, and what was set differently."""
        changes = [self._change_table()] if self.changes else []
        return Group(self._signal_table(), *changes)

    def _signal_table(self) -> Table:
        title = escape(" / ".join(self.names))
        table = Table(title=title, title_justify="left")
        table.add_column("signal", overflow="fold")
        table.add_column("unit")
        for heading in ("difference", "of maximum", "at s"):
            table.add_column(heading, justify="right")
        for d in sorted(self.differences, key=_rank, reverse=True):
            if d.note:
                table.add_row(escape(d.signal), d.unit, escape(d.note))
                continue
            absolute = "text" if d.absolute is None else number(d.absolute, 3)
            time = "" if d.time is None else number(d.time, 9)
            table.add_row(escape(d.signal), d.unit, absolute, number(d.relative or 0.0, 3), time)
        return table

    def _change_table(self) -> Table:
        names = [escape(name) for name in self.names]
        table = Table("parameter", *names, title="What was set", title_justify="left")
        for change in self.changes:
            table.add_row(change.name, _shown(change.a), _shown(change.b))
        return table


def compare(folder_a: Path | str, folder_b: Path | str) -> Comparison:
    """Return how two runs differ, signal by signal on their common times.

    Raises InputError for a folder that is not a run.
    """
    run_a, run_b = load_run(folder_a), load_run(folder_b)
    bytes_a, bytes_b = _record(run_a), _record(run_b)
    ticks_a, ticks_b = (np.round(run.time * NS).astype(np.int64) for run in (run_a, run_b))
    _, in_a, in_b = np.intersect1d(ticks_a, ticks_b, return_indices=True)
    names = list(dict.fromkeys([*run_a.signals, *run_b.signals]))
    return Comparison(
        names=(run_a.folder.name, run_b.folder.name),
        identical=bytes_a is not None and bytes_a == bytes_b,
        rows=(len(in_a), len(ticks_a), len(ticks_b)),
        differences=tuple(_difference(name, run_a, run_b, in_a, in_b) for name in names),
        changes=tuple(_changes(run_a.manifest, run_b.manifest)),
    )


def _record(run: Run) -> bytes | None:
    path = run.folder / SIGNALS
    return path.read_bytes() if path.is_file() else None


def _rank(difference: Difference) -> float:
    return -1.0 if difference.relative is None else difference.relative


def _difference(name: str, run_a: Run, run_b: Run, in_a: Any, in_b: Any) -> Difference:
    unit = (run_a if name in run_a.units else run_b).units[name]
    for run in (run_a, run_b):
        if name not in run.signals:
            return Difference(name, unit, note=f"not in {run.folder.name}")
    if run_a.units[name] != run_b.units[name]:
        return Difference(name, unit, note=f"{run_b.folder.name} has it in {run_b.units[name]}")
    if not len(in_a):
        return Difference(name, unit, note="no common times")
    a, b = np.asarray(run_a.signals[name])[in_a], np.asarray(run_b.signals[name])[in_b]
    time = run_a.time[in_a]
    if a.dtype.kind != "f" or b.dtype.kind != "f":
        unequal = a.astype(str) != b.astype(str)
        first = float(time[np.argmax(unequal)]) if unequal.any() else None
        return Difference(name, unit, relative=float(unequal.mean()), time=first)
    gap = _gap(a, b)
    if unit == "rad" and _is_direction(a) and _is_direction(b):
        gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))  # pi and -pi are the same
    row = int(np.argmax(gap))
    absolute = float(gap[row])
    magnitude = np.abs(np.concatenate([a, b]))
    scale = float(np.max(magnitude, initial=0.0, where=np.isfinite(magnitude)))
    relative = absolute / scale if scale else absolute
    return Difference(name, unit, absolute, relative, float(time[row]) if absolute else None)


def _is_direction(angle: FloatArray) -> bool:
    """Return whether an angle, rad, never leaves one turn: beyond, turns are counted."""
    return bool(np.nanmax(np.abs(angle), initial=0.0) <= 2.0 * np.pi)


def _gap(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return |a - b|: zero where both are the same or not a number, infinite where one is not."""
    with np.errstate(invalid="ignore"):
        gap: FloatArray = np.abs(a - b)
    gap[(a == b) | (np.isnan(a) & np.isnan(b))] = 0.0
    gap[np.isnan(gap)] = np.inf
    return gap


def _changes(a: dict[str, Any], b: dict[str, Any]) -> Iterator[Change]:
    settings_a, settings_b = _settings(a), _settings(b)
    if IDENTITY in a and IDENTITY in b:
        settings_a, settings_b = settings_a | _content(a), settings_b | _content(b)
    for name in dict.fromkeys([*settings_a, *settings_b]):
        if settings_a.get(name) != settings_b.get(name):
            yield Change(name, settings_a.get(name), settings_b.get(name))


def _settings(manifest: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {key: manifest.get(key) for key in _SETTINGS}
    for name, component in manifest["components"].items():
        found[f"{name} (fmu)"] = component["fmu"]
        for parameter, entry in component["parameters"].items():
            found[f"{name}.{parameter}"] = entry["value"]
    return found


def _content(manifest: dict[str, Any]) -> dict[str, str]:
    """Return versions and hashes of what has decided a run."""
    identity = manifest[IDENTITY]
    files = [each.items() for each in identity["files"].values()]
    hashes = {f"{name} (file)": sha256[:_SHOWN_DIGITS] for each in files for name, sha256 in each}
    return {f"{name} (program)": said for name, said in identity["program"].items()} | hashes


def _shown(value: Any) -> str:
    if value is None:
        return "-"
    return repr(value) if isinstance(value, float) else escape(str(value))
