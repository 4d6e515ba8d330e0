"""Signals of a run that a log has, too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.trial.logs.channels import Array, Log
from seatrial.trial.logs.quantities import Column, defaults
from seatrial.trial.records.run_folder import Run

from ..run_log import known_rows, of_craft, switches
from .common_time import GAP
from .resampling import Trace, served, trace, unwrapped, usual_time

_PLACE = ("latitude", "longitude")
_SPEEDS = {"yaw_rate": "rates.r"}


@dataclass(frozen=True)
class Match:
    """A signal of a run, and the channel of a log that is the same."""

    signal: str
    column: Column


def read_matches(texts: Sequence[str], option: str) -> list[Match]:
    """Return pairs of texts ``SIGNAL=CHANNEL`` or ``SIGNAL=CHANNEL:UNIT``, several with commas.

    Raises InputError, naming the option, for another form.
    """
    found = []
    for part in (part.strip() for text in texts for part in text.split(",")):
        signal, equals, name = part.partition("=")
        name, colon, unit = name.partition(":")
        if not (signal and equals and name) or (colon and not unit):
            raise InputError(
                f"{option}: SIGNAL=CHANNEL or SIGNAL=CHANNEL:UNIT is needed, found {part!r}"
            )
        found.append(Match(signal, Column(name, unit or None)))
    return found


def compared_signals(names: Sequence[str], log: Log, matches: Sequence[Match]) -> set[str] | None:
    """Return the signals that `pairs` looks at, with their switches; None for all ``names``."""
    wanted = {each.signal for each in matches} or {name for name in names if name in log.channels}
    wanted = wanted or {name for found in motion_signals(names).values() for name in found}
    if not wanted <= {*names}:
        return None  # near misses are looked for among all
    return wanted.union(*map(switches, wanted)) & {*names}


def pairs(
    run: Run, log: Log, matches: Sequence[Match], columns: Mapping[str, Column]
) -> tuple[list[tuple[Trace, Trace]], list[str]]:
    """Return signals of a run with the channels of a log that are the same, and notes.

    Those of ``matches``, else the signals whose names the log has too, else the motion of the
    run's craft that serves a quantity which the log has, by its format or by ``columns``. Latitude
    and longitude are metres from the first fix, which is where the run's craft is then.

    Raises InputError for a signal or channel that there is not, and if nothing is in both.
    """
    if matches:
        return [(_signal(run, m.signal), trace(log, m.signal, m.column)) for m in matches], []
    numbers = [name for name, values in run.signals.items() if not isinstance(values, list)]
    same = [name for name in numbers if name in log.channels]
    if same:
        return [(_signal(run, n), trace(log, n, Column(n, run.units[n] if log.channels[n].unit is
                None else None))) for n in same], []  # fmt: skip
    return _by_quantity(run, log, columns, numbers)


def _by_quantity(
    run: Run, log: Log, columns: Mapping[str, Column], numbers: Sequence[str]
) -> tuple[list[tuple[Trace, Trace]], list[str]]:
    of_run = {what: names[0] for what, names in motion_signals(numbers).items()}
    of_log = {**defaults(log), **columns}
    shared = [what for what in of_run if what in of_log]
    found = [(_signal(run, of_run[what]), each) for what in shared
             if (each := served(log, what, of_log.get(what))) is not None]  # fmt: skip
    notes: list[str] = []
    if not {"north", "east"} & {*shared} and all(what in of_log for what in _PLACE):
        signals = [_signal(run, of_run[what]) for what in ("north", "east") if what in of_run]
        if len(signals) == 2:
            traces = [served(log, what, of_log[what]) for what in _PLACE]
            found = [*_places(signals, traces, notes), *found]  # type: ignore[arg-type]
    if not found:
        raise InputError(
            f"{log.path}: nothing in it has the name of a signal of {run.folder}, and no quantity "
            f"is in both: the run has {', '.join(of_run) or 'no motion of a craft'}, the log "
            f"{', '.join(of_log) or 'none by default'}; name pairs: --match SIGNAL=CHANNEL:UNIT"
        )
    return found, notes


def motion_signals(names: Sequence[str]) -> dict[str, list[str]]:
    """Return the signals of a run that serve quantities of its craft's motion, those there are."""
    there = set(names)
    crafts = [n.removesuffix(".attitude.psi") for n in names if n.endswith(".attitude.psi")]
    found = dict(of_craft(names))
    for what, port in _SPEEDS.items():
        found[what] = [f"{craft}.{port}" for craft in crafts if f"{craft}.{port}" in there]
    return {what: signals for what, signals in found.items() if signals}


def _places(
    signals: Sequence[Trace], traces: Sequence[Trace], notes: list[str]
) -> list[tuple[Trace, Trace]]:
    """Return north and east of a log's fixes, m, set off to where the run is at the first."""
    latitude, longitude = traces
    longitudes, known = longitude.at(latitude.time)
    fixed = known & ((latitude.values != 0.0) | (longitudes != 0.0))
    if not fixed.any():
        raise InputError("the log has no position with a fix")
    time = latitude.time[fixed]
    local = local_metres(latitude.values[fixed], longitudes[fixed])
    during = time >= max(each.time[0] for each in signals)
    first = int(np.argmax(during)) if during.any() else 0
    found = []
    for signal, values in zip(signals, local, strict=True):
        start = float(signal.at(time[first : first + 1])[0][0])
        moved = values - values[first] + start
        found.append((signal, Trace(signal.name, "m", time, moved, False, latitude.gap)))
    notes.append(
        f"positions are metres from the fix at {time[first]:g} s, where the run is then, too"
    )
    return found


def local_metres(latitude: Array, longitude: Array) -> tuple[Array, Array]:
    """Return north and east of the first place, m, WGS 84, of angles (n,), rad."""
    from pymap3d import geodetic2ned

    north, east, _ = geodetic2ned(
        latitude, longitude, 0.0, latitude[0], longitude[0], 0.0, deg=False
    )
    return np.asarray(north), np.asarray(east)


def _signal(run: Run, name: str) -> Trace:
    if name not in run.signals:
        raise InputError(f"{run.folder}: {unknown('signal', name, run.signals)}")
    values = run.signals[name]
    if isinstance(values, list):
        raise InputError(f"{run.folder}: {name} holds text, not numbers")
    return run_trace(run, name)


def run_trace(run: Run, name: str) -> Trace:
    """Return a signal of numbers of a run as a trace, where it is known.

    Raises InputError for one that is never known.
    """
    unit, known = run.units[name], known_rows(run, name)
    time, values = run.time, np.asarray(run.signals[name], np.float64)
    usual = usual_time(time, np.inf)
    if not known.all():
        time, values = time[known], values[known]
        if not len(time):
            raise InputError(f"{run.folder}: {name} is not known at any time")
    values = unwrapped(values, unit)
    if not np.all(time[1:] > time[:-1]):
        kept = np.append(np.diff(time) > 0.0, True)[: len(time)]
        time, values = time[kept], values[kept]
    return Trace(name, unit, time, values, False, GAP * usual)
