"""The network: signals of all components, and what reads, writes and steps them.

Every output of every component has a place in one flat list, ``signals``. Values move by one
get and one set per type and component, through arrays that are allocated once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from time import perf_counter_ns
from typing import Any

from ..component import NS
from ..errors import ExcessError, SimulationError
from ..fmi.instance import Reader, Writer
from .part import Part
from .system import Connection, System
from .timing import StepTimes

Name = tuple[str, str]

_TIMES_NOMINAL = 1e3
_ANY_QUANTITY = 1e20
"""Larger than any quantity in SI units: the limit of a signal that declares no nominal value."""


@dataclass
class Chunk:
    """Outputs of one type of one component, side by side in the network's signals."""

    start: int
    stop: int
    read: Reader
    is_real: bool
    limits: list[tuple[int, float]] = field(default_factory=list)
    """Connected outputs with a nominal value: place within the chunk, largest magnitude."""


@dataclass
class Writes:
    """Connected inputs of one type of one component."""

    connections: list[Connection]
    places: list[int]
    """Where each input's value stands: at its connection's source, or by itself if overridden."""
    write: Writer
    continuous: list[int]
    """Inputs that change continuously between two communication points."""
    gather: Callable[[list[Any]], Sequence[Any]]
    scales: list[tuple[int, float, float]]
    mappings: list[tuple[int, Mapping[Any, Any]]] = field(default_factory=list)
    biases: dict[int, Any] = field(default_factory=dict)
    """What is added to an input, once converted."""

    def values(self, signals: list[Any]) -> Sequence[Any]:
        """Return the inputs' values, converted."""
        values = self.gather(signals)
        if self.mappings:
            values = list(values)
            for i, mapping in self.mappings:
                values[i] = mapping.get(values[i], values[i])
        if self.scales or self.biases:
            values = list(values)
            for i, factor, offset in self.scales:
                values[i] = values[i] * factor + offset
            for i, bias in self.biases.items():
                values[i] = biased(values[i], bias)
        return values


@dataclass
class Node:
    """One component in the network."""

    part: Part
    chunks: list[Chunk] = field(default_factory=list)
    """All outputs."""
    reads: list[Chunk] = field(default_factory=list)
    """Outputs to read after a step: those that no feed-through visit reads anyway."""
    writes: list[Writes] = field(default_factory=list)
    written_by_visit: bool = False
    """Its last feed-through visit leaves every input as a step with held inputs needs it."""
    times: StepTimes = field(default_factory=StepTimes)
    every: int = 1
    """It steps once in so many communication steps."""

    @property
    def fed_by(self) -> set[str]:
        """The components that feed it."""
        return {one.source[0] for writes in self.writes for one in writes.connections}


@dataclass
class _Override:
    """An output with an override or a bias, and what it last was by itself."""

    value: Any
    own: Any
    is_bias: bool = False

    @property
    def read(self) -> Any:
        """What its readers get."""
        return biased(self.own, self.value) if self.is_bias else self.value


class Network:
    """Signals and nodes of a system. ``names[i]`` says what ``signals[i]`` is."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.names: list[Name] = []
        self.signals: list[Any] = []
        self.places: dict[Name, int] = {}
        self.nodes = {n: Node(part, every=part.every) for n, part in system.parts.items()}
        self.time_ns = 0
        self._overrides: dict[int, _Override] = {}
        self._sources = {connection.source for connection in system.connections}

    # ------------------------------------------------------------------ preparation

    def add_chunks(self, node: Node, outputs: Sequence[str]) -> list[Chunk]:
        """Give outputs of a node their places, those of one type side by side."""
        variables, chunks = node.part.instance.variables, []
        for kind in dict.fromkeys(variables[name].type for name in outputs):
            of_kind = [name for name in outputs if variables[name].type is kind]
            start = len(self.signals)
            for name in of_kind:
                self.places[node.part.name, name] = len(self.signals)
                self.names.append((node.part.name, name))
                self.signals.append(variables[name].first)
            reader = node.part.instance.reader(of_kind)
            chunk = Chunk(start, len(self.signals), reader, kind is float)
            for place, name in enumerate(of_kind):
                nominal = variables[name].nominal
                if chunk.is_real and nominal and (node.part.name, name) in self._sources:
                    chunk.limits.append((place, _TIMES_NOMINAL * abs(nominal)))
            chunks.append(chunk)
        node.chunks += chunks
        return chunks

    def bind_inputs(self) -> None:
        """Bind the connections of every node, once all outputs have their places."""
        of_target: dict[str, list[Connection]] = {name: [] for name in self.nodes}
        for connection in self.system.connections:
            of_target[connection.target[0]].append(connection)
        for name, connections in of_target.items():
            node, variables = self.nodes[name], self.system.parts[name].instance.variables
            for kind in dict.fromkeys(variables[w.target[1]].type for w in connections):
                of_kind = [w for w in connections if variables[w.target[1]].type is kind]
                writer = node.part.instance.writer([w.target[1] for w in of_kind])
                writes = Writes(
                    of_kind, [self.places[w.source] for w in of_kind], writer, [], tuple, []
                )
                self._bind(writes)
                node.writes.append(writes)

    def _bind(self, writes: Writes) -> None:
        """Say how values are gathered, which a connection converts and which are continuous."""
        writes.gather = _gatherer(writes.places)
        connected = [
            (i, connection)
            for i, connection in enumerate(writes.connections)
            if writes.places[i] == self.places[connection.source]
        ]
        # An integer becomes a real number on its way, an overridden input has its unit already.
        writes.scales = [
            (i, connection.factor, connection.offset)
            for i, connection in connected
            if connection.scales
        ]
        writes.mappings = [(i, one.mapping) for i, one in connected if one.mapping]
        writes.continuous = [i for i, connection in connected if self._is_continuous(connection)]

    def _is_continuous(self, connection: Connection) -> bool:
        ends = [
            self.system.parts[part].instance.variables[n]
            for part, n in (connection.source, connection.target)
        ]
        return all(end.type is float and end.variability == "continuous" for end in ends)

    # ------------------------------------------------------------------ running

    def read(self, chunks: Sequence[Chunk]) -> None:
        """Read outputs. Raises ExcessError for one that is not finite or out of bounds."""
        for chunk in chunks:
            values = chunk.read()
            if chunk.is_real:
                if not -_ANY_QUANTITY < sum(values) < _ANY_QUANTITY:
                    self._refuse_excess(chunk, values)
                for i, limit in chunk.limits:
                    if not -limit <= values[i] <= limit:
                        self._refuse_excess(chunk, values)
            self.signals[chunk.start : chunk.stop] = values
            if self._overrides:
                self._keep_overridden(chunk.start, chunk.stop)

    def write(self, node: Node) -> None:
        """Move the current signals to a node's inputs."""
        for writes in node.writes:
            writes.write(writes.values(self.signals))

    def step(self, node: Node, t_ns: int, h_ns: int) -> None:
        """Step a node. Raises SimulationError."""
        begun = perf_counter_ns()
        node.part.instance.step(t_ns / NS, h_ns / NS)
        node.times.add(perf_counter_ns() - begun, t_ns)

    def nominal(self, name: Name) -> float:
        """Return an output's nominal value, 1 where none is declared."""
        return abs(self.system.parts[name[0]].instance.variables[name[1]].nominal or 1.0)

    def targets(self, source: Name) -> str:
        """Return which inputs an output feeds, for messages."""
        ends = [
            ".".join(connection.target)
            for connection in self.system.connections
            if connection.source == source
        ]
        return f"the connection {'.'.join(source)} -> {', '.join(ends)}"

    def _refuse_excess(self, chunk: Chunk, values: Sequence[float]) -> None:
        limits = dict(chunk.limits)
        for i, value in enumerate(values):
            name = self.names[chunk.start + i]
            when = f"at t = {self.time_ns / NS!r} s"
            if not math.isfinite(value):
                raise ExcessError(f"{'.'.join(name)} is {value} {when}")
            if abs(value) > limits.get(i, _ANY_QUANTITY) and name in self._sources:
                nominal = limits[i] / _TIMES_NOMINAL if i in limits else None
                excess = (
                    f"more than 1000 times its nominal value {nominal!r}"
                    if nominal is not None
                    else "beyond any quantity"
                )
                raise ExcessError(
                    f"the coupling diverges {when}: {self.targets(name)} carries {value:.6g}, "
                    f"{excess}; a smaller step, another algorithm or another cut of the system "
                    "is needed"
                )

    # ------------------------------------------------------------------ overrides

    def override(self, component: str, name: str, value: Any, *, is_bias: bool = False) -> None:
        """Replace an output for all its readers, or one connected input; None ends that.

        A bias is added instead. Either ends the other.
        """
        if (component, name) in self.places:
            place = self.places[component, name]
            own = (
                self._overrides.pop(place).own if place in self._overrides else self.signals[place]
            )
            self.signals[place] = own
            if value is not None:
                self._overrides[place] = _Override(value, own, is_bias)
                self.signals[place] = self._overrides[place].read
            return
        for writes in self.nodes[component].writes:
            for index, connection in enumerate(writes.connections):
                if connection.target == (component, name):
                    writes.places[index] = self.places[connection.source]
                    writes.biases.pop(index, None)
                    if is_bias and value is not None:
                        writes.biases[index] = value
                    elif value is not None:
                        writes.places[index] = len(self.signals)
                        self.signals.append(value)
            self._bind(writes)

    def _keep_overridden(self, start: int, stop: int) -> None:
        for place, override in self._overrides.items():
            if start <= place < stop:
                override.own = self.signals[place]
                self.signals[place] = override.read

    def values(self, component: str, names: Sequence[str]) -> list[Any]:
        """Return current values of a component's variables, whatever their causality.

        A connected input has what arrives now, overrides included.
        """
        arriving = {
            connection.target[1]: value
            for writes in self.nodes[component].writes
            if any(connection.target[1] in names for connection in writes.connections)
            for connection, value in zip(
                writes.connections, writes.values(self.signals), strict=True
            )
        }
        instance, found = self.system.parts[component].instance, []
        for name in names:
            if (component, name) in self.places:
                found.append(self.signals[self.places[component, name]])
            elif name in arriving:
                found.append(arriving[name])
            else:
                found.append(instance.reader([name])()[0])
        return found

    def save_overrides(self) -> Any:
        """Return which overrides there are, for `restore_overrides`."""
        inputs = [
            (list(w.places), dict(w.biases)) for node in self.nodes.values() for w in node.writes
        ]
        outputs = {place: (one.value, one.is_bias) for place, one in self._overrides.items()}
        return outputs, inputs

    def restore_overrides(self, memory: Any) -> None:
        """Restore what `save_overrides` returned, before `restore` of the same instant."""
        outputs, inputs = memory
        self._overrides = {
            place: _Override(value, None, is_bias) for place, (value, is_bias) in outputs.items()
        }
        writes = [w for node in self.nodes.values() for w in node.writes]
        for one, (places, biases) in zip(writes, inputs, strict=True):
            one.biases = dict(biases)
            if one.places != places:
                one.places = list(places)
                self._bind(one)

    # ------------------------------------------------------------------ rollback

    def save(self) -> Any:
        """Return a copy of everything here that a step changes."""
        overrides = {place: override.own for place, override in self._overrides.items()}
        return self.time_ns, list(self.signals), overrides

    def restore(self, state: Any) -> None:
        """Restore what `save` returned; no override may have come or gone since."""
        self.time_ns, signals, overrides = state
        self.signals[:] = signals
        for place, own in overrides.items():
            self._overrides[place].own = own

    def independent(self) -> list[list[Any]]:
        """Return, freshly read, the outputs that follow from states alone."""
        return [chunk.read() for node in self.nodes.values() for chunk in node.reads]

    def refuse_unrestored(self, before: list[list[Any]]) -> None:
        """Raise SimulationError if restored states do not give what `independent` returned."""
        chunks = [chunk for node in self.nodes.values() for chunk in node.reads]
        for chunk, values, now in zip(chunks, before, self.independent(), strict=True):
            for place, (was, value) in enumerate(zip(values, now, strict=True), chunk.start):
                if value != was:
                    component, output = self.names[place]
                    raise SimulationError(
                        f"{component} says that it can save and restore its state, but it cannot: "
                        f"{output} was {was!r} when it was saved at t = {self.time_ns / NS!r} s, "
                        f"and is {value!r} now that it has been restored"
                    )


def biased(value: Any, bias: Any) -> Any:
    """Return a value with a bias, of the value's type: of truth values, whether one is true."""
    return type(value)(value + bias)


def _gatherer(places: Sequence[int]) -> Callable[[list[Any]], Sequence[Any]]:
    if len(places) == 1:
        place = places[0]
        return lambda signals: (signals[place],)
    return itemgetter(*places)


def sources_by_target(system: System) -> Mapping[Name, Name]:
    """Return which output feeds each connected input."""
    return {connection.target: connection.source for connection in system.connections}
