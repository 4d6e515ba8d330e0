"""Base of instances with an event mode: what is set at one communication point is one event."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

from ...errors import SimulationError
from ..instance import Reader, Value, Variable, Writer
from .fmuinstance import FmuInstance
from .loaded import LoadedFmu

MOST_UPDATES = 1_000
"""Iterations of one event."""
_NEVER = object()


class State(NamedTuple):
    """The FMU's state and what of it only the importer knows."""

    handle: Any
    memory: Any


class EventfulInstance(FmuInstance):
    """An instance that is set in events, as soon as anything else is asked of it.

    Values that it was given before are no event.
    """

    def __init__(self, fmu: LoadedFmu, name: str) -> None:
        self._stepping = False
        self._waiting: list[Callable[[], None]] = []
        """Sets for the next event."""
        self._given: dict[str, Value] = {}
        """Values as last written, of what is set in events."""
        super().__init__(fmu, name)

    def get_state(self) -> Any:
        """Return a handle of the whole state."""
        self._flush()
        return State(super().get_state(), self._memory())

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""
        super().set_state(state.handle)
        self._waiting = []
        self._recall(state.memory)

    def free_state(self, state: Any) -> None:
        """Release a state's memory."""
        super().free_state(state.handle)

    # ------------------------------------------------------------------ inside

    @abstractmethod
    def _waits(self, variable: Variable) -> bool:
        """Say if a variable is set in events once the simulation runs."""

    @abstractmethod
    def _in_event(self, sets: Sequence[Callable[[], None]]) -> None:
        """Go through an event in which inputs are set."""

    def _memory(self) -> Any:
        """Return a copy of what belongs to the state and is not in the FMU."""
        return dict(self._given)

    def _recall(self, memory: Any) -> None:
        """Take back what `_memory` returned."""
        self._given = dict(memory)

    def _flush(self) -> None:
        """Set what waits for an event."""
        if self._waiting:
            waiting, self._waiting = self._waiting, []
            self._in_event(waiting)

    def _kind(self, variable: Variable) -> Any:
        """Return the type, and if setting takes an event."""
        return self._type(variable), self._waits(variable)

    def _reader(self, variables: list[Variable], kind: Any) -> Reader:
        get = self._getter(variables, kind[0])

        def read() -> list[Any]:
            if self._waiting:
                self._flush()
            return get()

        return read

    def _writer(self, variables: list[Variable], kind: Any) -> Writer:
        fmi_type, waits = kind
        put = self._setter(variables, fmi_type)
        if not waits:
            return put
        names = [variable.name for variable in variables]

        def write(values: Sequence[Any]) -> None:
            given = self._given
            if not self._stepping:
                put(values)
            elif all(given.get(n, _NEVER) == v for n, v in zip(names, values, strict=True)):
                return
            else:
                self._refuse_unfit(variables, fmi_type, values)
                self._waiting.append(partial(put, list(values)))
            given.update(zip(names, values, strict=True))

        return write

    def _endless(self, function: str) -> SimulationError:
        """Return the error of an event that does not end."""
        return SimulationError(
            f"{self.name}: an event is not over after {MOST_UPDATES} calls of {self._fmi}{function}"
        )
