"""Trials side by side, each in a process of its own."""

from __future__ import annotations

import os
import select
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from seatrial.errors import SimulationError
from seatrial.model.component import seconds
from seatrial.system.system import Engine
from seatrial.trial.files.trial import Trial
from seatrial.trial.running.forked import SLICE_MS
from seatrial.trial.running.hooks import BeyondLimitError, Hooks, InterruptedRun, StoppedError
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervised import Page, no_page
from seatrial.trial.running.supervision import Order, Outcome, Supervisor


def cores() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Pool:
    """Runs trials in ``jobs`` processes; ``page`` writes their reports.

    Use it as a context manager.

    ``hooks.progress`` is called with the simulated time of all trials, done and to do, s. A trial
    that keeps to wall time, or that programs outside connect to, runs beside no other such one.
    """

    def __init__(
        self,
        trials: Sequence[Trial],
        engine: Engine,
        hooks: Hooks | None,
        jobs: int,
        page: Page | None = None,
    ) -> None:
        self._has_pages = page is not None
        self._hooks = hooks or Hooks()
        self._passed = [0.0] * len(trials)
        self._durations = [seconds(trial.stop_ns - trial.start_ns) for trial in trials]
        self._alone: set[int] = set()
        self._busy: dict[int, Supervisor] = {}
        self._begun: dict[int, float] = {}
        """When each order was given, monotonic wall time, s."""
        self._stopping = False
        slots = range(max(1, min(jobs, len(trials))))
        own = [replace(self._hooks, progress=partial(self._progress, slot)) for slot in slots]
        self._all = [Supervisor(trials, engine, each, page or no_page) for each in own]
        self._idle = list(self._all)

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        for supervisor in self._all:
            supervisor.__exit__()

    def check(self) -> None:
        """Check all trials. Raises what `Supervisor.check` raises, of the first that is wrong."""
        wrong: dict[int, Exception] = {}
        waiting = deque(range(len(self._durations)))
        while (waiting and not wrong) or self._busy:
            while waiting and self._idle and not wrong:
                self._begin("check", waiting.popleft(), None)
            for number, outcome in self._outcomes():
                if isinstance(outcome, Exception):
                    wrong[number] = outcome
                elif outcome is True:
                    self._alone.add(number)
        if wrong:
            raise wrong[min(wrong)]

    def run(self, folders: Mapping[int, Path]) -> Iterator[tuple[int, Result]]:
        """Yield number and result of each trial of ``folders`` as it ends, run into its folder.

        Once a stop is requested no other one begins. Raises what `Supervisor.run` raises.
        """
        waiting, results = deque(folders), dict[int, Result]()
        ended = len(self._durations) - len(folders)
        self._passed = [0.0 if n in folders else d for n, d in enumerate(self._durations)]
        while (waiting and not self._stopping) or self._busy:
            while self._idle and (number := self._next(waiting)) is not None:
                self._begin("run", number, folders[number])
            for number, outcome in self._outcomes():
                if isinstance(outcome, StoppedError):
                    self._stopping = True
                    continue
                if isinstance(outcome, BeyondLimitError):
                    results[number] = Result(folders[number], "failed", str(outcome), [], [])
                elif isinstance(outcome, Exception):
                    if number not in results:
                        raise outcome
                    _note_page(results[number], outcome)
                if isinstance(outcome, Result):
                    results[number] = outcome
                    self._passed[number] = self._durations[number]
                    self._stopping |= outcome.status == "stopped"
                    if self._has_pages:
                        self._begin("report", number, outcome.folder)
                        continue
                ended += 1
                yield number, results.pop(number)
            self._say_longest(ended)

    # ------------------------------------------------------------------ inside

    def _next(self, waiting: deque[int]) -> int | None:
        """Take the first that may begin beside those that run; None if there is none now."""
        if self._stopping:
            return None
        is_taken = any(number in self._alone for number in self._busy)
        for number in waiting:
            if not (is_taken and number in self._alone):
                waiting.remove(number)
                return number
        return None

    def _begin(self, what: Order, number: int, folder: Path | None) -> None:
        supervisor = self._idle.pop()
        self._busy[number], self._begun[number] = supervisor, time.monotonic()
        supervisor.begin(what, number, folder)

    def _outcomes(self) -> Iterator[tuple[int, Outcome | Exception]]:
        """Wait a moment, and yield what has come of orders."""
        descriptors = [d for supervisor in self._busy.values() for d in supervisor.descriptors()]
        if descriptors:
            waiting = select.poll()
            for descriptor in descriptors:
                waiting.register(descriptor, select.POLLIN)
            waiting.poll(SLICE_MS)
        for number, supervisor in list(self._busy.items()):
            try:
                outcome: Outcome | Exception | None = supervisor.poll(wait=False)
            except InterruptedRun:
                outcome = StoppedError("stopped before the run began; nothing was written")
            except Exception as error:
                outcome = error
            if outcome is not None:
                del self._busy[number]
                self._idle.append(supervisor)
                yield number, outcome

    def _say_longest(self, ended: int) -> None:
        if self._busy:
            oldest = next(iter(self._busy))
            self._hooks.under_way(ended, oldest, time.monotonic() - self._begun[oldest])

    def _progress(self, slot: int, passed: float, _whole: float) -> None:
        for number, supervisor in self._busy.items():
            if supervisor is self._all[slot]:
                self._passed[number] = passed
        self._hooks.progress(sum(self._passed), sum(self._durations))


def _note_page(result: Result, error: Exception) -> None:
    """Note that a report could not be written; raise it of a run that has not failed."""
    message = f"cannot write the report: {error}"
    if result.status != "failed":
        raise SimulationError(message)
    result.notes.append(message)
