"""A log as the record of a run: one time axis, units, the motion of a craft."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import datetime
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from seatrial import __version__
from seatrial.errors import InputError, unmatched
from seatrial.system.parameters import Outline
from seatrial.trial.criteria.criteria import parse
from seatrial.trial.logs.channels import Array, Log
from seatrial.trial.logs.formats import FORMATS
from seatrial.trial.logs.quantities import QUANTITIES, Column, defaults
from seatrial.trial.records.run_folder import (
    MANIFEST,
    SIGNALS,
    TIMING,
    VERDICTS,
    Run,
    read_verdicts,
)
from seatrial.trial.running.output import write_json

from .columns import Columns
from .paired.common_time import WHOLE, Window
from .paired.pairing import local_metres
from .paired.resampling import Trace, served, trace

COMPONENT = "log"
"""The component that has all signals of a log."""
MOST_CHANNELS = 300
"""Channels of a log that are all imported; of more, those that serve a quantity or are named."""
_MOST_ROWS = 50_000_000
_CHUNK = 20_000
_AXES: Mapping[str, str] = {
    "position.x": "north",
    "position.y": "east",
    "position.z": "depth",
    "attitude.phi": "roll",
    "attitude.theta": "pitch",
    "attitude.psi": "heading",
}
"""Quantities of a log as the motion of a craft has them, SI."""


@dataclass(frozen=True)
class Wanted:
    """What of a log is imported: columns by quantity, patterns of channels, part of the time."""

    columns: Mapping[str, Column] = field(default_factory=dict)
    patterns: Sequence[str] = ()
    window: Window = WHOLE
    every: float | None = None
    """Time between two rows, s; None: the rows of a table, else the usual step of the fastest."""


@dataclass(frozen=True, eq=False)
class Imported:
    """A log on one time axis (n,): signals by name with units, and which quantities they serve."""

    path: Path
    start: datetime | None
    """Date and time of the time 0, where they are known."""
    time: Array
    signals: Columns
    units: Mapping[str, str]
    switches: frozenset[str]
    """Signals that are true or false."""
    serves: Mapping[str, str]
    home: tuple[float, float, float] | None
    """Latitude and longitude of the origin of positions, rad, and altitude, m."""
    notes: tuple[str, ...]


def imported(log: Log, wanted: Wanted) -> Imported:
    """Return a log, whose clock is steady, as signals of the component `COMPONENT`.

    Channels keep their names and units, ``log.NAME``; the motion that the log has is
    ``log.position`` and ``log.attitude`` of a craft, in SI, positions from the first fix. Angles
    are without jumps by whole turns. A table keeps its rows. Others have even rows: real channels
    are linear between their entries, states are held. A row before the first entry of a channel,
    after its last one or in a gap of more than five usual steps has the nearest earlier value, and
    ``log.known.NAME`` is false.

    Raises InputError for a channel that there is not, a unit that is none, a pattern without a
    channel, and a window without a row.
    """
    notes: list[str] = []
    motion, home = _motion(log, wanted.columns, notes)
    traces = {**_channels(log, wanted, notes), **motion}
    if not traces:
        raise InputError(f"{log.path}: no channel with a number in it")
    time = _axis(log, traces, motion, wanted)
    signals = Columns(time)
    shares = {name: signals.add(f"{COMPONENT}.{name}", each) for name, each in traces.items()}
    units = {f"{COMPONENT}.{name}": each.unit for name, each in traces.items()}
    unknown = {name: share for name, share in shares.items() if share < 1.0}
    for name in unknown:
        signals.add_switch(f"{COMPONENT}.known.{name}", traces[name])
        units[f"{COMPONENT}.known.{name}"] = "1"
    if unknown:
        notes.append(_unknown_note(unknown))
    _complete_motion(signals, units, notes)
    switches = frozenset(f"{COMPONENT}.known.{name}" for name in unknown)
    serves = _serves(log, wanted.columns, signals)
    return Imported(
        log.path, log.start, time, signals, units, switches, serves, home, (*log.notes, *notes)
    )


def _motion(
    log: Log, columns: Mapping[str, Column], notes: list[str]
) -> tuple[dict[str, Trace], tuple[float, float, float] | None]:
    """Return the motion that a log has, by ports of a craft, and where its origin is."""
    found: dict[str, Trace] = {}
    for port, what in _AXES.items():
        each = served(log, what, columns.get(what))
        if each is not None:
            found[port] = each
    if {"position.x", "position.y"} <= found.keys():
        return found, None
    places = [served(log, what, columns.get(what)) for what in ("latitude", "longitude")]
    latitude, longitude = places
    if latitude is None or longitude is None:
        return found, None
    longitudes, known = longitude.at(latitude.time)
    fixed = known & ((latitude.values != 0.0) | (longitudes != 0.0))
    if not fixed.any():
        notes.append("no position has a fix")
        return found, None
    time, lat, lon = latitude.time[fixed], latitude.values[fixed], longitudes[fixed]
    if not fixed.all():
        notes.append(f"{int(np.count_nonzero(~fixed))} positions without a fix are left out")
    for port, values in zip(("position.x", "position.y"), local_metres(lat, lon), strict=True):
        found[port] = Trace(port, "m", time, values, False, latitude.gap)
    return found, (float(lat[0]), float(lon[0]), 0.0)


def _channels(log: Log, wanted: Wanted, notes: list[str]) -> dict[str, Trace]:
    """Return the channels that are imported, by name."""
    units = {column.name.removeprefix("-"): column.unit for column in wanted.columns.values()}
    names = [name for name, each in log.channels.items() if np.isfinite(each.values).any()]
    if wanted.patterns:
        for pattern in wanted.patterns:
            if not any(fnmatchcase(name, pattern) for name in log.channels):
                raise InputError(f"{log.path}: {unmatched(log.noun, pattern, list(log.channels))}")
        names = [n for n in names if any(fnmatchcase(n, p) for p in wanted.patterns)]
    elif len(names) > MOST_CHANNELS:
        serving = {column.name.removeprefix("-") for column in defaults(log).values()} | {*units}
        notes.append(
            f"{len(serving)} of {len(names)} channels are imported, those that serve a quantity: "
            "--channels 'PATTERN,...' names others"
        )
        names = [name for name in names if name in serving]
    traces = {}
    for name in names:
        try:
            traces[name] = trace(log, name, Column(name, units.get(name)))
        except InputError as error:
            if log.table or name in units or wanted.patterns:
                raise
            notes.append(f"{name} is left out: {str(error).removeprefix(f'{log.path}: ')}")
    return traces


def _axis(
    log: Log, traces: Mapping[str, Trace], motion: Mapping[str, Trace], wanted: Wanted
) -> Array:
    """Return the times of the rows, s."""
    first, last = wanted.window
    of_table = next(iter(log.channels.values())).time
    if log.table and wanted.every is None:
        inside = np.isfinite(of_table) & (of_table >= first) & (of_table <= last)
        time = of_table if inside.all() else of_table[inside]
    else:
        leading = motion or traces
        first = max(first, min(float(each.time[0]) for each in leading.values()))
        last = min(last, max(float(each.time[-1]) for each in leading.values()))
        usual = [each.usual for each in traces.values() if each.usual > 0.0 and not each.held]
        every = wanted.every or min(usual, default=1.0)
        count = max(int((last - first) / every + 1e-9) + 1, 0)
        if count > _MOST_ROWS:
            raise InputError(
                f"{log.path}: {count} rows {every:g} s apart, at most {_MOST_ROWS} are written; "
                "--every '1 s' takes fewer, --from and --to a part"
            )
        time = np.round((first + every * np.arange(count)) * 1e9) / 1e9
    if not len(time):
        begin, end = (float(place) for place in (of_table[0], of_table[-1]))
        raise InputError(
            f"{log.path}: no row from {first:g} s to {last:g} s; the log is from {begin:g} s to "
            f"{end:g} s"
        )
    return time


def _unknown_note(unknown: Mapping[str, float]) -> str:
    shares = sorted(unknown, key=lambda name: unknown[name])
    worst = ", ".join(
        f"{name} in {100.0 * (1.0 - unknown[name]):.3g} % of the rows" for name in shares[:4]
    )
    more = f", and {len(shares) - 4} more channels" if len(shares) > 4 else ""
    return f"not known, with the nearest earlier value: {worst}{more}; see the signals log.known.*"


def _complete_motion(signals: Columns, units: dict[str, str], notes: list[str]) -> None:
    """Add angles and depth of 0 to a motion with position and heading, which a craft has."""
    names = {port: f"{COMPONENT}.{port}" for port in _AXES}
    needed = ("position.x", "position.y", "attitude.psi")
    if not all(names[port] in signals for port in needed):
        return
    lacking = [port for port in _AXES if names[port] not in signals]
    for port in lacking:
        signals.add_zero(names[port])
        units[names[port]] = "m" if port.startswith("position") else "rad"
    if lacking:
        notes.append(f"{', '.join(_AXES[port] for port in lacking)}: not in the log, taken as 0")


def _serves(log: Log, columns: Mapping[str, Column], signals: Container[str]) -> dict[str, str]:
    """Return the signal that serves each quantity."""
    found = {}
    for what, column in {**defaults(log), **columns}.items():
        signal = f"{COMPONENT}.{column.name}"
        if what in QUANTITIES and what != "time" and signal in signals:
            found[what] = signal
    ports = {what: f"{COMPONENT}.{port}" for port, what in _AXES.items()}
    return {**found, **{what: name for what, name in ports.items() if name in signals}}


# ---------------------------------------------------------------------- run folder


def write_run(
    found: Imported,
    folder: Path,
    format_name: str,
    criteria: Sequence[tuple[str, str]] = (),
    outline: Outline | None = None,
    progress: Callable[[float], None] = lambda _: None,
) -> Run:
    """Write a log as a run folder, whose manifest is there already, empty; return it as read.

    ``progress`` is called with the share of rows that are written. Raises OSError with the name of
    a file that cannot be.
    """
    content = _manifest(found, format_name, criteria, outline)
    verdicts = verdicts_of(found, criteria)
    _write_signals(found, folder / SIGNALS, progress)
    write_json(folder / VERDICTS, verdicts)
    write_json(folder / TIMING, {})
    write_json(folder / MANIFEST, content)
    return Run(
        folder=folder,
        time=found.time,
        signals=found.signals,
        units=dict(found.units),
        manifest=content,
        verdicts=read_verdicts(folder),
        timing={},
        truncated=False,
        notes=(),
    )


def verdicts_of(found: Imported, criteria: Sequence[tuple[str, str]]) -> list[dict[str, Any]]:
    """Return the verdicts of criteria, (name, check) each, as a run's file has them.

    Raises InputError for a criterion that is none, or of signals that there are not.
    """
    rows = []
    for name, check in criteria:
        verdict = parse(check).evaluate(found.time, found.signals, found.units)
        rows.append({"name": name, "check": check, **asdict(verdict)})
    return rows


def _write_signals(found: Imported, path: Path, progress: Callable[[float], None]) -> None:
    """Write the rows, `_CHUNK` at a time, numbers so that they read back exactly."""
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(["time", *found.signals])
        for first in range(0, len(found.time), _CHUNK):
            rows = slice(first, first + _CHUNK)
            text = io.StringIO()
            writer = csv.writer(text, lineterminator="\n")
            cells = [found.time[rows].tolist()]
            for name in found.signals:
                column = found.signals.rows(name, rows)
                cells.append((column.astype(int) if name in found.switches else column).tolist())
            writer.writerows(zip(*cells, strict=True))
            file.write(text.getvalue())
            progress(min(1.0, (first + _CHUNK) / len(found.time)))


def _manifest(
    found: Imported, format_name: str, criteria: Sequence[tuple[str, str]], outline: Outline | None
) -> dict[str, Any]:
    path = found.path
    file = {"name": path.stem, "file": path.name, "sha256": content_hash(path)}
    title = f"{path.name}, {FORMATS.load(format_name).title}"
    steps = np.diff(found.time)
    step = float(np.median(steps)) if len(steps) else 1.0
    component: dict[str, Any] = {
        "fmu": f"log ({format_name})", "sha256": file["sha256"], "step": step, "parameters": {},
    }  # fmt: skip
    if outline is not None:
        component["outline"] = {"length": outline.length, "beam": outline.beam}
    if found.home is not None:
        component["home"] = list(found.home)
    start = found.start
    return {
        "format": 1,
        "seatrial": __version__,
        "trial": {**file, "title": title},
        "rig": {**file, "title": "a log, imported"},
        **({} if start is None else {"utc": start.isoformat()}),
        "start": float(found.time[0]),
        "stop": float(found.time[-1]),
        "step": step,
        "components": {COMPONENT: component},
        "connections": [],
        "signals": {
            name: {
                "type": "Boolean" if name in found.switches else "Real",
                "unit": found.units[name],
                "description": f"{name.removeprefix(f'{COMPONENT}.')} of {path.name}",
            }
            for name in found.signals
        },
        "criteria": [{"name": name, "check": check} for name, check in criteria],
        "plots": [],
        "events": [],
        "faults": [],
        "log": {"format": format_name, "serves": dict(found.serves), "notes": list(found.notes)},
        "status": "complete",
        "error": None,
    }


def content_hash(path: Path) -> str:
    """Return the SHA-256 of a file, or of the files in a folder by name."""
    found = hashlib.sha256()
    for each in sorted(path.rglob("*")) if path.is_dir() else [path]:
        if each.is_file():
            if path.is_dir():
                found.update(json.dumps(each.relative_to(path).as_posix()).encode())
            with each.open("rb") as file:
                while block := file.read(1 << 20):
                    found.update(block)
    return found.hexdigest()
