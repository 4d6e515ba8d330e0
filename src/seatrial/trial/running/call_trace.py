"""Trace of a run, in memory that processes share: its call, its progress, and orders to stop."""

from __future__ import annotations

import ctypes
import math
import mmap
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

from ...fmi.instance import Instance, Reader, Writer
from ...sim.compiled.structures import Marks

_CALLS = {
    "set_start": "the setting of its start values",
    "initialise": "its initialisation",
    "begin": "the end of its initialisation",
    "reader": "the binding of its outputs",
    "writer": "the binding of its inputs",
    "step": "its step",
    "get_state": "the saving of its state",
    "set_state": "the restoring of its state",
    "free_state": "the release of a state",
    "terminate": "its termination",
    "free": "its release",
    "read": "the reading of its outputs",
    "write": "the writing of its inputs",
}
_KINDS = {name: number for number, name in enumerate(_CALLS)}
_WORDS = list(_CALLS.values())
_ENDS = {_KINDS["terminate"], _KINDS["free"], _KINDS["free_state"]}
_ASKED, _CALL, _TIME, _POINTS, _ORDERS, _PHASE, _END, _DEVICES, _RUNS, _BEFORE, _LIMITS = range(11)
"""Cells: the first three as `Marks` has them. From the last one on: `Limits`, as doubles."""


class Limits(NamedTuple):
    """Limits of a run; infinite where there is none."""

    start: float
    """Wall time of a call at the start without progress, s."""
    step: float
    """The same in a step."""
    end: float
    """The same at the end."""
    wall: float = math.inf
    """Wall time of the run, s."""
    memory: float = math.inf
    """Resident memory beyond what the process had before the run, bytes."""


NO_LIMITS = Limits(math.inf, math.inf, math.inf)
AT_ANY_PACE = Limits(60.0, 60.0, 60.0)
IN_REAL_TIME = Limits(60.0, 2.0, 10.0)
STARTS, STEPS, UNNOTED = 1, 2, 3
HUNG, ASKED_IN_VAIN, BEYOND_WALL, BEYOND_MEMORY = 1, 2, 3, 4
"""Why the keeper has ended the process of a run."""


def _cell(place: int, what: str) -> Any:
    """Return a property that is a cell."""

    def written(self: CallTrace, value: int) -> None:
        self.cells[place] = value

    return property(lambda self: self.cells[place], written, doc=what)


class CallTrace:
    """Cells that a dead process leaves behind: no call costs more than a store or two."""

    def __init__(self) -> None:
        memory = memoryview(mmap.mmap(-1, mmap.PAGESIZE))
        self.cells, self._times = memory.cast("q"), memory.cast("d")
        self.limits = NO_LIMITS

    asked = _cell(_ASKED, "How urgently a stop is requested: 1 after the step, 2 at once.")
    orders = _cell(_ORDERS, "How many orders to stop the supervisor has sent.")
    end = _cell(_END, "Why the keeper has ended the process, 0 if it has not.")
    devices = _cell(_DEVICES, "Whether the run may reach devices.")
    runs = _cell(_RUNS, "How many runs have begun and ended: odd while one goes on.")
    before = _cell(_BEFORE, "Resident memory of the process before its run, bytes.")

    @property
    def limits(self) -> Limits:
        """What a run may take before its process is ended."""
        return Limits(*self._times[_LIMITS : _LIMITS + len(NO_LIMITS)])

    @limits.setter
    def limits(self, limits: Limits) -> None:
        for place, limit in enumerate(limits, _LIMITS):
            self._times[place] = limit

    def between_calls(self) -> int:
        """Note that no component is in a call, and return how urgently a stop is requested."""
        cells = self.cells
        cells[_CALL] = 0
        cells[_POINTS] += 1
        return cells[_ASKED]

    @property
    def phase(self) -> int:
        """What goes on that may hang: `STARTS`, which ends are too, or `STEPS`; 0 for nothing.

        `UNNOTED` are a start and an end whose calls are not noted.
        """
        return self.cells[_PHASE]

    @phase.setter
    def phase(self, phase: int) -> None:
        self.cells[_CALL], self.cells[_PHASE] = 0, phase

    def progress(self) -> tuple[int, int, float]:
        """Return what changes as long as a run goes on, whatever is slow in it."""
        return self.cells[_POINTS], self.cells[_CALL], self._times[_TIME]

    def limit(self, held: bool) -> float:
        """Return how long there may be no progress now, s; ``held``: links hold safe states."""
        code, phase = self.cells[_CALL], self.cells[_PHASE]
        start, step, end, *_ = self.limits
        if not phase:
            return end if held else math.inf
        if code and (code - 1) % len(_WORDS) in _ENDS:
            return end
        if phase == STEPS:
            return step
        return start if code or held or phase == UNNOTED else math.inf

    def entry(self, names: Sequence[str]) -> tuple[str, str]:
        """Return the component in a call and the call, with its time; two empty texts for none."""
        number, kind = divmod(self.cells[_CALL] - 1, len(_WORDS))
        if not 0 <= number < len(names):
            return "", ""
        return names[number], f"{_WORDS[kind]} at t = {self._times[_TIME]!r} s"

    @property
    def address(self) -> int:
        """Where the cells are."""
        return ctypes.addressof(ctypes.c_int64.from_buffer(self.cells))

    def traced(self, instance: Instance, number: int) -> Instance:
        """Return ``instance``, component ``number``, with its calls noted before they are made."""
        return cast(Instance, _Traced(instance, number, self))

    def _noted(self, number: int, kind: str, call: Callable[..., Any]) -> Callable[..., Any]:
        cells, code = self.cells, number * len(_WORDS) + _KINDS[kind] + 1

        def noted(*arguments: Any) -> Any:
            cells[_CALL] = code
            return call(*arguments)

        return noted

    def _read(self, number: int, call: Callable[[], Any]) -> Callable[[], Any]:
        """Return what `_noted` does, without the arguments that cost as much as the note."""
        cells, code = self.cells, number * len(_WORDS) + _KINDS["read"] + 1

        def read() -> Any:
            cells[_CALL] = code
            return call()

        return read

    def _written(self, number: int, call: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """Return the same for values that are written."""
        cells, code = self.cells, number * len(_WORDS) + _KINDS["write"] + 1

        def write(values: Any) -> Any:
            cells[_CALL] = code
            return call(values)

        return write

    def _timed(self, number: int, kind: str, call: Callable[..., Any]) -> Callable[..., Any]:
        cells, times = self.cells, self._times
        code = number * len(_WORDS) + _KINDS[kind] + 1

        def timed(t: float, h: float) -> Any:
            times[_TIME] = t
            cells[_CALL] = code
            return call(t, h)

        return timed


class _Traced:
    """An instance whose calls are noted."""

    def __init__(self, instance: Instance, number: int, trace: CallTrace) -> None:
        self._instance, self._number, self._trace = instance, number, trace
        for kind in ("set_start", "begin", "get_state", "set_state", "free_state", "terminate",
                     "free"):  # fmt: skip
            setattr(self, kind, trace._noted(number, kind, getattr(instance, kind)))
        self.initialise = trace._timed(number, "initialise", instance.initialise)
        self.step = trace._timed(number, "step", instance.step)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._instance, name)

    @property
    def marks(self) -> Marks:
        """What is noted of its calls in C."""
        codes = {call: self._number * len(_WORDS) + _KINDS[call] + 1 for call in Marks.CALLS}
        return Marks(self._trace.address, codes)

    @property
    def ended_at(self) -> float | None:
        """When the instance ended the simulation; looked at after each step."""
        return self._instance.ended_at

    def reader(self, names: Sequence[str]) -> Reader:
        bind = self._trace._noted(self._number, "reader", self._instance.reader)
        return self._trace._read(self._number, bind(names))

    def writer(self, names: Sequence[str]) -> Writer:
        bind = self._trace._noted(self._number, "writer", self._instance.writer)
        return self._trace._written(self._number, bind(names))
