"""Events and faults of a trial in the copies of its system."""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

from seatrial.api.assembling import Assembled
from seatrial.errors import InputError
from seatrial.model.faults.operators import Fixed, Operator, Stuck
from seatrial.sim.fault_schedule import Fault, Stepped
from seatrial.system.system import System

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Acted(Protocol):
    """Copies that are acted on, as `Batch` is."""

    def get(self, name: str) -> Any:
        """Return values of all copies."""

    def set(self, name: str, value: Any, mask: Any) -> None:
        """Set an input or a parameter of the copies of the mask."""

    def override(self, name: str, value: Any, mask: Any) -> None:
        """Replace an output of the copies of the mask."""

    def release(self, name: str, mask: Any) -> None:
        """End that."""


class _Act(NamedTuple):
    call: str
    """``set``, ``override``, ``hold`` or ``release``."""
    name: str
    value: Any = None


class Course:
    """Acts by communication step, in the order in which they happen there.

    Faults are those of devices, and outputs that are fixed or stuck. Raises InputError for any
    other, and for two that act on one port at once.
    """

    def __init__(self, made: Assembled, step_ns: int) -> None:
        self._acts: dict[int, list[_Act]] = {}
        taken: dict[str, list[tuple[float, float]]] = {}
        for event in made.events:
            for name in made.named(event.key):
                for part, port in made.system.located(name, "set"):
                    taken[f"{part.name}.{port}"] = [(0.0, math.inf)]
        entries = made.trial.file.faults if made.trial else []
        faults = [*enumerate(zip(entries, made.faults, strict=True))]
        for index, (entry, fault) in sorted(faults, key=lambda each: each[1][1].begin_ns):
            assert made.trial is not None
            origin = f"{made.trial.read_from.path}: faults.{index}"
            span = fault.begin_ns, math.inf if fault.end_ns is None else fault.end_ns
            for acts in _acts_of(made.system, fault):
                if acts is None:
                    raise InputError(
                        f"{origin}: copies in compiled code have faults of devices, and outputs "
                        f"that are fixed or stuck at once, found {entry.written}"
                    )
                begin, end = acts
                others = taken.setdefault(begin.name, [])
                if any(span[0] < last and first < span[1] for first, last in others):
                    raise InputError(
                        f"{origin}: {begin.name} has another fault or an event: copies in compiled "
                        "code have one at a time"
                    )
                others.append(span)
                self._add(fault.begin_ns, step_ns, begin)
                if fault.end_ns is not None:
                    self._add(fault.end_ns, step_ns, end)
        for event in made.events:  # after faults, as the master and its caller have them
            self._add(event.at_ns, step_ns, _Act("set", event.key, event.written))

    def __bool__(self) -> bool:
        return bool(self._acts)

    def ahead(self, steps: NDArray[np.int64], most: int) -> int:
        """Return after how many steps the next act of one of these copies is, ``most`` at most."""
        return min([most, *(int(at - s) for at in self._acts for s in {*steps.tolist()} if at > s)])

    def act(self, batch: Acted, steps: NDArray[np.int64], chosen: NDArray[np.bool_]) -> None:
        """Do what is due in the chosen copies, which stand at these steps."""
        for at, acts in self._acts.items():
            due = chosen & (steps == at)
            if not due.any():
                continue
            for call, name, value in acts:
                if call == "release":
                    batch.release(name, due)
                elif call == "hold":
                    _hold(batch, name, due)
                else:
                    getattr(batch, call)(name, value, due)

    def _add(self, at_ns: int, step_ns: int, act: _Act) -> None:
        self._acts.setdefault(-(-at_ns // step_ns), []).append(act)


def _hold(batch: Acted, name: str, due: NDArray[np.bool_]) -> None:
    import numpy as np

    own = batch.get(name)
    batch.override(name, np.where(due & np.isfinite(own), own, own[due][0]), due)


def _acts_of(system: System, fault: Fault) -> Iterator[tuple[_Act, _Act] | None]:
    """Yield what a fault does where it begins and where it ends; None: what copies have not."""
    unstepped = SimpleNamespace(system=system, values=lambda _component, names: [""] * len(names))
    if fault.restarts:
        yield None
    for component, name, operator in fault.acts_on(cast("Stepped", unstepped)):
        yield _acts_on(system, component, name, operator, grows=fault.grows_ns > 0)


def _acts_on(
    system: System, component: str, name: str, operator: Operator, *, grows: bool
) -> tuple[_Act, _Act] | None:
    part, whole = system.parts[component], f"{component}.{name}"
    variable = part.instance.variables[name]
    if variable.type is str:
        if not isinstance(operator, Fixed) or name in system.feeders(component):
            return None
        own = part.given[name].value if name in part.given else variable.start
        return _Act("set", whole, operator.level), _Act("set", whole, own)
    if variable.causality != "output" or grows:
        return None
    if isinstance(operator, Stuck):
        return _Act("hold", whole), _Act("release", whole)
    if isinstance(operator, Fixed):
        return _Act("override", whole, operator.level), _Act("release", whole)
    return None
