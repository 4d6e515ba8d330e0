"""CallTrace of a run, in memory that two processes share: the call it is in, and orders to stop."""

from __future__ import annotations

import ctypes
import mmap
from collections.abc import Callable, Sequence
from typing import Any, cast

from ..cosim.compiled.marks import Marks
from ..fmi.instance import Instance, Reader, Writer

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
_ASKED, _CALL, _TIME = range(3)


class CallTrace:
    """Cells that a dead process leaves behind: no call costs more than a store or two."""

    def __init__(self) -> None:
        memory = memoryview(mmap.mmap(-1, mmap.PAGESIZE))
        self.cells, self._times = memory.cast("q"), memory.cast("d")

    @property
    def asked(self) -> int:
        """How urgently a stop is requested: 1 after the step, 2 at once."""
        return self.cells[_ASKED]

    @asked.setter
    def asked(self, level: int) -> None:
        self.cells[_ASKED] = level

    def between_calls(self) -> int:
        """Note that no component is in a call, and return how urgently a stop is requested."""
        cells = self.cells
        cells[_CALL] = 0
        return cells[_ASKED]

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
