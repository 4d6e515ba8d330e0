"""An assembled rig: instances of its components, what they were given, and their connections."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from ..errors import InputError, unknown
from ..fmi.instance import Instance, Variable, Variables
from .parameters import Outline
from .rig import Rig
from .values import Given, from_written, port_names, port_scalars

Engine = Literal["fmu", "direct"]


@dataclass
class Part:
    """One component of an assembled rig."""

    name: str
    fmu: str
    instance: Instance
    sha256: str
    """Of the FMU file; empty in process."""
    code: str
    """Name and hash of the code, equal in both carriers; empty for a file of somebody else."""
    every: int
    """It steps once in so many communication steps."""
    given: dict[str, Given] = field(default_factory=dict)
    """Values set by the rig's user, by variable name; the others keep the FMU's start values."""
    outline: Outline | None = None
    """Of the vehicle whose parameters it has, if its file has one."""
    presets: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True)
class Connection:
    """One scalar connection; the target gets factor * value + offset."""

    source: tuple[str, str]
    target: tuple[str, str]
    factor: float = 1.0
    offset: float = 0.0
    to_real: bool = False
    """An Integer output feeds a Real input."""

    @property
    def converts(self) -> bool:
        """Say if a value changes on its way."""
        return self.to_real or (self.factor, self.offset) != (1.0, 0.0)


@dataclass
class System:
    """An assembled rig: what the master steps."""

    rig: Rig
    engine: Engine
    seed: int
    variant: str | None
    parts: dict[str, Part]
    connections: list[Connection]

    def set(self, key: str, written: Any, origin: str) -> None:
        """Set ``component.port`` to what a person wrote, before the run.

        Raises InputError for an unknown component or port, or a value that does not fit.
        """
        part, scalars = self._settable(key, origin)
        for variable in scalars:
            self.refuse_connected(part.name, variable.name, origin)
        presets = part.presets.get(key.partition(".")[2], {})
        part.given.update(from_written(written, scalars, presets, f"{origin}: {key}"))

    def scale(self, key: str, factor: float, origin: str) -> None:
        """Multiply the number ``component.port``, as set so far, by ``factor``.

        Raises InputError for an unknown component or port, or one that holds no number.
        """
        part, scalars = self._settable(key, origin)
        for variable in scalars:
            given = part.given.get(variable.name)
            value = variable.start if given is None else given.value
            if not isinstance(value, float):
                raise InputError(f"{origin}: {key} is not a real number and cannot be scaled")
            before = "start value of the FMU" if given is None else given.origin
            part.given[variable.name] = Given(
                value * factor, f"{origin}: {factor!r} times {before}"
            )

    def refuse_connected(self, component: str, variable: str, origin: str) -> None:
        """Raise InputError if a connection feeds the input: a value set there would do nothing."""
        for connection in self.connections:
            if connection.target == (component, variable):
                feeder = ".".join(connection.source)
                raise InputError(
                    f"{origin}: {component}.{variable} is fed by {feeder}; override it in an event"
                )

    def _settable(self, key: str, origin: str) -> tuple[Part, list[Variable]]:
        name, _, port = key.partition(".")
        if name not in self.parts:
            raise InputError(f"{origin}: {unknown('component', name, self.parts)}")
        part = self.parts[name]
        return part, settable(part.instance.variables, port, f"{origin}: {name}")

    def feeders(self, component: str) -> dict[str, str]:
        """Return which outputs feed the inputs and parameters of a component, by their names."""
        return {
            w.target[1]: ".".join(w.source) for w in self.connections if w.target[0] == component
        }

    def unconnected_inputs(self) -> list[str]:
        """Return the inputs that no connection reaches and nobody set; whole ports by their name.

        Optional ones are not among them.
        """
        connected = {connection.target for connection in self.connections}
        found: dict[str, None] = {}
        for name, part in self.parts.items():
            variables = part.instance.variables
            inputs = {n for n, v in variables.items() if v.causality == "input"}
            reached = {n for n in inputs if (name, n) in connected or n in part.given}
            loose = {n for n in inputs - reached if not variables[n].optional}
            whole = {}
            for variable in (n for n in variables if n in loose):
                port = variables.port_of(variable)
                if port not in whole:
                    siblings = inputs.intersection(v.name for v in variables.ports.get(port, ()))
                    whole[port] = bool(siblings) and siblings <= loose
                found[f"{name}.{port if whole[port] else variable}"] = None
        return list(found)

    def free(self) -> None:
        """Release all instances."""
        for part in self.parts.values():
            part.instance.free()


def settable(variables: Variables, port: str, where: str) -> list[Variable]:
    """Return the scalars of a parameter or input port. Raises InputError."""
    scalars = port_scalars(variables, port)
    if not scalars:
        raise InputError(f"{where}: {unknown('port', port, port_names(variables))}")
    if scalars[0].causality not in ("parameter", "input"):
        kind = scalars[0].causality
        raise InputError(f"{where}.{port} has the causality {kind} and cannot be set")
    return scalars
