"""Interface of the master to a component, whichever way it runs: instance and variables."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Protocol

from ..model.ports import Scalar
from ..model.terminals import Terminal
from ..model.units import Unit

Value = Scalar | bytes
"""Of a signal: a component has numbers and text, other people's FMUs bytes too."""
Reader = Callable[[], list[Any]]
Writer = Callable[[Sequence[Any]], None]


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable of an FMU, or one element of an array, as its description has it."""

    name: str
    """An element's name has its indices, from one: ``x[1]``, ``m[2,3]``."""
    causality: str
    """parameter, calculatedParameter, structuralParameter, input, output, local, independent."""
    variability: str
    type: type
    """float, int, bool, str or bytes."""
    reference: int
    """Negative: the FMU has no such variable; it is a port made here of a bus terminal."""
    unit: str
    """Empty if the FMU says none."""
    start: Value | None
    minimum: float | None
    maximum: float | None
    nominal: float | None
    description: str
    definition: Unit | None = None
    """The unit as the FMU defines it, where its name alone does not say that."""
    integers: tuple[int, int] = (-(2**31), 2**31 - 1)
    """Least and greatest value that an integer of its FMI type holds."""
    items: Mapping[str, int] = field(default_factory=dict)
    """Names and values of an enumeration."""
    element: int = 0
    """Place in its array, row by row."""
    array: str = ""
    """Name of its array, if its own has no indices: in our FMUs of FMI 3.0 axes have names."""
    negated: bool = False
    """In FMI 1.0: what its value reference has is the negative of it."""
    optional: bool = False
    """An input that is normally not connected."""
    frame: str = ""
    """Frame of its axes, of `ports.FRAMES`; empty: none is known."""
    term_of: str = ""
    """Name of the sum that the input is a term of."""
    role: str = ""
    """What whoever runs the component does with it, of `ports.ROLES`; empty: nothing special."""

    @property
    def measure(self) -> Unit | str:
        """The unit to convert from and to."""
        return self.definition or self.unit or "1"

    @property
    def indexed(self) -> str:
        """The name by which other tools know it."""
        return f"{self.array}[{self.element + 1}]" if self.array else self.name

    @property
    def first(self) -> Value:
        """What stands for its value before there is one: the start value, else zero."""
        zero: Value = self.type()
        return zero if self.start is None else self.start

    @property
    def is_made(self) -> bool:
        """Whether it is a port made here, which other tools do not find in the FMU."""
        return self.reference < 0


class Variables(dict[str, Variable]):
    """Variables by name, and by port: what their structured names have in common."""

    @cached_property
    def ports(self) -> dict[str, list[Variable]]:
        """Variables by port: ``force`` has ``force.x`` and so on, ``x`` has ``x[1]`` and so on.

        In the order of declaration, but elements of an array by their indices.
        """
        ports: dict[str, list[Variable]] = {}
        for name, variable in self.items():
            for mark in _SEPARATOR.finditer(name):
                ports.setdefault(name[: mark.start()], []).append(variable)
        for port, variables in ports.items():
            indices = [_INDICES.fullmatch(v.name, len(port)) for v in variables]
            if all(indices):
                order = {v.name: _numbers(i) for v, i in zip(variables, indices, strict=True)}
                variables.sort(key=lambda v: order[v.name])
        return ports

    def of_role(self, role: str) -> list[str]:
        """Return the names of the variables that declare a role of `ports.ROLES`."""
        return [name for name, variable in self.items() if variable.role == role]

    @cached_property
    def terms(self) -> dict[str, list[str]]:
        """Inputs (ports) that are terms of one sum, in order, by the name of the sum."""
        found: dict[str, dict[str, None]] = {}
        for name, variable in self.items():
            if variable.term_of:
                found.setdefault(variable.term_of, {})[self.port_of(name) or name] = None
        return {sum_: list(ports) for sum_, ports in found.items()}

    @staticmethod
    def port_of(name: str) -> str:
        """Return the port that a variable belongs to directly, empty for a port of its own."""
        return name[: max((mark.start() for mark in _SEPARATOR.finditer(name)), default=0)]


_SEPARATOR = re.compile(r"(?<=.)[.\[]")
_INDICES = re.compile(r"\[(\d+(?:,\d+)*)\]")


def _numbers(indices: re.Match[str] | None) -> tuple[int, ...]:
    return tuple(int(i) for i in indices[1].split(",")) if indices else ()


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
    def variables(self) -> Variables:
        """Variables by name."""

    @property
    def rolls_back(self) -> bool:
        """Whether its whole state can be saved and restored."""

    @property
    def any_step(self) -> bool:
        """Whether it takes steps of different lengths."""

    @property
    def restarts(self) -> bool:
        """Whether `reset` can take it back to before its initialisation."""

    @property
    def at_once(self) -> bool:
        """Whether `initialise` is all of its initialisation: inputs are written before it."""

    @property
    def ended_at(self) -> float | None:
        """Time at which it asked to end the simulation, s; None: it did not.

        It stands there: outputs can be read, steps do nothing.
        """

    @property
    def feedthrough(self) -> Mapping[str, Sequence[str]]:
        """Per output, the inputs that act on it at the same instant."""

    @property
    def terminals(self) -> Mapping[str, Terminal]:
        """Groups of variables that are connected together."""

    @property
    def views(self) -> Mapping[str, Mapping[str, str]]:
        """What reports draw of it: ports by kind of view, of `ports.VIEWS`."""

    def set_start(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values by variable name, before `initialise`."""

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Start at ``start_time``; outputs can be read and inputs written from now on.

        A ``stop_time`` of infinity is none.
        """

    def begin(self) -> None:
        """End the initialisation."""

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a fast callable that returns the values of ``names``, in that order."""

    def writer(self, names: Sequence[str]) -> Writer:
        """Return a fast callable that sets ``names`` to a sequence of values."""

    def step(self, t: float, h: float) -> None:
        """Advance from ``t`` to ``t + h``, s. Raises DiscardError if a smaller step may do."""

    def goes_back(self, may: bool) -> None:
        """Say whether a state of before the next step may be restored after it; none may at first.

        FMUs are given that with each step (``noSetFMUStatePriorToCurrentPoint``).
        """

    def get_state(self) -> Any:
        """Return a handle of the whole state."""

    def set_state(self, state: Any) -> None:
        """Restore a state; the handle stays valid."""

    def free_state(self, state: Any) -> None:
        """Release a handle."""

    def reset(self) -> None:
        """Return to before `set_start`, as a program that is started anew."""

    def terminate(self) -> None:
        """End the run."""

    def free(self) -> None:
        """Release everything; the instance cannot be used afterwards."""


class ByType(ABC):
    """Reads and writes variables of any types with calls that take one type each, as in FMI."""

    variables: Variables

    @abstractmethod
    def _reader(self, variables: list[Variable], kind: Any) -> Reader:
        """Return a reader of variables of one type."""

    @abstractmethod
    def _writer(self, variables: list[Variable], kind: Any) -> Writer:
        """Return a writer of variables of one type."""

    def goes_back(self, may: bool) -> None:  # noqa: B027  many need not know
        """Say whether a state of before the next step may be restored after it."""

    def _kind(self, variable: Variable) -> Any:
        """Return what variables have in common that one call reads or writes."""
        return variable.type

    def reader(self, names: Sequence[str]) -> Reader:
        """Return a callable that returns the values of ``names``, in that order."""
        groups = self._groups(names)
        parts = [(places, self._reader(group, kind)) for kind, (places, group) in groups.items()]
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
        parts = [(places, self._writer(group, kind)) for kind, (places, group) in groups.items()]
        if len(parts) == 1:
            return parts[0][1]

        def write(values: Sequence[Any]) -> None:
            for places, part in parts:
                part([values[p] for p in places])

        return write

    def _groups(self, names: Sequence[str]) -> dict[Any, tuple[list[int], list[Variable]]]:
        """Return, per kind, the places in ``names`` and the variables."""
        groups: dict[Any, tuple[list[int], list[Variable]]] = {}
        for place, name in enumerate(names):
            variable = self.variables[name]
            places, variables = groups.setdefault(self._kind(variable), ([], []))
            places.append(place)
            variables.append(variable)
        return groups
