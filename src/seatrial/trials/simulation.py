"""A trial under way: events, records and steps, from the first manifest to the final one."""

from __future__ import annotations

import contextlib
import datetime
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ..component import seconds
from ..cosim.actions import action
from ..cosim.master import Master
from ..cosim.recorder import Recorder
from ..errors import SimulationError
from .ending import ended_by
from .hooks import Hooks
from .output import write_json, write_json_into_reserve, write_json_with_reserve
from .pacing import Pace
from .preparation import Prepared
from .termination import TerminationConditions
from .trial_file import CriterionEntry
from .verdict import Verdict

_OURS = "ended by an error of seatrial itself"
_SHOWN_EVERY_S = 0.1
"""Wall time between two calls of the progress hook."""
_LOOKED_EVERY = 16
"""Steps between two looks at the clock for it, in a run that no wall time paces."""


class Run:
    """One run of a prepared trial, in a folder of its own.

    `simulate` runs it to its end, whatever ends it; ``status`` and ``error`` say what did.
    ``wall`` takes the wall time of the simulation, s.
    """

    def __init__(
        self, prepared: Prepared, master: Master, folder: Path, hooks: Hooks, wall: dict[str, float]
    ) -> None:
        self.prepared, self.folder, self.wall = prepared, folder, wall
        self.status = "running"
        """complete, ended (by a criterion), ended by COMPONENT, stopped or failed, once over."""
        self.error: str | None = None
        trial = prepared.trial
        self._master, self._hooks = master, hooks
        watched = set().union(*(criterion.signals for _, criterion in trial.criteria))
        self._recorder = Recorder(
            folder / "signals.csv",
            master,
            prepared.recorded.signals,
            trial.record_every,
            sorted(watched),
        )
        self._termination = TerminationConditions(trial, master, prepared.units)
        self._pace = Pace(trial.file.real_time, master) if trial.file.real_time else None
        self._events = trial.events()
        self._floods: list[str] = []
        self._shown = time.perf_counter()

    def simulate(self) -> None:
        """Run to the end. Errors of the simulation and of the disk are kept in ``error``."""
        self._claim()
        self.status, self.error = "failed", _OURS
        started = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        begun = time.perf_counter()
        try:
            with self._hooks.interruptible():
                self.status, self.error = self._loop(), None
        except SimulationError as problem:
            self.error = str(problem)
        except KeyboardInterrupt:
            self.status, self.error = "stopped", None
        except OSError as problem:
            self._broken_disk(problem)
        finally:
            self.wall["run"] = time.perf_counter() - begun
            # A component may have crashed, or say only now that it was interrupted.
            with contextlib.suppress(SimulationError, KeyboardInterrupt):
                self._floods = list(self._master.system.floods())
            self._end(started)

    def evaluate(self) -> list[tuple[str, str, Verdict]]:
        """Evaluate the criteria on every communication step, however often rows were recorded.

        If they cannot be written, the run has failed and there are none.
        """
        trial, units = self.prepared.trial, self.prepared.units
        t, signals = self._recorder.watched()
        verdicts = [
            (name, entry.check, self._verdict(entry, criterion.evaluate(t, signals, units)))
            for entry, (name, criterion) in zip(trial.file.criteria, trial.criteria, strict=True)
        ]
        rows = [{"name": name, "check": check, **asdict(of)} for name, check, of in verdicts]
        try:
            write_json(self.folder / "verdicts.json", rows)
        except OSError as problem:
            self._broken_disk(problem)
            self._write_end()
            return []
        return verdicts

    def notes(self) -> list[str]:
        """Return what the user should know: of profiles, the rig, the steps, the pace."""
        pace = [] if self._pace is None else [self._pace.pacer.note()]
        prepared = self.prepared
        notes = [*prepared.system.notes, *prepared.recorded.notes, *prepared.loose_inputs()]
        of_master = [*self._master.notes(), *self._master.end_notes()]
        return [*notes, *of_master, *self._floods, *pace]

    # ------------------------------------------------------------------ inside

    @staticmethod
    def _verdict(entry: CriterionEntry, found: Verdict) -> Verdict:
        return replace(found, expected=entry.expect, why=entry.why)

    def _claim(self) -> None:
        """Write the manifest of a run under way; nothing empty is left on a full disk."""
        path = self.folder / "manifest.json"
        try:
            write_json_with_reserve(path, self._manifest())
        except OSError:
            for claimed in (path, self.folder / "signals.csv"):
                claimed.unlink(missing_ok=True)
            raise

    def _end(self, started: str) -> None:
        """Write how the run ended; what a full disk does not take is the reason that it failed."""
        timing = self.folder / "timing.json"
        for write in (self._recorder.close, lambda: write_json(timing, self._timing(started))):
            try:
                write()
            except OSError as problem:
                self._broken_disk(problem)
        self._write_end()

    def _broken_disk(self, problem: OSError) -> None:
        if self.status != "failed" or self.error == _OURS:  # else that was first
            where = problem.filename or self.folder
            self.status, self.error = "failed", f"cannot write {where}: {problem.strerror}"

    def _write_end(self) -> None:
        """Write the final manifest; if even that cannot be, the one there says "running"."""
        with contextlib.suppress(OSError):
            write_json_into_reserve(self.folder / "manifest.json", self._manifest())

    def _manifest(self) -> dict[str, Any]:
        return {**self.prepared.manifest, "status": self.status, "error": self.error}

    def _loop(self) -> str:
        """Step to the end; return the status."""
        master, recorder, termination = self._master, self._recorder, self._termination
        events, steps, observer = self._events, self.prepared.trial.steps, self._hooks.observer
        stop_requested, pace = self._hooks.stop_requested, self._pace
        if observer is not None:
            pacer = None if pace is None else pace.pacer
            observer.begin(self.prepared.manifest, master, pacer, self.folder)
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
            decided, over = termination.status(), master.steps >= steps
            enders = master.ended()
            recorder.record(last=bool(stopping or decided or over or enders))
            if decided or over or enders:
                break
            if stopping:
                return "stopped"
            before = master.steps
            if pace is None:
                self._advance(steps - before)
            else:
                pace.step(stop_requested)
            if pace is not None or master.steps // _LOOKED_EVERY > before // _LOOKED_EVERY:
                self._show_progress()
        self._hooks.progress(self._whole_s, self._whole_s)
        master.terminate()
        if decided is not None:
            return decided
        return ended_by(enders) if enders and not over else "complete"

    def _advance(self, most: int) -> None:
        """Step up to the next point at which something else than recording is done."""
        master, rows = self._master, self._recorder.rows
        if self._events:
            ahead_ns = self._events[0].at_ns - master.time_ns
            most = min(most, -(-ahead_ns // master.step_ns))
        if rows is None or self._termination.has_any or self._hooks.observer is not None:
            master.step()
            return
        try:
            master.advance(most, rows)
        finally:
            self._recorder.take()

    @property
    def _whole_s(self) -> float:
        trial = self.prepared.trial
        return seconds(trial.stop_ns - trial.start_ns)

    @property
    def _simulated_s(self) -> float:
        return seconds(self._master.time_ns - self._master.start_ns)

    def _show_progress(self) -> None:
        now = time.perf_counter()
        if now - self._shown > _SHOWN_EVERY_S:
            self._shown = now
            self._hooks.progress(self._simulated_s, self._whole_s)

    def _timing(self, started: str) -> dict[str, Any]:
        """Return what depends on the machine's speed."""
        times, pace = self._master.step_times, self._pace
        content = {
            "started": started,
            "wall_s": self.wall,
            "simulated_s": self._simulated_s,
            "steps": self._master.steps,
            "real_time_factor": self._simulated_s / self.wall["run"],
            "step_times": {name: of.as_json() for name, of in times.items()},
        }
        return content if pace is None else {**content, "pacing": pace.pacer.as_json()}
