"""Trials in a process of their own: whatever ends that, there is a result."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn

from ..cosim.system import Engine
from ..errors import InputError, SimulationError
from .ending import is_whole
from .forked import Forked
from .hooks import Hooks, StoppedError
from .link import Frame
from .output import claim_folder, write_json
from .predicates import Limit
from .preloading import preload
from .run import Result, check_trial, run_trial
from .run_folder import MANIFEST, written_status
from .supervised import serve
from .trial import Trial
from .verdict import Verdict

_ERRORS = {kind.__name__: kind for kind in (InputError, SimulationError, StoppedError)}
_IN_PROCESS = not hasattr(os, "fork")
"""Windows cannot copy a process: trials run in this one there."""


class Supervisor:
    """Runs trials one after the other in a child, and in another one once that has died.

    This process loads no component and opens no device. Use it as a context manager.
    """

    def __init__(self, trials: Sequence[Trial], engine: Engine, hooks: Hooks | None = None) -> None:
        self._trials, self._engine, self._hooks = trials, engine, hooks or Hooks()
        self._forked: Forked | None = None
        self._busy = False
        self._forget()

    def __enter__(self) -> Supervisor:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._forked is not None:
            self._forked.end(2 if self._busy else 0)

    def check(self, number: int) -> None:
        """Raise what `check_trial` raises; SimulationError if that ends its process."""
        if _IN_PROCESS:
            return check_trial(self._trials[number], self._engine, self._hooks)
        if self._ordered("check", number) is None:
            raise self._dead_before_start()
        return None

    def run(self, number: int, out: Path | None) -> Result:
        """Run a trial as `run_trial` does; a run that ends its process has failed.

        Raises what `run_trial` raises; SimulationError if its process ends before the components
        are there.
        """
        if _IN_PROCESS:
            return run_trial(self._trials[number], out, engine=self._engine, hooks=self._hooks)
        content = self._ordered("run", number, None if out is None else str(out))
        if content is None:
            return self._dead(number, out)
        folder = self._shown(out)
        result = _result(folder, content)
        self._note_sent(result)
        if is_whole(result.status) or result.status == "ended":
            try:
                said = written_status(folder)
            except InputError as error:
                raise SimulationError(f"a run that has ended: {error}") from None
            if said != result.status:
                raise SimulationError(f"{folder / MANIFEST} says {said!r} of a run that has ended")
        return result

    # ------------------------------------------------------------------ inside

    def _forget(self) -> None:
        """Forget the run before."""
        self._loading, self._folder = "", Path()
        self._manifest: dict[str, Any] = {}

    def _ordered(self, *order: Any) -> Any:
        """Give an order and return what came of it; None if the process has ended."""
        self._forget()
        if self._forked is None:
            preload(self._trials, self._engine)
            self._forked = Forked(partial(serve, self._trials, self._engine))
        self._busy = True
        self._forked.link.send(*order)
        while (frames := self._forked.frames(self._hooks.stop_requested())) is not None:
            for kind, *content in frames:
                if kind == "error":
                    self._busy = False
                    self._raise(*content)
                if kind in ("done", "checked"):
                    self._busy = False
                    return content[0] if content else {}
                self._handle(kind, content)
        self._busy = False
        return None

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
            raise KeyboardInterrupt
        raise _ERRORS.get(kind, SimulationError)(text)

    def _shown(self, out: Path | None) -> Path:
        """Return the run's folder as the user wrote it, or from the current one."""
        return out or self._folder.relative_to(Path.cwd())

    def _dead(self, number: int, out: Path | None) -> Result:
        """Return the result of a run whose process has ended: its manifest says how."""
        if not self._manifest:
            raise self._dead_before_start()
        status, error = self._how()
        if self._folder == Path():
            folder = claim_folder(out, self._trials[number].name, MANIFEST)
        else:
            folder = self._shown(out)
        try:
            write_json(folder / MANIFEST, {**self._manifest, "status": status, "error": error})
        except OSError as problem:
            raise SimulationError(f"{error}; cannot write {folder / MANIFEST}: {problem}") from None
        return Result(folder, status, error, [], [])

    def _dead_before_start(self) -> SimulationError:
        status, error = self._how()
        if status == "stopped":
            return StoppedError(f"stopped before the run began; {error}")
        return SimulationError(f"{error}; nothing was written")

    def _how(self) -> tuple[str, str]:
        """Return the status of a run whose process has ended by itself, and the reason."""
        assert self._forked is not None
        forked, self._forked = self._forked, None
        how, trace = forked.how(), forked.call_trace
        forked.end()
        component, call = trace.entry(list(self._manifest.get("components", [])))
        if component:
            error = f"{component}: the process of the run {how} in {call}"
        elif self._loading and not self._manifest:
            error = f"the process of the run {how} while it loaded {self._loading}"
        else:
            error = f"the process of the run {how} between two calls of components"
        return "stopped" if trace.asked > 1 else "failed", "; ".join([error, *forked.sent])

    def _note_sent(self, result: Result) -> None:
        assert self._forked is not None
        result.notes += self._forked.sent
        self._forked.sent = []


def run_supervised(
    trial: Trial, out: Path | None, *, engine: Engine = "fmu", hooks: Hooks | None = None
) -> Result:
    """Run ``trial`` as `run_trial` does, in a process of its own; see `Supervisor.run`."""
    with Supervisor([trial], engine, hooks) as supervisor:
        return supervisor.run(0, out)


def _result(folder: Path, content: dict[str, Any]) -> Result:
    verdicts = []
    for name, check, row in content["verdicts"]:
        verdict = Verdict(**row)
        limits = tuple(Limit(*limit) for limit in verdict.limits)
        verdicts.append((name, check, replace(verdict, limits=limits)))
    return Result(folder, **{**content, "verdicts": verdicts})
