"""The faults of a run, which begin and end at communication points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from ..model.faults.operators import Operator
from ..system.system import System
from .injected import Acting

_PENDING, _ACTING, _OVER = range(3)


class Stepped(Protocol):
    """The master, as faults need it."""

    @property
    def system(self) -> System:
        """What it steps."""

    @property
    def time_ns(self) -> int:
        """Simulated time, ns."""

    def values(self, component: str, names: Sequence[str]) -> list[Any]:
        """Return current values of a component's variables."""

    def inject(self, component: str, name: str, fault: Acting) -> None:
        """Let a fault act on a variable."""

    def clear(self, key: str) -> None:
        """End all that a fault does."""

    def restart(self, component: str) -> None:
        """Start a component anew."""


@dataclass(frozen=True)
class Fault:
    """A fault of a system, checked."""

    key: str
    begin_ns: int
    end_ns: int | None
    """None: it does not end."""
    grows_ns: int
    acts_on: Callable[[Stepped], list[tuple[str, str, Operator]]]
    """Components, variables and what becomes of them, as it begins."""
    restarts: tuple[str, ...] = ()
    """Components that start anew as it ends."""


@dataclass
class Schedule:
    """Faults in the order in which they begin, as written where they begin together."""

    faults: list[Fault] = field(default_factory=list)
    _phases: dict[str, int] = field(default_factory=dict)

    def add(self, fault: Fault) -> None:
        """Let a fault act when its time has come."""
        self.faults.append(fault)
        self.faults.sort(key=lambda one: one.begin_ns)
        self._phases[fault.key] = _PENDING

    def act(self, master: Stepped) -> None:
        """Begin and end what begins and ends by the master's time. Raises SimulationError."""
        if _PENDING not in self._phases.values() and _ACTING not in self._phases.values():
            return
        now = master.time_ns
        for fault in self.faults:
            phase = self._phases[fault.key]
            if phase == _PENDING and now >= fault.begin_ns:
                self._begin(master, fault)
                phase = _ACTING
            if phase == _ACTING and fault.end_ns is not None and now >= fault.end_ns:
                self.end(master, fault)

    def next_ns(self) -> int | None:
        """Return when the next fault begins or ends, ns; None if none does any more."""
        times = [f.begin_ns for f in self.faults if self._phases[f.key] == _PENDING]
        times += [f.end_ns for f in self.faults if self._phases[f.key] == _ACTING and f.end_ns]
        return min(times, default=None)

    def end(self, master: Stepped, fault: Fault) -> None:
        """End a fault now, whether it has begun or not. Raises SimulationError."""
        if self._phases[fault.key] == _ACTING:
            master.clear(fault.key)
            for component in fault.restarts:
                master.restart(component)
        self._phases[fault.key] = _OVER

    def save(self) -> Any:
        """Return what there is and what has begun and ended, for `restore`."""
        return list(self.faults), dict(self._phases)

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        faults, phases = state
        self.faults, self._phases = list(faults), dict(phases)

    def _begin(self, master: Stepped, fault: Fault) -> None:
        for component, name, operator in fault.acts_on(master):
            acting = Acting(fault.key, operator, fault.begin_ns, fault.grows_ns)
            master.inject(component, name, acting)
        self._phases[fault.key] = _ACTING
