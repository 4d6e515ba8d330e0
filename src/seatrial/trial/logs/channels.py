"""A log as it was read: its channels, each with times of its own."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, unknown

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
_NAMED = 10
"""Kinds of entries that a note names."""


def counted(kinds: Counter[Any], what: str) -> list[str]:
    """Return the note on kinds of entries that no channel has, with their numbers; none without.

    The ten most frequent ones are named.
    """
    if not kinds:
        return []
    ordered = sorted(kinds.items(), key=lambda each: (-each[1], str(each[0])))
    named = [f"{kind} ({count})" for kind, count in ordered[:_NAMED]]
    more = len(ordered) - len(named)
    named += [f"{more} others ({sum(count for _, count in ordered[_NAMED:])})"] if more else []
    return [f"{what}: {', '.join(named)}"]


def empty_cells(channels: Mapping[str, Channel]) -> list[str]:
    """Return the note on the empty cells of a table's columns that have numbers; none without."""
    found = Counter[str]()
    for name, each in channels.items():
        lacking = int(np.count_nonzero(np.isnan(each.values)))
        found[name] = 0 if each.wrong or lacking == len(each.values) else lacking
    return counted(+found, "cells without a number, by column")


@dataclass(frozen=True, eq=False)
class Channel:
    """One measured value over time: arrays (n,)."""

    name: str
    unit: str | None
    """As `model.units` has it; None where the log does not say it."""
    time: Array
    """Time of the log, s."""
    values: Array
    """In the unit; NaN where the log has no finite number."""
    rows: Integers
    """Number of the line, row or message that each value stands in."""
    wrong: Mapping[int, str] = field(default_factory=dict)
    """Texts in the place of a number, by index: mistakes to be refused."""


@dataclass(frozen=True, eq=False)
class Log:
    """A log: channels by name, in the order of the file.

    Times are in s: as they are written in a table of seconds, else from the first entry, ``start``.
    """

    path: Path
    channels: Mapping[str, Channel]
    defaults: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Channels that can serve a quantity, the best first; ``-NAME`` is one of opposite sign."""
    start: datetime | None = None
    """Date and time of the time 0, where they are known."""
    notes: tuple[str, ...] = ()
    """For a person: parts of the file that are left out, and why."""
    row: str = "message"
    """Kind of entry: line, row or message."""
    table: bool = False
    """Whether all channels have the same times: rows of columns."""

    def channel(self, name: str) -> Channel:
        """Return a channel; raises InputError, with near misses, if there is none of that name."""
        if name not in self.channels:
            raise InputError(f"{self.path}: {unknown(self.noun, name, self.channels)}")
        return self.channels[name]

    @property
    def noun(self) -> str:
        """The word for a channel in messages."""
        return "column" if self.table else "channel"

    def place(self, channel: Channel, index: int) -> str:
        """Return the place of a value, for messages."""
        row = f"{self.path}, {self.row} {channel.rows[index]}"
        return f"{row}, {self.noun} {channel.name!r}"

    def instant(self, channel: Channel, index: int) -> str:
        """Return the place of an entry's time, for messages: a table's row has one for all."""
        return self.place(channel, index).partition(", column")[0]


@dataclass
class _Entries:
    """The entries of a channel so far, 24 bytes each."""

    unit: str | None
    times: array[float] = field(default_factory=lambda: array("d"))
    values: array[float] = field(default_factory=lambda: array("d"))
    rows: array[int] = field(default_factory=lambda: array("q"))


class Samples:
    """Values as they come, message by message, to be made channels; see `distinguished`."""

    def __init__(self) -> None:
        self._entries: dict[tuple[str, str], _Entries] = {}

    def add(
        self, name: str, unit: str | None, time: float, value: float, row: int, source: str = ""
    ) -> None:
        """Add a value of a channel; see `Channel`."""
        entries = self._entries.get((name, source))
        if entries is None:
            entries = self._entries[name, source] = _Entries(unit)
        entries.times.append(time)
        entries.values.append(value)
        entries.rows.append(row)

    def channels(self) -> dict[str, Channel]:
        """Return the channels by name, in the order in which they began."""
        return distinguished(
            {
                (name, source): channel(name, each.unit, each.times, each.values, each.rows)
                for (name, source), each in self._entries.items()
            }
        )


def distinguished(
    found: Mapping[tuple[str, str], Channel], first: str | None = None
) -> dict[str, Channel]:
    """Return channels, by name and source, by a name that is theirs alone.

    Several sources may send the same channel: two compasses, two vessels. That of the source
    ``first``, or of the first that is found, keeps its plain name; the others have the source
    before theirs, ``SOURCE/NAME``.
    """
    plain = dict(reversed(list(found))) | {
        name: source for name, source in found if source == first
    }
    shown = {
        (name, source): name if plain[name] == source else f"{source}/{name}"
        for name, source in found
    }
    return {shown[key]: replace(each, name=shown[key]) for key, each in found.items()}


def channel(
    name: str, unit: str | None, time: object, values: object, rows: object | None = None
) -> Channel:
    """Return a channel of any sequences; rows are counted from 1. Infinite values become NaN.

    Arrays and buffers of doubles are not copied: those of a long log are in memory once.
    """
    numbers = np.asarray(values, np.float64)
    infinite = np.isinf(numbers)
    if infinite.any():
        numbers = np.where(infinite, np.nan, numbers)
    counted = np.arange(1, len(numbers) + 1) if rows is None else rows
    return Channel(name, unit, np.asarray(time, np.float64), numbers, np.asarray(counted, np.int64))
