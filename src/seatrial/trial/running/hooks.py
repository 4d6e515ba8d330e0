"""Hooks of a run: its caller watches and stops it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ...errors import SimulationError

if TYPE_CHECKING:
    from ...sim.clock import Pacer
    from ...sim.master import Master
    from ...system.system import System

Progress = Callable[[float, float], None]
"""Called now and then with the simulated time that has passed, and that of the whole run, s."""


class StoppedError(SimulationError):
    """A run was stopped before it began: it left nothing."""


class InterruptedRun(KeyboardInterrupt):
    """The process of a run was interrupted before the run began: it left nothing."""


class BeyondLimitError(SimulationError):
    """A run went beyond one of its limits, and left nothing."""


class Observer(Protocol):
    """Looks at a run between its steps, where the run is: in the process of its own."""

    stops: bool
    """Whether it wants the run to stop."""

    def begin(
        self, manifest: Mapping[str, Any], master: Master, pacer: Pacer | None, folder: Path
    ) -> None:
        """Called once, at the start time; ``pacer`` is that of a run in real time."""

    def at_point(self, stop_requested: Callable[[], int]) -> None:
        """Called at each communication point, before its row is recorded.

        What it sets or injects is as if events and faults of the trial had done it. It may stay,
        as long as no stop is requested.
        """


@dataclass(frozen=True)
class Hooks:
    """What a caller may watch or stop."""

    building: Callable[[str], None] = lambda _: None
    progress: Progress = lambda _passed, _whole: None
    under_way: Callable[[int, int, float], None] = lambda _ended, _case, _wall: None
    """Called now and then while cases of a campaign run: how many have ended, the number from 0 of
    the case that has been running longest, and its wall time so far, s."""
    assembled: Callable[[System, dict[str, Any]], None] = lambda _system, _manifest: None
    """Called with the rig and the run's manifest, before the components are started.

    Where nothing is written the manifest has the names of the components alone.
    """
    begun: Callable[[], None] = lambda: None
    """Called when all has started, and steps follow."""
    claimed: Callable[[Path], None] = lambda _: None
    """Called with the run's folder."""
    stop_requested: Callable[[], int] = lambda: 0
    """How often; what is requested a second time is to end at once."""
    interruptible: Callable[[], AbstractContextManager[object]] = nullcontext
    """Around what a component may never return from: elsewhere no signal raises anything."""
    reachable: Callable[[str, str], None] = lambda _name, _where: None
    """In real time: a component that programs outside connect to, and where."""

    note: Callable[[str], None] = lambda _: None
    """Called with what a person should know before anything runs."""

    observer: Observer | None = None
    keep_going: bool = False
    """Whether a run that may reach devices goes on without a link that it has lost."""

    def refuse_if_stopped(self) -> None:
        """Raise StoppedError if a stop was requested before anything was written."""
        if self.stop_requested():
            raise StoppedError("stopped before the run began; nothing was written")
