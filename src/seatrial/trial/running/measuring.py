"""A trial run for what it comes to: no folder, no record on disk."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ...errors import SimulationError
from ...plugins import offered
from ...sim.recorder import Watched
from ...system.system import Engine
from ..criteria.verdict import Verdict
from ..files.trial import Trial
from ..records.ending import is_whole
from .generators import own_generators
from .hooks import Hooks
from .preparation import Prepared, prepare
from .run import Result
from .stepping import Stepping, watched_signals


@dataclass
class Measured:
    """What a run comes to, as plain data."""

    status: str
    """As of a `Result`."""
    error: str | None
    seed: int = 0
    verdicts: list[dict[str, Any]] = field(default_factory=list)
    """Of each criterion: name, check, and the keys of a `Verdict`."""
    figures: list[list[float]] = field(default_factory=list)
    """Least, greatest and last value of each of the trial's figures, in its unit."""
    wall: float = 0.0
    """Wall time, s."""

    @property
    def passed(self) -> bool:
        """True if the run came to an end of its own and every criterion is as expected."""
        expected = (v["passed"] == (v["expected"] == "pass") for v in self.verdicts)
        return is_whole(self.status) and all(expected)


def measured_of(result: Result) -> Measured:
    """Return what a run with a folder came to."""
    verdicts = [verdict_row(*verdict) for verdict in result.verdicts]
    wall = sum(result.wall.values())
    return Measured(result.status, result.error, result.seed, verdicts, result.figures, wall)


def measure_trial(trial: Trial, *, engine: Engine = "fmu", hooks: Hooks | None = None) -> Measured:
    """Run ``trial`` as `run_trial` does and return what it comes to; nothing is written.

    Raises InputError for bad input, or a rig that cannot start with it; StoppedError.
    """
    hooks = hooks or Hooks()
    begun = time.perf_counter()
    (found,) = measure_together([trial], engine, hooks)
    if found is not None:
        return found
    with hooks.interruptible():
        prepared = prepare(trial, engine, hooks)
    try:
        hooks.assembled(prepared.system, {"components": dict.fromkeys(prepared.system.parts)})
        with own_generators(prepared.system.seed):
            found = _stepped(prepared, hooks)
    except BaseException:
        with contextlib.suppress(KeyboardInterrupt), hooks.interruptible():
            prepared.system.discard()
        raise
    try:
        with contextlib.suppress(KeyboardInterrupt), hooks.interruptible():
            prepared.system.free()
    except SimulationError as problem:
        if found.status not in ("failed", "stopped"):
            found = Measured("failed", str(problem), found.seed)
    found.wall = time.perf_counter() - begun
    return found


def measure_together(
    trials: Sequence[Trial], engine: Engine, hooks: Hooks, planned: int = 1
) -> list[Measured | None]:
    """Measure those of some trials that can share a compiled program; None in the place of others.

    What each comes to is what `measure_trial` says of it. ``planned`` is how many trials there are
    in all: a program for many is worth its time. Raises StoppedError.
    """
    together = offered("batch.measured") if engine == "native" else None
    found: list[Measured | None] = [None] * len(trials)
    return found if together is None else together(trials, hooks, planned)


def _stepped(prepared: Prepared, hooks: Hooks) -> Measured:
    with hooks.interruptible():
        master = prepared.started()
    hooks.refuse_if_stopped()
    watched = Watched(master, watched_signals(prepared.trial))
    stepping = Stepping(prepared, master, watched, hooks)
    seed = prepared.system.seed
    try:
        with hooks.interruptible():
            status = stepping.loop()
    except SimulationError as problem:
        return Measured("failed", str(problem), seed)
    except KeyboardInterrupt:
        return Measured("stopped", None, seed)
    if status == "stopped":
        return Measured(status, None, seed)
    verdicts = [verdict_row(*verdict) for verdict in stepping.verdicts()]
    return Measured(status, None, seed, verdicts, stepping.figures())


def verdict_row(name: str, check: str, verdict: Verdict) -> dict[str, Any]:
    """Return what a table of runs has of a criterion."""
    return {"name": name, "check": check, **vars(verdict)}
