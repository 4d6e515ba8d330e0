"""Trials in a process of their own: whatever ends that, there is a result."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, NoReturn

from ...errors import InputError, SimulationError
from ...links.hardware import devices_allowed
from ...system.system import Engine
from ..criteria.predicates import Limit
from ..criteria.verdict import Verdict
from ..files.limit_entry import NONE, LimitEntry
from ..files.trial import Trial
from ..records.ending import is_whole
from ..records.run_folder import MANIFEST, written_status
from .call_trace import (
    AT_ANY_PACE,
    BEYOND_MEMORY,
    BEYOND_WALL,
    HUNG,
    IN_REAL_TIME,
    CallTrace,
    Limits,
)
from .forked import Forked
from .hooks import BeyondLimitError, Hooks, InterruptedRun, StoppedError
from .keeper import ASKED_S
from .link import Frame
from .measuring import Measured, measure_trial
from .output import claim_folder, write_json
from .preloading import preload
from .run import Result, check_trial, run_trial
from .supervised import Page, no_page, serve

_ERRORS = {kind.__name__: kind for kind in (InputError, SimulationError, StoppedError)}
Order = Literal["check", "measure", "measure together", "run", "report"]
Outcome = Result | Measured | list[Measured | None] | bool
Changes = tuple[Mapping[str, Any], str]
"""Settings, and who says so."""
_LOGGER = logging.getLogger(__name__)
_IN_PROCESS = not hasattr(os, "fork")
"""Windows cannot copy a process: trials run in this one there."""


class Supervisor:
    """Runs trials one after the other in a child, and in another one once that has died.

    This process loads no component and opens no device. ``page`` writes the report of a run's
    folder, if one is ordered. ``alike`` are some with the components of all (None: all), for
    ``trials`` that are made as they are asked for. Use it as a context manager.
    """

    def __init__(
        self,
        trials: Sequence[Trial],
        engine: Engine,
        hooks: Hooks | None = None,
        page: Page = no_page,
        alike: Sequence[Trial] | None = None,
    ) -> None:
        self._trials, self._engine, self._hooks = trials, engine, hooks or Hooks()
        self._page, self._alike = page, trials if alike is None else alike
        self._forked: Forked | None = None
        self._busy = self._is_free = self._is_warned = False
        self._order: tuple[Order, int, Path | None, Changes | None] = ("check", 0, None, None)
        self._forget()

    def __enter__(self) -> Supervisor:
        return self

    def __exit__(self, *_: object) -> None:
        if self._forked is not None:
            self._forked.end(2 if self._busy else 0)

    def check(self, number: int) -> None:
        """Raise what `check_trial` raises; SimulationError if that ends its process."""
        self._whole("check", number)

    def run(self, number: int, out: Path | None) -> Result:
        """Run a trial as `run_trial` does; a run that ends its process has failed.

        Raises what `run_trial` raises; SimulationError if its process ends before the components
        are there.
        """
        result = self._whole("run", number, out)
        assert isinstance(result, Result)
        return result

    def measure(self, number: int) -> Measured:
        """Run a trial as `measure_trial` does.

        Raises what that raises; SimulationError if its process ends: `run` says why.
        """
        measured = self._whole("measure", number)
        assert isinstance(measured, Measured)
        return measured

    def begin(
        self,
        what: Order,
        number: int,
        folder: Path | None = None,
        changes: Changes | None = None,
        several: Sequence[tuple[int, Changes | None]] = (),
    ) -> None:
        """Begin to check, measure or run a trial, or to write the report of its folder.

        ``changes`` are settings on top of the trial's own. Of ``several`` trials, each with its
        changes, those are measured together that can share a compiled program.
        """
        self._forget()
        self._order = what, number, folder, changes
        self._is_free = folder is not None and (
            not any(folder.iterdir()) if folder.is_dir() else not folder.exists()
        )
        trial = self._trials[number]
        self._say_unwatched(trial.file.limit)
        if _IN_PROCESS:
            return
        order = what, number, None if folder is None else str(folder), changes, several
        begins = self._forked is None
        if self._forked is None:
            preload(self._alike, self._engine)
            hooks = self._hooks
            how = self._engine, self._page, hooks.observer, hooks.keep_going
            self._forked = Forked(partial(serve, self._trials, *how), *order)
        self._busy = True
        self._forked.call_trace.limits = _limits(trial)
        self._forked.call_trace.devices = int(devices_allowed())
        if not begins:
            self._forked.link.send(*order)

    def descriptors(self) -> tuple[int, ...]:
        """Return what can be waited at until `poll` may find something."""
        return self._forked.descriptors() if self._forked is not None else ()

    def poll(self, *, wait: bool = True) -> Outcome | None:
        """Return what came of the order, within a moment; None while it is carried out.

        It is the result of a run, or what was measured, None for a trial that shares no program;
        of a check, whether the trial must run alone. Raises what `check` and `run` raise.
        """
        what, number, folder, _ = self._order
        if self._forked is None:
            return self._in_process()
        frames = self._forked.frames(self._hooks.stop_requested(), wait=wait)
        if frames is None:
            self._busy = False
            if what != "run":
                raise self._dead_before_start()
            return self._dead(number, folder)
        for kind, *content in frames:
            if kind == "error":
                self._busy = False
                self._raise(*content)
            if kind == "done":
                self._busy = False
                return self._outcome(content[0])
            self._handle(kind, content)
        return None

    # ------------------------------------------------------------------ inside

    def _whole(self, what: Order, number: int, folder: Path | None = None) -> Outcome:
        """Carry out an order to its end."""
        self.begin(what, number, folder)
        while (outcome := self.poll()) is None:
            pass
        return outcome

    def _in_process(self) -> Outcome:
        what, number, folder, changes = self._order
        trial = self._trials[number] if changes is None else self._trials[number].changed(*changes)
        if what == "check":
            return check_trial(trial, self._engine, self._hooks)
        if what == "measure":
            return measure_trial(trial, engine=self._engine, hooks=self._hooks)
        if what == "measure together":
            return []  # each alone
        if what == "report" and folder is not None:
            self._page(folder)
            return True
        return run_trial(trial, folder, engine=self._engine, hooks=self._hooks)

    def _outcome(self, content: dict[str, Any]) -> Outcome:
        what, _, out, _ = self._order
        if what == "measure":
            return Measured(**content)
        if what == "measure together":
            return [None if each is None else Measured(**each) for each in content["found"]]
        if what != "run":
            return bool(content.get("alone", True))
        folder = self._shown(out)
        result = result_of(folder, content)
        self._note_sent(result)
        if is_whole(result.status) or result.status == "ended":
            try:
                said = written_status(folder)
            except InputError as error:
                raise SimulationError(f"a run that has ended: {error}") from None
            if said != result.status:
                raise SimulationError(f"{folder / MANIFEST} says {said!r} of a run that has ended")
        return result

    def _say_unwatched(self, limits: LimitEntry) -> None:
        """Warn once of limits that this system does not watch."""
        is_watched = sys.platform == "linux" or (not _IN_PROCESS and limits.memory == NONE)
        if limits.is_of_run and not is_watched and not self._is_warned:
            self._is_warned = True
            kinds = "limit: no process" if _IN_PROCESS else "limit.memory: no memory"
            _LOGGER.warning("%s is watched on %s", kinds, sys.platform)

    def _forget(self) -> None:
        """Forget the run before."""
        self._loading, self._folder = "", Path()
        self._manifest: dict[str, Any] = {}

    def _handle(self, kind: str, content: Frame) -> None:
        """Pass on what happens in the process."""
        match kind:
            case "building":
                self._loading = content[0]
                self._hooks.building(*content)
            case "progress":
                self._hooks.progress(*content)
            case "reachable":
                self._hooks.reachable(*content)
            case "assembled":
                self._manifest = content[0]
            case "claimed":
                self._folder = Path(content[0])
                self._hooks.claimed(self._folder)
            case "log":
                name, level, text = content
                logging.getLogger(name).log(level, "%s", text)
            case "print":
                with suppress(AttributeError, OSError, ValueError):  # it is closed, or unread
                    getattr(sys, content[0]).write(content[1])

    def _raise(self, kind: str, text: str) -> NoReturn:
        if kind == KeyboardInterrupt.__name__:
            raise InterruptedRun
        raise _ERRORS.get(kind, SimulationError)(text)

    def _shown(self, out: Path | None) -> Path:
        """Return the run's folder as the user wrote it, or from the current one."""
        return out or self._folder.relative_to(Path.cwd())

    def _dead(self, number: int, out: Path | None) -> Result:
        """Return the result of a run whose process has ended: its manifest says how."""
        if not self._manifest:
            raise self._dead_before_start()
        status, error = self._how()
        if self._folder == Path() and out is not None and self._is_free:
            folder = out  # which the run may have made before it could say so
            folder.mkdir(parents=True, exist_ok=True)
        elif self._folder == Path():
            folder = claim_folder(out, self._trials[number].name, MANIFEST)
        else:
            folder = self._shown(out)
        try:
            write_json(folder / MANIFEST, {**self._manifest, "status": status, "error": error})
        except OSError as problem:
            raise SimulationError(f"{error}; cannot write {folder / MANIFEST}: {problem}") from None
        return Result(folder, status, error, [], [])

    def _dead_before_start(self) -> SimulationError:
        assert self._forked is not None
        trace = self._forked.call_trace
        is_beyond = trace.end in (BEYOND_WALL, BEYOND_MEMORY) and trace.runs % 2
        status, error = self._how()
        if status == "stopped":
            return StoppedError(f"stopped before the run began; {error}")
        if is_beyond:
            return BeyondLimitError(error)
        return SimulationError(f"{error}; nothing was written")

    def _how(self) -> tuple[str, str]:
        """Return the status of a run whose process has ended by itself, and the reason."""
        assert self._forked is not None
        forked, self._forked = self._forked, None
        how, trace = forked.how(), forked.call_trace
        forked.end()
        component, call = trace.entry(list(self._manifest.get("components", [])))
        is_loading = self._loading and not self._manifest
        if trace.end:
            loads = (
                f"the loading of {self._loading}" if self._loading and not self._manifest else ""
            )
            error = _killed(trace, f"{component}: {call}" if component else loads)
        elif component:
            error = f"{component}: the process of the run {how} in {call}"
        elif is_loading:
            error = f"the process of the run {how} while it loaded {self._loading}"
        else:
            error = f"the process of the run {how} between two calls of components"
        return "stopped" if trace.asked > 1 else "failed", "; ".join([error, *forked.sent])

    def _note_sent(self, result: Result) -> None:
        assert self._forked is not None
        result.notes += self._forked.sent
        self._forked.sent = []


def _limits(trial: Trial) -> Limits:
    """Return what a run of a trial may take."""
    written = trial.file.limit
    limits = IN_REAL_TIME if trial.file.real_time is not None else AT_ANY_PACE
    if written.call_s is not None:
        limits = Limits(*(written.call_s,) * 3)
    return limits._replace(wall=written.wall_s, memory=written.memory_bytes)


def _killed(trace: CallTrace, where: str) -> str:
    """Return why the keeper has ended the process of a run, which was ``where``."""
    where = where or "between two calls of components the run"
    if trace.end == HUNG:
        return f"{where} hung: no progress for {trace.limit(held=True):g} s (limit.call)"
    if trace.end == BEYOND_WALL:
        return f"{where}: beyond its limit of {trace.limits.wall:g} s of wall time (limit.wall)"
    if trace.end == BEYOND_MEMORY:
        most = trace.limits.memory / 1e6
        return f"{where}: beyond its limit of {most:g} MB of memory (limit.memory)"
    return f"{where} did not end within {ASKED_S:g} s of the request to stop"


def run_supervised(
    trial: Trial, out: Path | None, *, engine: Engine = "fmu", hooks: Hooks | None = None
) -> Result:
    """Run ``trial`` as `run_trial` does, in a process of its own; see `Supervisor.run`."""
    with Supervisor([trial], engine, hooks) as supervisor:
        return supervisor.run(0, out)


def result_of(folder: Path, content: dict[str, Any]) -> Result:
    """Return a result whose verdicts are written as (name, check, keys of a `Verdict`)."""
    verdicts = []
    for name, check, row in content["verdicts"]:
        verdict = Verdict(**row)
        limits = tuple(Limit(*limit) for limit in verdict.limits)
        verdicts.append((name, check, replace(verdict, limits=limits)))
    return Result(folder, **{**content, "verdicts": verdicts})
