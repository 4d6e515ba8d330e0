"""Clocks of logs that were set while they recorded, and entries that came out of order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from seatrial.links.clock_jumps import clock_jumps
from seatrial.trial.logs.channels import Array, Channel, Log
from seatrial.trial.logs.clock_times import date_of

LATEST = 1e6
"""s; later times are not exact to the nanosecond, and are counted from the first entry."""


def steady(log: Log) -> Log:
    """Return a log whose clock does not jump, with the entries of each channel in order of time.

    A clock that was set, back by more than a second or forward by more than a day, goes on from
    the entry before, one usual step later. Single entries that come late are put in their place.
    Of entries of one channel with equal times the last stays. All three are counted in notes.
    """
    notes = list(log.notes)
    at, shifts = np.empty(0, np.int64), np.empty(0)
    # Of a log in which topics come one after the other, time goes back between them alone.
    if any(len(clock_jumps(each)[0]) for each in _finite_times(log)):
        rows, times = _entries(log)
        at, shifts = clock_jumps(times)
        at = rows[at]
    if len(at):
        first = f"the first before {log.row} {at[0]}, by {-shifts[0]:+.6g} s"
        notes.append(
            f"the clock was set {_times(len(at))}, {first}: the record goes on without jump"
        )
    disordered = doubled = 0
    entries = "rows" if log.table else "entries"
    channels = {}
    for name, each in log.channels.items():
        if not len(at) and np.all(each.time[1:] > each.time[:-1]):
            channels[name] = each  # as it is in memory: the times of a long table are there once
            continue
        moved = _moved(each, at, shifts)
        late = int(np.count_nonzero(np.diff(moved.time) < 0.0))
        if late:
            moved = _at(moved, np.argsort(moved.time, kind="stable"))
        kept = np.append(np.diff(moved.time) > 0.0, True)[: len(moved.time)]
        if not (log.table and channels):  # the columns of a row have one time
            disordered, doubled = disordered + late, doubled + int(np.count_nonzero(~kept))
        channels[name] = moved if kept.all() else _at(moved, np.flatnonzero(kept))
    if disordered:
        notes.append(f"{disordered} {entries} were out of order and are put in their place")
    if doubled:
        whose = "" if log.table else " of their channel"
        notes.append(f"{doubled} {entries} with the time of the next{whose} are left out")
    return replace(log, channels=channels, notes=tuple(notes))


def _finite_times(log: Log) -> Iterator[Array]:
    """Yield the times of each channel; of a table, whose channels have the same, once."""
    for each in list(log.channels.values())[: 1 if log.table else None]:
        finite = np.isfinite(each.time)
        yield each.time if finite.all() else each.time[finite]


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def from_zero(log: Log) -> Log:
    """Return a log whose times a simulation can have: since 1970 they become since the first."""
    ends = [(float(each.time[0]), float(each.time[-1])) for each in log.channels.values()
            if len(each.time)]  # fmt: skip
    if all(abs(end) < LATEST for pair in ends for end in pair):
        return log
    first = min(begin for begin, _ in ends)
    shifted: dict[int, Array] = {}  # by the array: the channels of a table share theirs
    for each in log.channels.values():
        if id(each.time) not in shifted:
            shifted[id(each.time)] = each.time - first
    channels = {
        name: replace(each, time=shifted[id(each.time)]) for name, each in log.channels.items()
    }
    note = f"times are from the first entry on, at {first:.6f} s"
    return replace(
        log, channels=channels, start=log.start or date_of(first), notes=(*log.notes, note)
    )


def _entries(log: Log) -> tuple[NDArray[np.int64], Array]:
    """Return the numbers of a log's entries, rising, and the time of each."""
    if log.table:
        one = next(iter(log.channels.values()))
        finite = np.isfinite(one.time)
        return (one.rows, one.time) if finite.all() else (one.rows[finite], one.time[finite])
    rows = np.concatenate([each.rows for each in log.channels.values()])
    times = np.concatenate([each.time for each in log.channels.values()])
    finite = np.isfinite(times)
    rows, first = np.unique(rows[finite], return_index=True)
    return rows, times[finite][first]


def _moved(channel: Channel, jumps: NDArray[np.int64], shifts: Array) -> Channel:
    if not len(jumps):
        return channel
    past = np.searchsorted(jumps, channel.rows, side="right")
    return replace(channel, time=channel.time + np.concatenate(([0.0], shifts))[past])


def _at(channel: Channel, places: NDArray[np.int64]) -> Channel:
    """Return some entries of a channel, in the order of ``places``."""
    numbers = {int(old): new for new, old in enumerate(places)} if channel.wrong else {}
    wrong = {numbers[i]: text for i, text in channel.wrong.items() if i in numbers}
    return replace(
        channel,
        time=channel.time[places],
        values=channel.values[places],
        rows=channel.rows[places],
        wrong=wrong,
    )
