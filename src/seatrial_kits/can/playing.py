"""Players of recordings: entries of a log, at the log's own times in simulated time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.links.clock_jumps import Array, clock_jumps, usual_step
from seatrial.model.component import NS, Component, Output, Parameter


@dataclass
class Recording:
    """A recording: times, s, of entries in the order of the file; None: the file has no times."""

    times: list[float] | None
    entries: Sequence[Any]
    skipped: Counter[str] = field(default_factory=Counter)
    """Entries that are left out, by reason."""


class Player(Component):
    """Base of players: plays the entries of ``file`` from ``begin_time`` on, at ``speed``.

    The entry of the log's time T is played at the simulated time

        start of the run + (T - first entry - begin_time) / speed

    up to ``end_time``, once, or again and again if ``repeat`` is on, one usual step after the last.
    The log's own clock counts alone. A clock that was set while it recorded, back by more than 1 s
    or forward by more than a day, goes on one usual step after the entry before; ``clock_set``
    counts that. Entries that come late are put in their place (``reordered``). ``skipped`` counts
    those that cannot be played. A log without times is played with ``interval`` between entries.

    Subclasses give `recording` and `put`. Raises InputError at the start for a file that cannot be
    read, without an entry, without times if ``interval`` is 0, and for a window without an entry.
    """

    discrete = True
    transient = Component.transient | {
        "_times_ns", "_order", "_entries", "_period_ns", "_counts",
    }  # fmt: skip

    file = Parameter("", "1", "recording; empty: nothing is played", role="file")
    begin_time = Parameter(0.0, "s", "time of the recording that is played first", min=0.0)
    end_time = Parameter(
        0.0, "s", "time of the recording at which it ends; 0: at its last entry", min=0.0
    )
    speed = Parameter(1.0, "1", "seconds of the recording in a simulated second", min=1e-6)
    repeat = Parameter("off", "1", "whether it begins again at its end", choices=("off", "on"))
    interval = Parameter(
        0.0, "s", "time between entries of a recording without times; 0: refused", min=0.0
    )

    played = Output("1", "entries played", type=int)
    skipped = Output("1", "entries of the file that cannot be played", type=int)
    reordered = Output("1", "entries that came late in the file", type=int)
    clock_set = Output("1", "times that the recorder's clock was set", type=int)

    def recording(self, path: Path) -> Recording:
        """Return the recording in a file. Raises InputError."""
        raise NotImplementedError

    def put(self, time_ns: int, entry: Any) -> None:
        """Send an entry at a simulated time."""
        raise NotImplementedError

    def flush(self) -> None:
        """Publish what was put in a step."""

    def start(self, t: float) -> None:
        """Read the file."""
        self._played = 0
        self._begun_ns = self.now_ns
        self._load()

    def step(self, t: float, h: float) -> None:
        """Send what is due from ``t`` to before ``t + h``."""
        end = self.now_ns + round(h * NS)
        while (due := self._due_ns(self._played)) is not None and due < end:
            self.put(max(due, self.now_ns), self._entry(self._played))
            self._played += 1
        self.flush()

    def outputs(self, t: float) -> None:
        """Publish the counts."""
        self.played = self._played
        self.skipped, self.reordered, self.clock_set = self._counts

    def set_state(self, state: Any) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._load()

    def _due_ns(self, number: int) -> int | None:
        """Return when an entry is due, None if there is none."""
        count = len(self._times_ns)
        if not count or (number >= count and self.repeat != "on"):
            return None
        turns, place = divmod(number, count)
        return self._begun_ns + turns * self._period_ns + int(self._times_ns[place])

    def _entry(self, number: int) -> Any:
        return self._entries[self._order[number % len(self._order)]]

    def _load(self) -> None:
        self._times_ns = self._order = np.empty(0, np.int64)
        self._entries: Sequence[Any] = ()
        self._period_ns, self._counts = 0, (0, 0, 0)
        if not self.file:
            return
        try:
            found = self.recording(Path(self.file))
        except OSError as error:
            raise InputError(f"{self.name}: {self.file}: {error.strerror}") from None
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None
        times, order, jumps, late = self._timed(found)
        self._counts = (sum(found.skipped.values()), late, jumps)
        self._window(times, order, found.entries)

    def _timed(self, found: Recording) -> tuple[Array, NDArray[np.int64], int, int]:
        """Return times from the first entry, s, rising, which entries they are of, and counts."""
        count = len(found.entries)
        if not count:
            raise InputError(f"{self.name}: {self.file}: has no entry that can be played")
        if found.times is None:
            if self.interval <= 0.0:
                raise InputError(
                    f"{self.name}: {self.file}: has no times: set interval, the time from entry to "
                    "entry"
                )
            return np.arange(count) * self.interval, np.arange(count), 0, 0
        times = np.asarray(found.times, np.float64)
        jumps, shifts = clock_jumps(times)
        past = np.searchsorted(jumps, np.arange(count), side="right")
        times = times + np.concatenate(([0.0], shifts))[past]
        order = np.argsort(times, kind="stable")
        late = int(np.count_nonzero(np.diff(times) < 0.0))
        # Times since 1970 are no finer: entries are on whole microseconds.
        return np.round(times[order] - times[order[0]], 6), order, len(jumps), late

    def _window(self, times: Array, order: NDArray[np.int64], entries: Sequence[Any]) -> None:
        first = int(np.searchsorted(times, self.begin_time))
        end = self.end_time if self.end_time > 0.0 else float(times[-1])
        last = int(np.searchsorted(times, end, side="right"))
        if first >= last:
            raise InputError(
                f"{self.name}: {self.file}: no entry from begin_time, {self.begin_time:g} s, to "
                f"{end:g} s; the recording is {times[-1]:g} s long"
            )
        chosen = times[first:last]
        self._times_ns = np.round((chosen - self.begin_time) / self.speed * NS).astype(np.int64)
        self._order, self._entries = order[first:last], entries
        after = 0.0 if self.end_time > 0.0 else usual_step(chosen) or 1.0
        self._period_ns = max(round((end + after - self.begin_time) / self.speed * NS), 1)
