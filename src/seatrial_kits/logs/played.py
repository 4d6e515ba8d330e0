"""Files that say what of a log is played into a rig, and the tables of values made of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from seatrial.errors import InputError, unknown
from seatrial.files.whole_file import stamp
from seatrial.fmi.components.table import RESERVED
from seatrial.fmi.components.table_file import LARGEST
from seatrial.model.component import NS
from seatrial.model.units import quantity
from seatrial.system.files import FileModel, read_toml, validated
from seatrial.trial.logs.channels import Array, Log
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.quantities import QUANTITIES, Column, defaults

from .paired.pairing import local_metres
from .paired.resampling import Trace, served, trace
from .paired.steady_clock import from_zero, steady

KNOWN = "_valid"
"""What the name of the switch beside an output ends with: whether the log knows the value."""
_LOCAL = ("north", "east")


class PlayedEntry(FileModel):
    """One output: a channel of the log, or a quantity that it serves."""

    channel: str
    """A name, or -NAME for opposite sign."""
    unit: str | None = None
    """Of the values, where the log does not say it."""
    held: bool | None = None
    """Whether a value stands until the next entry; by default states do, and others are linear."""
    gap: str | None = None
    """Entries further apart have nothing between them; by default five usual steps."""
    delay: str = "0 s"
    """By how much the channel is later than the log's clock says; it is played so much earlier."""


class PlayFile(FileModel):
    """A file that says what of a log is played."""

    log: str
    format: str | None = None
    time: str | None = None
    """Column of the time of a table, NAME or NAME:UNIT."""
    begin: str | None = Field(default=None, alias="from")
    """Time of the log at which the simulation begins; by default its first entry."""
    end: str | None = Field(default=None, alias="to")
    at: str = "0 s"
    """Simulated time of the begin."""
    speed: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.0
    """Seconds of the log in a simulated second."""
    play: dict[str, str | PlayedEntry] = Field(min_length=1)
    """Outputs by name: ``CHANNEL`` or ``CHANNEL:UNIT``, or a table."""


@dataclass(frozen=True)
class _Clock:
    """Simulated time of a log's times, s."""

    begin: float
    at: float
    speed: float

    def __call__(self, time: Array) -> Array:
        return (time - self.begin) / self.speed + self.at


def played(path: Path) -> str:
    """Return what of a log is played, as the text of a table (`fmi.components.table`).

    Every output has a switch beside it, ``NAME_valid``: whether the log knows the value. In a gap,
    before the first entry and after the last the nearest earlier value stands, and it is false.
    Raises InputError, with the file and its key, for what is no such file, and as `read_log`.
    """
    content, source = read_toml(path)
    if "log" not in content or "play" not in content:
        raise InputError(
            f"{path}: as a component, a file that says what of a log is played is needed: the keys "
            "log and [play]; found " + (", ".join(content) or "nothing")
        )
    file = validated(PlayFile, content, source.where)
    log = (path.parent / file.log).resolve()
    return _played(path, stamp(path), log, stamp(log))


@lru_cache(maxsize=16)
def _played(
    path: Path, stamped: tuple[int, int], log_path: Path, log_stamped: tuple[int, int]
) -> str:
    """Return the table of a file and a log, as they are at the times of their stamps."""
    content, source = read_toml(path)
    file = validated(PlayFile, content, source.where)
    named, _, unit = (file.time or "").partition(":")
    time = Column(named, unit or None) if named else None
    log = from_zero(steady(read_log(log_path, file.format, time)))
    traces, delays = {}, {}
    for name, written in file.play.items():
        where = f"{path}: play.{name}"
        entry = _entry(written)
        traces[name] = _trace(log, name, entry, where)
        delays[name] = _seconds(entry.delay, f"{where}.delay")
    ends = [(float(each.time[0]), float(each.time[-1])) for each in traces.values()]
    first = (
        min(begin for begin, _ in ends)
        if file.begin is None
        else _seconds(file.begin, f"{path}: from")
    )
    last = max(end for _, end in ends) if file.end is None else _seconds(file.end, f"{path}: to")
    if first > last:
        raise InputError(f"{path}: from is {first:g} s, after the end at {last:g} s")
    clock = _Clock(first, _seconds(file.at, f"{path}: at"), file.speed)
    shifted = {name: _shifted(each, delays[name]) for name, each in traces.items()}
    return frozen(log.path.name, shifted, (first, last), clock, str(path))


def _entry(written: str | PlayedEntry) -> PlayedEntry:
    if not isinstance(written, str):
        return written
    name, _, unit = written.partition(":")
    return PlayedEntry(channel=name, unit=unit or None)


def _seconds(text: str, where: str) -> float:
    try:
        return quantity(text, "s")
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _trace(log: Log, name: str, entry: PlayedEntry, where: str) -> Trace:
    """Return the channel of an output. Raises InputError that names the key."""
    if not name.isidentifier() or name in RESERVED:
        raise InputError(
            f"{where}: an output cannot be called {name!r}: letters, digits and _ are needed, and "
            "another name than those of components' own"
        )
    column = Column(entry.channel, entry.unit)
    try:
        found = found_in(log, column)
        if entry.held is not None:
            gap = np.inf if entry.held else found.usual * 5.0
            found = _with(found, held=entry.held, gap=gap)
        if entry.gap is not None:
            found = _with(found, held=found.held, gap=_seconds(entry.gap, f"{where}.gap"))
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(where) else f"{where}: {text}") from None
    return found


def found_in(log: Log, column: Column) -> Trace:
    """Return a channel of a log, or the quantity of that name that it serves; north and east, too.

    Raises InputError for one that is neither.
    """
    name = column.name
    if name in log.channels or name.removeprefix("-") in log.channels:
        return trace(log, name.removeprefix("-"), column)
    if name not in QUANTITIES:
        known = [*log.channels, *defaults(log)]
        raise InputError(f"{log.path}: {unknown(log.noun, name, known)}")
    each = served(log, name)
    if each is None and name in _LOCAL:
        each = _local(log, name)
    if each is None:
        raise InputError(f"{log.path}: no {log.noun} serves as {name}")
    return each


def _local(log: Log, name: str) -> Trace | None:
    """Return north or east of the first fix, m."""
    latitude, longitude = (served(log, what) for what in ("latitude", "longitude"))
    if latitude is None or longitude is None:
        return None
    longitudes, known = longitude.at(latitude.time)
    fixed = known & ((latitude.values != 0.0) | (longitudes != 0.0))
    if not fixed.any():
        return None
    values = local_metres(latitude.values[fixed], longitudes[fixed])[_LOCAL.index(name)]
    return Trace(name, "m", latitude.time[fixed], values, False, latitude.gap)


def _with(each: Trace, *, held: bool, gap: float) -> Trace:
    return Trace(each.name, each.unit, each.time, each.values, held, gap)


def _shifted(each: Trace, delay: float) -> Trace:
    return Trace(each.name, each.unit, each.time - delay, each.values, each.held, each.gap)


# ---------------------------------------------------------------------- table


def frozen(
    title: str, traces: Mapping[str, Trace], window: tuple[float, float], clock: _Clock, where: str
) -> str:
    """Return traces in a window of the log's time as the text of a table.

    The rows are at all entries of all traces, where values that are linear between entries are
    exact, with a row on either side of each gap. Raises InputError, with ``where``, for more than
    a table may hold.
    """
    times = rows_of(traces.values(), window)
    if len(times) * len(traces) * 12 > LARGEST:
        raise InputError(
            f"{where}: {len(times)} rows of {len(traces)} outputs are too many to be played; from "
            "and to take a part, fewer outputs fewer rows"
        )
    columns: list[list[Any]] = []
    for name, each in traces.items():
        values, known = each.at(times)
        how = "held" if each.held else "linear"
        columns.append([name, "real", each.unit, how, values.tolist()])
        columns.append([f"{name}{KNOWN}", "boolean", "1", "held", known.tolist()])
    doubled = next((c[0] for c in columns if [d[0] for d in columns].count(c[0]) > 1), None)
    if doubled is not None:
        raise InputError(f"{where}: play.{doubled}: the output {doubled!r} is there already")
    ticks = np.round(clock(times) * NS).astype(np.int64).tolist()
    content = {"file": title, "times_ns": ticks, "columns": columns}
    return json.dumps(content, separators=(",", ":"))


def rows_of(traces: Iterable[Trace], window: tuple[float, float]) -> Array:
    """Return the times of all entries in a window, its ends, and those on either side of gaps."""
    first, last = window
    parts = [np.array([first, last])]
    for each in traces:
        inside = (each.time >= first) & (each.time <= last)
        parts.append(each.time[inside])
        ends = np.flatnonzero(np.diff(each.time) > each.gap)
        parts += [each.time[ends] + 1e-9, each.time[ends + 1] - 1e-9, each.time[-1:] + 1e-9]
    times = np.unique(np.concatenate(parts))
    return times[(times >= first) & (times <= last)]
