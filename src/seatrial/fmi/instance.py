"""What the master sees of a component, whichever way it runs: an instance and its variables."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from ..ports import Scalar

Reader = Callable[[], list[Any]]
Writer = Callable[[Sequence[Any]], None]


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU, as its model description has it."""

    name: str
    causality: str
    """parameter, calculatedParameter, input, output, local or independent."""
    variability: str
    type: type
    """float, int, bool or str."""
    reference: int
    unit: str
    """Empty if the FMU says none."""
    start: Scalar | None
    minimum: float | None
    maximum: float | None
    nominal: float | None
    description: str


class Instance(Protocol):
    """A running component: an FMU or a component in process, stepped by the master.

    Call order: `set_start` as often as needed, `initialise`, reads and writes, `begin`, then
    steps with reads and writes in between, `terminate`, `free`. Every method raises
    SimulationError, naming the instance and what it said, when the component refuses.
    """

    @property
    def name(self) -> str:
        """Name in the rig."""

    @property
    def variables(self) -> Mapping[str, Variable]:
        """Variables by name."""

    @property
    def rolls_back(self) -> bool:
        """Whether its whole state can be saved and restored."""

    @property
    def any_step(self) -> bool:
        """Whether it takes steps of different lengths."""

    @property
    def feedthrough(self) -> Mapping[str, Sequence[str]]:
        """Per output, the inputs that act on it at the same instant."""

    def set_start(self, values: Mapping[str, Scalar]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``; outputs can be read and inputs written from now on."""

    def begin(self) -> None:
        """End the initialisation."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a fast callable that returns the values of ``names``, in that order."""

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a fast callable that sets ``names`` to a sequence of values."""

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s. Raises DiscardError if a smaller step may do."""

    def get_state(self) -> Any:
        """Return a handle of the whole state."""

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""

    def free_state(self, state: Any) -> None:
        """Release a handle."""

    def terminate(self) -> None:
        """End the run."""

    def free(self) -> None:
        """Release everything; the instance cannot be used afterwards."""


class ByType(ABC):
    """Reads and writes variables of any types with calls that take one type each, as in FMI."""

    variables: Mapping[str, Variable]

    @abstractmethod
    def _reader(self, references: list[int], kind: type) -> Reader:
        """Return a reader of variables of one type, by value reference."""

    @abstractmethod
    def _writer(self, references: list[int], kind: type) -> Writer:
        """Return a writer of variables of one type, by value reference."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        groups = self._groups(names)
        parts = [(places, self._reader(refs, kind)) for kind, (places, refs) in groups.items()]
        if len(parts) == 1:
            return parts[0][1]

        def read() -> list[Any]:
            values: list[Any] = [None] * len(names)
            for places, part in parts:
                for place, value in zip(places, part(), strict=True):
                    values[place] = value
            return values

        return read

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a callable that sets ``names`` to a sequence of values."""
        groups = self._groups(names)
        parts = [(places, self._writer(refs, kind)) for kind, (places, refs) in groups.items()]
        if len(parts) == 1:
            return parts[0][1]

        def write(values: Sequence[Any]) -> None:
            for places, part in parts:
                part([values[p] for p in places])

        return write

    def _groups(self, names: Sequence[str]) -> dict[type, tuple[list[int], list[int]]]:
        """Return, per type, the places in ``names`` and the value references."""
        groups: dict[type, tuple[list[int], list[int]]] = {}
        for place, name in enumerate(names):
            variable = self.variables[name]
            places, references = groups.setdefault(variable.type, ([], []))
            places.append(place)
            references.append(variable.reference)
        return groups
