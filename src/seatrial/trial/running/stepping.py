"""The steps of a trial: events, rows of the record, and the end, whatever becomes of the record."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import SimulationError
from ...model.component import NS, seconds
from ...sim.actions import action
from ...sim.clock import Pacer
from ...sim.master import Master
from ...sim.recorder import Recorder, Watched
from ..criteria.verdict import Verdict
from ..files.trial import Trial
from ..files.trial_file import RealTimeEntry
from ..records.ending import ended_by
from .at_points import Standing, TerminationConditions
from .hooks import Hooks
from .lost_links import LostLinks
from .preparation import Prepared

_SHOWN_EVERY_S = 0.1
"""Wall time between two calls of the progress hook."""
_BLOCK_S = 0.1
"""Wall time of a block of steps, between two looks at orders to stop."""


def watched_signals(trial: Trial) -> list[str]:
    """Return the signals that criteria and figures need at every communication point."""
    return sorted({*trial.figures}.union(*(c.signals for _, c in trial.criteria)))


class Stepping:
    """One pass of a prepared trial from its start to its end."""

    def __init__(
        self,
        prepared: Prepared,
        master: Master,
        recorder: Recorder | Watched,
        hooks: Hooks,
        folder: Path | None = None,
    ) -> None:
        trial = prepared.trial
        self.master = master
        self.pace = Pace(trial.file.real_time, master) if trial.file.real_time else None
        self._prepared, self._recorder, self._hooks = prepared, recorder, hooks
        self._folder = folder
        self._termination = TerminationConditions(trial, master, prepared.units)
        self._standing = Standing(trial, master, prepared.units)
        self._events = trial.events()
        self.links = LostLinks(master, hooks.keep_going)
        self._shown = time.perf_counter()
        self._block = 1
        """Most steps of the next block."""

    def loop(self) -> str:
        """Step to the end; return the status. Raises SimulationError, OSError of the record."""
        master, recorder, termination = self.master, self._recorder, self._termination
        events, steps, observer = self._events, self._prepared.trial.steps, self._hooks.observer
        may_decide = termination.has_any
        stop_requested, pace = self._hooks.stop_requested, self.pace
        self._hooks.begun()
        if observer is not None:
            assert self._folder is not None
            pacer = None if pace is None else pace.pacer
            observer.begin(self._prepared.manifest, master, pacer, self._folder)
        if pace is not None:
            pace.start()
        while True:
            while events and events[0].at_ns <= master.time_ns:
                event = events.pop(0)
                where = f"event {event.key}"
                action(master.system, "set", event.key, event.written, where).apply(master)
            if observer is not None:
                observer.at_point(stop_requested)
            stopping = stop_requested() or (observer is not None and observer.stops)
            if pace is not None:
                master.meet_arrivals()  # last of all: what comes later waits for the next point
            decided = termination.status() if may_decide else None
            self._standing.look()
            self.links.look()
            over = master.steps >= steps
            enders = master.ended()
            recorder.record(last=bool(stopping or decided or over or enders))
            if decided or over or enders:
                break
            if stopping:
                return "stopped"
            if pace is None:
                self._advance(steps - master.steps)
            else:
                pace.step(stop_requested)
            self._show_progress()
        self._hooks.progress(self._whole_s, self._whole_s)
        master.terminate()
        if decided is not None:
            return decided
        return ended_by(enders) if enders and not over else "complete"

    def verdicts(self) -> list[tuple[str, str, Verdict]]:
        """Evaluate the criteria on every communication step, however often rows were recorded."""
        trial, units = self._prepared.trial, self._prepared.units
        t, signals = self._recorder.watched()
        return [
            (
                name,
                entry.check,
                replace(
                    criterion.evaluate(t, signals, units), expected=entry.expect, why=entry.why
                ),
            )
            for entry, (name, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
        ]

    def figures(self) -> list[list[float]]:
        """Return least, greatest and last value of each of the trial's figures, in its unit."""
        columns = self._recorder.watched()[1]
        found = (np.asarray(columns[name], float) for name in self._prepared.trial.figures)
        return [[float(c.min()), float(c.max()), float(c[-1])] for c in found]

    def notes(self) -> list[str]:
        """Return what the user should know of profiles, the rig and the steps."""
        prepared = self._prepared
        of_rig = [*prepared.system.notes, *prepared.recorded.notes, *prepared.loose_inputs()]
        return [*of_rig, *self.master.notes(), *self.master.end_notes()]

    def pace_notes(self) -> list[str]:
        """Return what depends on wall time: which links were lost, and how the pace was kept."""
        return [*self.links.notes(), *([] if self.pace is None else [self.pace.pacer.note()])]

    def _advance(self, most: int) -> None:
        """Step up to the next point at which something else than recording is done."""
        master, recorder = self.master, self._recorder
        rows = recorder.rows if master.is_compiled or not recorder.at_once else None
        at_points = self._termination.has_any or self._standing.has_any
        if rows is None or at_points or self._hooks.observer is not None:
            master.step()
            return
        if self._events:
            ahead_ns = self._events[0].at_ns - master.time_ns
            most = min(most, -(-ahead_ns // master.step_ns))
        begun = time.perf_counter()
        try:
            taken = master.advance(min(most, self._block), rows)
        except BaseException:
            recorder.take()
            raise
        if taken > 1:  # else there is no point in between
            recorder.take()
        took = time.perf_counter() - begun
        self._block = max(1, int(_BLOCK_S * taken / max(took, 1e-9)))

    @property
    def simulated_s(self) -> float:
        """Simulated time so far, s."""
        return seconds(self.master.time_ns - self.master.start_ns)

    @property
    def _whole_s(self) -> float:
        trial = self._prepared.trial
        return seconds(trial.stop_ns - trial.start_ns)

    def _show_progress(self) -> None:
        now = time.perf_counter()
        if now - self._shown > _SHOWN_EVERY_S:
            self._shown = now
            self._hooks.progress(self.simulated_s, self._whole_s)


_LEAST_FACTOR = 1e-9


class Pace:
    """Steps of a master at the pace that a trial asks for.

    Where the factor is a signal, its value at a communication point is that of the step from
    there on. Wall time by which the signal ``paused`` grows in a step is excluded.
    """

    def __init__(self, entry: RealTimeEntry, master: Master) -> None:
        places = {".".join(name): place for place, name in enumerate(master.names)}
        self._master = master
        self._factor = entry.factor
        self._factor_place = places[entry.factor] if isinstance(entry.factor, str) else None
        self._paused_place = places[entry.paused] if entry.paused is not None else None
        self.pacer = Pacer(1.0 if isinstance(entry.factor, str) else entry.factor, entry.overrun)

    def start(self) -> None:
        """Start the clock. Raises SimulationError for a signal that is no factor."""
        self._paused = self._paused_s()
        self.pacer.factor = self._wanted()
        self.pacer.start(self._master.time_ns)

    def step(self, stop_requested: Callable[[], int]) -> None:
        """Take a step and wait until its end is due, or a stop is requested.

        Raises SimulationError if the step is late and must not be, or for a signal that is no
        factor.
        """
        master, pacer = self._master, self.pacer
        pacer.change(self._wanted(), master.time_ns)
        before = {name: times.total_ns for name, times in master.step_times.items()}
        master.step()
        paused = self._paused_s()
        pacer.pause(round((paused - self._paused) * NS))
        self._paused = paused
        lateness = pacer.keep(master.time_ns, stop_requested)
        if lateness and pacer.policy == "abort":
            spent = {name: t.total_ns - before[name] for name, t in master.step_times.items()}
            slowest = max(spent, key=spent.__getitem__)
            raise SimulationError(
                f"at t = {master.time!r} s the step ended {lateness / 1e6:.3g} ms after its "
                f"deadline in real time (factor {pacer.factor:g}, overrun = 'abort'); {slowest} "
                f"took longest, {spent[slowest] / 1e6:.3g} ms"
            )

    def _wanted(self) -> float:
        """Return the factor of the step from here on."""
        if self._factor_place is None:
            return self.pacer.factor
        factor = float(self._master.signals[self._factor_place])
        if not _LEAST_FACTOR <= factor < math.inf:
            raise SimulationError(
                f"real_time.factor: {self._factor} is {factor!r} at t = {self._master.time!r} s, "
                f"at least {_LEAST_FACTOR:g} is needed"
            )
        return factor

    def _paused_s(self) -> float:
        if self._paused_place is None:
            return 0.0
        return float(self._master.signals[self._paused_place])
