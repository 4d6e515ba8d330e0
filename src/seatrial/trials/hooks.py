"""Hooks of a run: its caller watches and stops it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

from ..errors import SimulationError

Progress = Callable[[float, float], None]
"""Called now and then with the simulated time that has passed, and that of the whole run, s."""


class StoppedError(SimulationError):
    """A run was stopped before it began: it left nothing."""


@dataclass(frozen=True)
class Hooks:
    """What a caller may watch or stop."""

    building: Callable[[str], None] = lambda _: None
    progress: Progress = lambda _passed, _whole: None
    stop_requested: Callable[[], bool] = lambda: False
    interruptible: Callable[[], AbstractContextManager[object]] = nullcontext
    """Around what a component may never return from: elsewhere no signal raises anything."""
    reachable: Callable[[str, str], None] = lambda _name, _where: None
    """In real time: a component that programs outside connect to, and where."""

    def refuse_if_stopped(self) -> None:
        """Raise StoppedError if a stop was requested before anything was written."""
        if self.stop_requested():
            raise StoppedError("stopped before the run began; nothing was written")
