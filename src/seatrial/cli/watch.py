"""Progress of runs: a bar on a terminal, else a plain line on stderr every few seconds."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Protocol

from rich.markup import escape

from ..printable import printable
from .answer import answer
from .show import console

PERIOD = 5.0
"""Wall time before the first plain line, and from one to the next, s."""


class Watch:
    """How far a run is, or several one after the other: simulated time, share and rate."""

    def __init__(self, name: str, clock: Callable[[], float] = time.perf_counter) -> None:
        self._cases, self._case = 1, 0
        self._clock, self._started = clock, clock()
        self._begun: float | None = None
        self._failed = 0
        self._ended, self._longest = 0, (0, 0.0)
        self._show_again: Callable[[], None] = lambda: None
        self._display: _Display = (
            _Bar(name) if console.is_terminal and not answer.quiet else _Lines(name, clock)
        )

    def __enter__(self) -> Watch:
        return self

    def __exit__(self, *_: object) -> None:
        self._display.close()

    def expect(self, cases: int) -> None:
        """Say how many runs there will be."""
        self._cases = cases

    def building(self, what: str) -> None:
        """Show which component is being built or loaded."""
        self._display.load(what)
        self._started = self._clock()

    def progress(self, passed: float, whole: float) -> None:
        """Show how far the run is, simulated time in s."""
        elapsed = self._clock() - self._started
        factor = passed / elapsed if elapsed > 0 else 0.0
        case = f" ({self._case + 1} of {self._cases})" if self._cases > 1 else ""
        state = f"{passed:.1f} of {whole:g} s, {factor:.1f} x real time{case}"
        self._display.show((self._case + passed / whole) / self._cases, state)

    def reading(self, share: float) -> None:
        """Show how far a log has been read."""
        self._display.show(share, "read")

    def campaign(self, passed: float, whole: float) -> None:
        """Show how far all runs of a campaign are, side by side; simulated time in s."""
        if self._begun is None:
            self._begun = self._clock()
        elapsed = self._clock() - self._begun
        factor = passed / elapsed if elapsed > 0 else 0.0
        left = self._left((whole - passed) / factor if factor > 0 else math.inf)
        failed = f", {self._failed} failed" if self._failed else ""
        ended = max(self._case, self._ended)  # cases are logged in their order
        state = f"{ended} of {self._cases} cases{failed}, {factor:.1f} x real time{left}"
        self._display.show(passed / whole, state)
        self._show_again = partial(self.campaign, passed, whole)

    def under_way(self, ended: int, case: int, wall: float) -> None:
        """Show how many cases have ended, and which takes long: from 0, wall time so far in s."""
        self._ended, self._longest = ended, (case, wall)
        self._show_again()

    def cases(self, ended: int, failed: int) -> None:
        """Show how many cases of a campaign have ended, and of them failed."""
        if self._begun is None:
            self._begun = self._clock()
        elapsed = self._clock() - self._begun
        rate = max(ended - 1, 0) / elapsed if elapsed > 0 else 0.0
        left = self._left((self._cases - ended) / rate if rate > 0 else math.inf)
        state = f"{ended} of {self._cases} cases, {failed} failed, {rate:.3g} cases/s{left}"
        self._display.show(ended / self._cases, state)

    def _left(self, estimate: float) -> str:
        """Return the time left, s; or how long a case has taken that makes it no estimate."""
        case, wall = self._longest
        if wall > max(PERIOD, estimate if math.isfinite(estimate) else 0.0):
            return f", case {case + 1} has been running for {_duration(wall)}"
        return f", {_duration(estimate)} left" if math.isfinite(estimate) else ""

    def count(self, *, failed: bool) -> None:
        """Count a case that has failed."""
        self._failed += failed

    def log(self, show: Callable[[], None]) -> None:
        """Print something above the bar, at the end of a case."""
        self._case += 1
        show()


def _duration(seconds: float) -> str:
    """Return a time that is left, in the unit that says it shortest."""
    for unit, of_it in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * of_it:
            return f"{seconds / of_it:.0f} {unit}"
    return f"{seconds:.0f} s"


class _Display(Protocol):
    """Where progress is shown."""

    def load(self, what: str) -> None:
        """Show that a component is being built or loaded."""

    def show(self, share: float, state: str) -> None:
        """Show what has been done, as a share and in words."""

    def close(self) -> None:
        """Show no more."""


class _Bar:
    """A bar on the terminal, gone at the end."""

    def __init__(self, name: str) -> None:
        from rich.progress import BarColumn, Progress, TextColumn

        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[state]}"),
            console=console,
            transient=True,
        )
        self._task = self._progress.add_task(escape(name), total=1.0, state="")
        self._progress.start()

    def load(self, what: str) -> None:
        self._progress.update(self._task, state=escape(f"loading {what}"))

    def show(self, share: float, state: str) -> None:
        self._progress.update(self._task, completed=share, state=escape(state))

    def close(self) -> None:
        self._progress.stop()


class _Lines:
    """Lines for a file or a pipe: NAME: 21 %, 12.6 of 60 s, 4.5 x real time."""

    def __init__(self, name: str, clock: Callable[[], float]) -> None:
        self._name, self._clock = name, clock
        self._next = clock() + PERIOD

    def load(self, what: str) -> None:
        """Leave that unsaid: what goes wrong then is one message."""

    def show(self, share: float, state: str) -> None:
        if self._clock() >= self._next and not answer.quiet:
            self._next = self._clock() + PERIOD
            line = printable(f"{self._name}: {100 * share:.0f} %, {state}")
            print(line, file=sys.stderr, flush=True)

    def close(self) -> None:
        """Leave the lines as they are."""
