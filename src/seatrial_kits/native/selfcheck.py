"""Before its C is used, a component takes the same steps in Python and in C, to the last bit."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.instance import Instance
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.model.component import Component
from seatrial.model.faults.catalogue import FAILURES
from seatrial.model.ports import ScalarPort

from .surroundings import surround, surroundings_of
from .tables import is_built_in, words_of

_STEPS = 120
_AGAIN = 30
"""Steps that are taken a second time, from a saved state."""
_SHARES = (0.31, 1.0, 0.7, 2.6)
"""Communication steps, of what a component takes for one."""


class DifferenceError(InputError):
    """The C of a component does not do what its Python does."""


def refuse_difference(
    source: ComponentSource,
    fmu: Path,
    built_in: Mapping[str, Any],
    values: Mapping[str, Any],
    surrounded: bool,
) -> None:
    """Raise DifferenceError, with both values, where a native FMU and its Python differ.

    The FMU was made with start values ``built_in`` (by port); both start with ``values`` (by
    scalar), once more with those that the class is ``exercised`` with. Inputs are random, near
    their start values and far from them, within their limits. An error that only one of them
    makes is a difference too.
    """
    exercised = {**_exercised(source, built_in), **values}
    for seed, (spread, start) in enumerate(((0.2, values), (3.0, values), (0.2, exercised))):
        python = source.component_class()(source.name)
        for port, value in built_in.items():
            python.set(port, value)
        pair = _Pair(python, fmu, start, random.Random(seed), spread)
        if surrounded and (around := surroundings_of(source, {**built_in, **start})):
            surround(pair.both[1], around)
        found = pair.difference()
        if found:
            raise DifferenceError(
                f"{source.origin} cannot be native: {found}. That is a fault of seatrial, not of "
                "the component: please report it"
            )


def _exercised(source: ComponentSource, built_in: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters that a class is exercised with, but for those that are built in."""
    cls = source.component_class()
    found: dict[str, Any] = {}
    for name, value in cls.exercised.items():
        port = cls.ports[name]
        if port.kind == "parameter" and name not in built_in and not is_built_in(cls, port):
            found |= dict(zip(port.scalar_names, port._spread(value), strict=True))
    return found


class _Pair:
    """A component in both carriers, which get the same."""

    def __init__(
        self,
        python: Component,
        fmu: Path,
        values: Mapping[str, Any],
        draw: random.Random,
        spread: float,
    ) -> None:
        cls = type(python)
        self.draw, self.spread, self.values = draw, spread, values
        self.inputs = [s for s in cls.scalars if s.port.kind == "input"]
        outputs = [s for s in cls.scalars if s.port.kind == "output" and s.port.type is not str]
        self.outputs = [scalar.name for scalar in outputs]
        self.both: tuple[Instance, Instance] = (
            DirectInstance(python, compiles=False),
            open_instance(load_fmu(fmu), python.name),
        )
        step = values.get("period") or getattr(python, "period", 0.0) or cls.fixed_step or 0.02
        self.steps = [step if cls.fixed_step else share * step for share in _SHARES]

    def difference(self) -> str:
        """Return where the carriers differ, empty if nowhere."""
        try:
            return self._differs()
        finally:
            for each in self.both:
                each.free()

    def _differs(self) -> str:
        ended, found = self._same("at the start", lambda each, _: self._begun(each))
        if ended:
            return found
        self.writers = [each.writer([s.name for s in self.inputs]) for each in self.both]
        self.readers = [each.reader(self.outputs) for each in self.both]
        times = [0.0]
        for k in range(_STEPS):
            times.append(times[-1] + self.steps[k % len(self.steps)])
        states: list[Any] = []
        for k, (t, end) in enumerate(pairwise(times)):
            if k == _STEPS - _AGAIN:
                with suppress(SimulationError):  # what Python cannot save is not stepped again
                    states = [each.get_state() for each in self.both]
            ended, found = self._step(k, t, end - t)
            if ended:
                return found
        for each, state in zip(self.both, states, strict=False):
            each.set_state(state)
            each.free_state(state)
        again = list(enumerate(pairwise(times)))[-_AGAIN:] if states else []
        for k, (t, end) in again:
            ended, found = self._step(k, t, end - t)
            if ended:
                return found
        return ""

    def _begun(self, instance: Instance) -> list[Any]:
        instance.set_start(dict(self.values))
        instance.initialise(0.0, 1e9)
        instance.begin()
        return []

    def _step(self, k: int, t: float, h: float) -> tuple[bool, str]:
        if k % 3 == 0:  # in between, inputs stay
            self.given = [self._input(scalar, k) for scalar in self.inputs]

        def act(instance: Instance, which: int) -> list[Any]:
            self.writers[which](self.given)
            before = self.readers[which]()
            instance.step(t, h)
            return [*before, *self.readers[which]()]

        return self._same(f"in the step from {t:.6g} s", act)

    def _input(self, scalar: ScalarPort, k: int) -> Any:
        """Return a random value of an input, within its limits."""
        port, start = scalar.port, scalar.port.start[scalar.index]
        if port.type is str:
            words = (*FAILURES, "none") if port.role == "fault" else words_of(port)
            return self.draw.choice(words) if words and k % 13 == 0 else start
        if port.type is bool:
            return k < _STEPS // 3 or self.draw.random() < 0.7
        if port.type is int:
            value: float = self.draw.randrange(4)
        else:
            size = port.limit("nominal", scalar.index) or abs(start) or 1.0
            value = start + self.draw.uniform(-1.0, 1.0) * self.spread * size
        low, high = (port.limit(which, scalar.index) for which in ("min", "max"))
        value = value if low is None else max(low, value)
        return port.type(value if high is None else min(high, value))

    def _same(self, what: str, act: Callable[[Instance, int], list[Any]]) -> tuple[bool, str]:
        """Do something in both. Return whether that is the end, and what differs."""
        found: list[Any] = []
        for which, instance in enumerate(self.both):
            try:
                found.append(act(instance, which))
            except (InputError, SimulationError) as error:
                found.append(str(error).partition("\n")[0] or "an error")
        python, native = found
        errors = isinstance(python, str), isinstance(native, str)
        if all(errors):
            return True, ""
        if any(errors):
            texts = [each if isinstance(each, str) else "goes on" for each in found]
            return True, f"{what} Python: {texts[0]}, its C: {texts[1]}"
        for place, (a, b) in enumerate(zip(python, native, strict=True)):
            if (type(a), repr(a)) != (type(b), repr(b)):
                name = self.outputs[place % len(self.outputs)]
                return True, f"{what} {name} is {a!r} in Python, {b!r} in C"
        return False, ""
