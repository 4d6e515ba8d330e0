"""A trial under way: events, records and steps, from the first manifest to the final one."""

from __future__ import annotations

import contextlib
import datetime
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...errors import SimulationError
from ...sim.master import Master
from ...sim.recorder import Recorder
from ..criteria.verdict import Verdict
from .hooks import Hooks
from .output import json_text, with_more, write_into_reserve, write_json, write_with_reserve
from .preparation import Prepared
from .stepping import Stepping, watched_signals

_OURS = "ended by an error of seatrial itself"


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
        self._hooks = hooks
        self._recorder = Recorder(
            folder / "signals.csv",
            master,
            prepared.recorded.signals,
            trial.record_every,
            watched_signals(trial),
        )
        self.stepping = Stepping(prepared, master, self._recorder, hooks, folder)
        self._floods: list[str] = []
        self._late: list[str] = []
        """Errors of the release of a run that had failed or was stopped before."""
        self._decided = json_text(prepared.manifest)

    def simulate(self) -> None:
        """Run to the end. Errors of the simulation and of the disk are kept in ``error``."""
        self._claim()
        self.status, self.error = "failed", _OURS
        started = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        begun = time.perf_counter()
        try:
            with self._hooks.interruptible():
                self.status, self.error = self.stepping.loop(), None
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
                self._floods = list(self.prepared.system.floods())
            self._end(started)

    def release(self) -> None:
        """Release the components. A run one of which dies in that has failed; its rows stay.

        What such a component computed is not to be trusted: memory that it has overwritten is
        often noticed only when it is released.
        """
        try:
            with self._hooks.interruptible():
                self.prepared.system.free()
        except KeyboardInterrupt:
            pass
        except SimulationError as problem:
            if self.status in ("failed", "stopped"):
                self._late.append(str(problem))
                return
            self.status, self.error = "failed", str(problem)
            self._write_end()

    def evaluate(self) -> list[tuple[str, str, Verdict]]:
        """Evaluate the criteria on every communication step, however often rows were recorded.

        If they cannot be written, the run has failed and there are none.
        """
        verdicts = self.stepping.verdicts()
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
        of_end = [*self._floods, *self._late, *self.stepping.pace_notes()]
        return [*self.stepping.notes(), *of_end]

    # ------------------------------------------------------------------ inside

    def _claim(self) -> None:
        """Write the manifest of a run under way; nothing empty is left on a full disk."""
        path = self.folder / "manifest.json"
        try:
            write_with_reserve(path, self._manifest())
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
            write_into_reserve(self.folder / "manifest.json", self._manifest())

    def _manifest(self) -> str:
        return with_more(self._decided, {"status": self.status, "error": self.error})

    def _timing(self, started: str) -> dict[str, Any]:
        """Return what depends on the machine's speed."""
        stepping = self.stepping
        master, pace = stepping.master, stepping.pace
        content = {
            "started": started,
            "wall_s": self.wall,
            "simulated_s": stepping.simulated_s,
            "steps": master.steps,
            "real_time_factor": stepping.simulated_s / self.wall["run"],
            "step_times": {name: of.as_json() for name, of in master.step_times.items()},
        }
        if lost := stepping.links.as_json():
            content["lost_links"] = lost
        return content if pace is None else {**content, "pacing": pace.pacer.as_json()}
