"""An assembled rig: instances of its components, what they were given, and their connections."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

from ..errors import InputError, SimulationError, unknown
from ..fmi.instance import Variable, Variables
from .joining import Resolver
from .part import Part
from .paths import split_path
from .references.values import Given, from_written, placed, port_names, port_scalars
from .rig import Rig

_LOGGER = logging.getLogger("seatrial.release")

Engine = Literal["fmu", "direct", "native"]
"""Every component an FMU; in process; or an FMU in C where there is one, else in process."""

ENGINES: tuple[Engine, ...] = ("fmu", "direct", "native")


@dataclass(frozen=True)
class Connection:
    """One scalar connection; the target gets factor * value + offset."""

    source: tuple[str, str]
    target: tuple[str, str]
    factor: float = 1.0
    offset: float = 0.0
    to_real: bool = False
    """An Integer output feeds a Real input."""
    mapping: Mapping[bool | int, bool | int] = field(default_factory=dict)
    """What integers and switches become before factor and offset; others stay."""

    @property
    def scales(self) -> bool:
        """Say if a number is multiplied, moved, or made a real one on its way."""
        return self.to_real or (self.factor, self.offset) != (1.0, 0.0)

    def value(self, value: Any) -> Any:
        """Return what the target gets of a value of the source."""
        if self.mapping:
            value = self.mapping.get(value, value)
        return value * self.factor + self.offset if self.scales else value


@dataclass(frozen=True)
class Joint:
    """A connection of two ports, ``component.port`` each, as a rig or its terminals make it."""

    source: str
    target: str
    factor: float = 1.0
    offset: float = 0.0
    mapping: tuple[tuple[bool | int, ...], ...] = ()
    """Pairs of values, before and after."""


@dataclass(frozen=True)
class Bond:
    """A power bond: by scalar, the inputs of its two connections, component and variable each."""

    name: str
    pairs: tuple[tuple[tuple[str, str], tuple[str, str]], ...]


class Tuned(Protocol):
    """Tunables of a link, which start at the values of what they set."""

    @property
    def link(self) -> str:
        """Component of the link."""

    @property
    def targets(self) -> tuple[tuple[tuple[str, str], ...], ...]:
        """The parameters that each sets: component and variable."""

    def update(self, system: System) -> None:
        """Take the values over. Raises InputError."""


@dataclass
class System:
    """An assembled rig: what the master steps."""

    rig: Rig
    engine: Engine
    seed: int
    variant: str | None
    parts: dict[str, Part] = field(default_factory=dict)
    connections: list[Connection] = field(default_factory=list)
    initial: list[Connection] = field(default_factory=list)
    """Those that carry a value once, while the system is initialised: calculated parameters."""
    bonds: list[Bond] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    """The same, port by port."""
    open: list[str] = field(default_factory=list)
    """Connections whose names end in ``?`` and that were not made, with the reason."""
    left_out: list[str] = field(default_factory=list)
    """Components that nothing reads, which were taken out."""
    notes: list[str] = field(default_factory=list)
    """What the profiles do not say, and what is taken instead."""
    tunings: list[Tuned] = field(default_factory=list)
    """What lets tunables of links start at the values that their targets are given."""

    def set(self, key: str, written: Any, origin: str, folder: Path | None = None) -> None:
        """Set ``component.port`` to what a person wrote, before the run.

        Names of files are relative to ``folder``. Raises InputError for an unknown component or
        port, or a value that does not fit.
        """
        for part, port, scalars in self._settable(key, origin):
            for variable in scalars:
                self.refuse_connected(part.name, variable.name, origin)
            presets = part.presets.get(port, {})
            given = placed(written, scalars, folder)
            part.given.update(from_written(given, scalars, presets, f"{origin}: {key}"))
        self._tune(key, origin)

    def scale(self, key: str, factor: float, origin: str) -> None:
        """Multiply the number ``component.port``, as set so far, by ``factor``.

        Raises InputError for an unknown component or port, or one that holds no number.
        """
        for part, _, scalars in self._settable(key, origin):
            for variable in scalars:
                given = part.given.get(variable.name)
                value = variable.start if given is None else given.value
                if not isinstance(value, float):
                    raise InputError(f"{origin}: {key} is not a real number and cannot be scaled")
                before = "start value of the FMU" if given is None else given.origin
                part.given[variable.name] = Given(
                    value * factor, f"{origin}: {factor!r} times {before}"
                )
        self._tune(key, origin)

    @property
    def tuned(self) -> frozenset[tuple[str, str]]:
        """Parameters that tunables of links set: component and variable."""
        return frozenset(
            target for tuning in self.tunings for targets in tuning.targets for target in targets
        )

    def _tune(self, key: str, origin: str) -> None:
        try:
            for tuning in self.tunings:
                tuning.update(self)
        except InputError as error:
            raise InputError(f"{origin}: {key}: {error}") from None

    def refuse_connected(self, component: str, variable: str, origin: str) -> None:
        """Raise InputError if a connection feeds the input: a value set there would do nothing."""
        parameter = self.parts[component].instance.variables[variable].causality == "parameter"
        for connection in (*self.connections, *self.initial):
            if connection.target == (component, variable):
                source = self.parts[connection.source[0]].instance.variables[connection.source[1]]
                if parameter and source.role == "tunable":
                    return  # the link's tunable starts there
                feeder = ".".join(connection.source)
                raise InputError(
                    f"{origin}: {component}.{variable} is fed by {feeder}; a fault replaces it"
                )

    def located(self, written: str, where: str) -> list[tuple[Part, str]]:
        """Return the components and ports that a name means: a path, or what a rig inside shows.

        Of an unknown port of a known component, the component and that name. Raises InputError.
        """
        name, port = split_path(self.parts, written)
        if name in self.parts:
            return [(self.parts[name], port)]
        if name not in self.rig.top.inner:
            known = [*self.parts, *self.rig.top.inner]
            raise InputError(f"{where}: {unknown('component', name, known)}")
        group = Resolver(self.parts, self.rig.top).anywhere(written, where)
        if not group.is_port:
            members = ", ".join(f"{written}.{member}" for member in group.members)
            raise InputError(f"{where}: {written} is a terminal; its members are {members}")
        return [(self.parts[end.component], end.port) for end in group.members[""]]

    def _settable(self, key: str, origin: str) -> list[tuple[Part, str, list[Variable]]]:
        return [
            (part, port, settable(part.instance.variables, port, f"{origin}: {part.name}"))
            for part, port in self.located(key, origin)
        ]

    def feeders(self, component: str) -> dict[str, str]:
        """Return which outputs feed the inputs and parameters of a component, by their names."""
        return {
            w.target[1]: ".".join(w.source)
            for w in (*self.connections, *self.initial)
            if w.target[0] == component
        }

    def unconnected_inputs(self, *, optional: bool = False) -> list[str]:
        """Return the inputs that no connection reaches and nobody set; whole ports by their name.

        Those that are normally not connected, if ``optional``, otherwise the others.
        """
        connected = {connection.target for connection in (*self.connections, *self.initial)}
        found: dict[str, None] = {}
        for name, part in self.parts.items():
            variables = part.instance.variables
            inputs = {n for n, v in variables.items() if v.causality == "input"}
            reached = {n for n in inputs if (name, n) in connected or n in part.given}
            loose = {n for n in inputs - reached if variables[n].optional == optional}
            whole = {}
            for variable in (n for n in variables if n in loose):
                port = variables.port_of(variable)
                if port not in whole:
                    siblings = inputs.intersection(v.name for v in variables.ports.get(port, ()))
                    whole[port] = bool(siblings) and siblings <= loose
                found[f"{name}.{port if whole[port] else variable}"] = None
        return list(found)

    def leave_out(self, names: Sequence[str]) -> None:
        """Release components that feed no other, with the connections to them."""
        for name in names:
            self.parts.pop(name).instance.free()
        self.left_out += names
        self.connections = [c for c in self.connections if c.target[0] in self.parts]
        self.initial = [c for c in self.initial if c.target[0] in self.parts]
        self.bonds = [b for b in self.bonds if all(i[0] in self.parts for p in b.pairs for i in p)]
        gone = tuple(f"{name}." for name in names)
        self.joints = [joint for joint in self.joints if not joint.target.startswith(gone)]

    def refuse_wall_clock(self) -> None:
        """Raise InputError, once started, for a component that needs a run in real time."""
        for name, part in self.parts.items():
            for port in part.instance.variables.of_role("wall-clock"):
                if part.instance.reader([port])()[0]:
                    raise InputError(
                        f"{self.rig.read_from.path}: {name} lives on the wall clock: run it in "
                        "real time at factor 1, with seatrial run --real-time 1"
                    )

    def floods(self) -> Iterator[str]:
        """Return a note on every component that was brought more from outside than it took in."""
        for name, part in self.parts.items():
            for port in part.instance.variables.of_role("exceeded"):
                if steps := part.instance.reader([port])()[0]:
                    yield (
                        f"{name}: in {steps} steps a peer brought more than one takes in: "
                        "streams waited, datagrams were dropped"
                    )

    def free(self) -> None:
        """Release all instances, in their order; the rest too if the release of one raises."""
        with ExitStack() as releases:
            for part in reversed(self.parts.values()):
                releases.callback(part.instance.free)

    def discard(self) -> None:
        """Release all instances after an error, which is what counts: others are logged."""
        try:
            self.free()
        except SimulationError as error:
            _LOGGER.warning("%s", error)


def settable(variables: Variables, port: str, where: str) -> list[Variable]:
    """Return the scalars of a parameter, an input, or what has a start value in another FMU.

    Raises InputError.
    """
    scalars = port_scalars(variables, port)
    if not scalars:
        raise InputError(f"{where}: {unknown('port', port, port_names(variables))}")
    if not is_settable(scalars[0]):
        kind = scalars[0].causality
        if kind == "structuralParameter":
            raise InputError(
                f"{where}.{port} is a structural parameter, which sizes follow from: set it in the "
                "component's own table of its rig"
            )
        raise InputError(f"{where}.{port} has the causality {kind} and cannot be set")
    return scalars


def is_settable(variable: Variable) -> bool:
    """Say if a variable can be given a value before the run.

    An output or a local variable with a start value is one that its FMU starts from, a state say.
    """
    if variable.causality in ("output", "local"):
        return variable.start is not None and variable.variability != "constant"
    return variable.causality in ("parameter", "input")
