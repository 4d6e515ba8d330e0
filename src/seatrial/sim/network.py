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

from ..errors import ExcessError, SimulationError
from ..fmi.instance import Writer
from ..model.component import NS
from ..system.system import Connection, System
from .injected import Acting, Injected
from .instants import interval
from .node import Chunk, Node, Writes

Name = tuple[str, str]

_TIMES_NOMINAL = 1e3
ANY_QUANTITY = 1e20
"""Larger than any quantity in SI units: the limit of a signal that declares no nominal value."""


@dataclass
class _Loose:
    """Faults of an input or a tunable parameter that nothing feeds."""

    write: Writer
    own: Any
    """What it was set to."""
    shown: Any
    injected: Injected = field(default_factory=Injected)

    def renew(self, t_ns: int) -> None:
        """Set what it is at ``t_ns``, if that is not what it was."""
        value = self.injected.value(t_ns, self.own)
        if value != self.shown:
            self.write([value])
            self.shown = value


class Network:
    """Signals and nodes of a system. ``names[i]`` says what ``signals[i]`` is."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.names: list[Name] = []
        self.signals: list[Any] = []
        self.places: dict[Name, int] = {}
        self.nodes = {n: Node(part, every=part.every) for n, part in system.parts.items()}
        self._time_ns = 0
        self._injected: dict[int, Injected] = {}
        self._own: dict[int, Any] = {}
        """What outputs with faults are by themselves, by their places."""
        self._loose: dict[Name, _Loose] = {}
        self._sources = {connection.source for connection in system.connections}

    @property
    def time_ns(self) -> int:
        """Simulated time, ns. As it goes on, so do faults."""
        return self._time_ns

    @time_ns.setter
    def time_ns(self, t_ns: int) -> None:
        goes_on, self._time_ns = t_ns > self._time_ns, t_ns
        if goes_on and (self._injected or self._loose):
            self._renew()

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
                of_kind.sort(key=lambda w: variables[w.target[1]].reference)
                writer = node.part.instance.writer([w.target[1] for w in of_kind])
                places = [self.places[w.source] for w in of_kind]
                writes = Writes(of_kind, places, writer, [], tuple, [], lambda: self._time_ns)
                self._bind(writes)
                node.writes.append(writes)

    def _bind(self, writes: Writes) -> None:
        """Say how values are gathered, which a connection converts and which are continuous."""
        writes.gather = _gatherer(writes.places)
        connections = list(enumerate(writes.connections))
        writes.scales = [(i, one.factor, one.offset) for i, one in connections if one.scales]
        writes.mappings = [(i, one.mapping) for i, one in connections if one.mapping]
        writes.continuous = [i for i, one in connections if self._is_continuous(one)]

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
                if not -ANY_QUANTITY < sum(values) < ANY_QUANTITY:
                    self.refuse_excess(chunk, values)
                for i, limit in chunk.limits:
                    if not -limit <= values[i] <= limit:
                        self.refuse_excess(chunk, values)
            self.signals[chunk.start : chunk.stop] = values
            if self._injected:
                self._disturb(chunk.start, chunk.stop)

    def write(self, node: Node) -> None:
        """Move the current signals to a node's inputs."""
        for writes in node.writes:
            writes.write(writes.values(self.signals))

    def step(self, node: Node, t_ns: int, h_ns: int) -> None:
        """Step a node. Raises SimulationError."""
        instance = node.part.instance
        t, h = interval(t_ns, h_ns, constant=not instance.any_step)
        begun = perf_counter_ns()
        instance.step(t, h)
        node.times.add(perf_counter_ns() - begun, t_ns)

    @property
    def is_disturbed(self) -> bool:
        """Whether faults act on signals."""
        writes = self._all_writes()
        return bool(self._injected or self._loose or any(one.injected for one in writes))

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

    def refuse_excess(self, chunk: Chunk, values: Sequence[float]) -> None:
        """Raise ExcessError if one of the values is not finite or out of bounds."""
        limits = dict(chunk.limits)
        for i, value in enumerate(values):
            name = self.names[chunk.start + i]
            when = f"at t = {self.time_ns / NS!r} s"
            if not math.isfinite(value):
                raise ExcessError(f"{'.'.join(name)} is {value} {when}")
            if abs(value) > limits.get(i, ANY_QUANTITY) and name in self._sources:
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

    # ------------------------------------------------------------------ faults

    def inject(self, component: str, name: str, fault: Acting) -> None:
        """Let a fault act from now on: on an output for all its readers, or on one input.

        It comes after those that act there already. An input or tunable parameter that nothing
        feeds is set to what comes of its value.
        """
        place = self.places.get((component, name))
        if place is not None:
            self._own.setdefault(place, self.signals[place])
            self._injected.setdefault(place, Injected()).acting.append(fault)
        elif fed := self._fed(component, name):
            writes, index = fed
            writes.injected.setdefault(index, Injected()).acting.append(fault)
            writes.values(self.signals)  # it begins with what arrives now
        else:
            if (component, name) not in self._loose:
                instance = self.nodes[component].part.instance
                own = instance.reader([name])()[0]
                self._loose[component, name] = _Loose(instance.writer([name]), own, own)
            self._loose[component, name].injected.acting.append(fault)
        self._renew()

    def clear(self, key: str) -> set[str]:
        """End all that the fault ``key`` does; return the components that were set anew."""
        again = set()
        for place, injected in list(self._injected.items()):
            injected.end(key, self._time_ns)
            if not injected.acting:
                del self._injected[place]
                self.signals[place] = self._own.pop(place)
        for writes in self._all_writes():
            for index, injected in list(writes.injected.items()):
                injected.end(key, self._time_ns)
                if not injected.acting:
                    del writes.injected[index]
        for name, loose in list(self._loose.items()):
            loose.injected.end(key, self._time_ns)
            loose.renew(self._time_ns)
            again.add(name[0])
            if not loose.injected.acting:
                del self._loose[name]
        self._renew()
        return again

    def restarted(self, node: Node) -> None:
        """Begin the streams of a component that has started anew, and write its inputs."""
        for writes in node.writes:
            for injected in writes.injected.values():
                injected.restarted(None)
        for chunk in node.chunks:
            for place, own in zip(range(chunk.start, chunk.stop), chunk.read(), strict=True):
                if place in self._injected:
                    self._injected[place].restarted(own)
                    self._own[place] = own
        self.write(node)

    def set(self, component: str, names: Sequence[str], values: Sequence[Any]) -> None:
        """Set inputs and tunable parameters that nothing feeds; faults of them go on."""
        free = dict(zip(names, values, strict=True))
        for name in [name for name in names if (component, name) in self._loose]:
            loose = self._loose[component, name]
            loose.own = free.pop(name)
            loose.renew(self._time_ns)
        if free:
            self.nodes[component].part.instance.writer(list(free))(list(free.values()))

    def _fed(self, component: str, name: str) -> tuple[Writes, int] | None:
        """Return where a connected input is, None for one that is not."""
        for writes in self.nodes[component].writes:
            for index, connection in enumerate(writes.connections):
                if connection.target == (component, name):
                    return writes, index
        return None

    def _renew(self) -> None:
        for place, injected in self._injected.items():
            self.signals[place] = injected.value(self._time_ns, self._own[place])
        for loose in self._loose.values():
            loose.renew(self._time_ns)

    def _disturb(self, start: int, stop: int) -> None:
        for place, injected in self._injected.items():
            if start <= place < stop:
                self._own[place] = self.signals[place]
                self.signals[place] = injected.value(self._time_ns, self._own[place])

    def values(self, component: str, names: Sequence[str]) -> list[Any]:
        """Return current values of a component's variables, whatever their causality.

        A connected input has what arrives now, faults included.
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

    # ------------------------------------------------------------------ rollback

    def save(self) -> Any:
        """Return a copy of everything here that a step changes, and of the faults that act."""
        outputs = {place: (one, one.save()) for place, one in self._injected.items()}
        inputs = [{i: (f, f.save()) for i, f in w.injected.items()} for w in self._all_writes()]
        loose = {
            name: (one, one.own, one.shown, one.injected.save())
            for name, one in self._loose.items()
        }
        return self._time_ns, list(self.signals), dict(self._own), outputs, inputs, loose

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        self._time_ns, signals, own, outputs, inputs, loose = state
        self.signals[:] = signals
        self._own = dict(own)
        self._injected = {place: _restored(*saved) for place, saved in outputs.items()}
        for writes, saved in zip(self._all_writes(), inputs, strict=True):
            writes.injected = {i: _restored(*each) for i, each in saved.items()}
        self._loose = {}
        for name, (one, own_value, shown, faults) in loose.items():
            one.own, one.shown = own_value, shown
            one.injected.restore(faults)
            self._loose[name] = one

    def _all_writes(self) -> list[Writes]:
        return [writes for node in self.nodes.values() for writes in node.writes]

    def independent(self) -> list[list[Any]]:
        """Return, freshly read, the outputs that follow from states alone."""
        return [chunk.read() for node in self.nodes.values() for chunk in node.independent]

    def refuse_unrestored(self, before: list[list[Any]]) -> None:
        """Raise SimulationError if restored states do not give what `independent` returned."""
        chunks = [chunk for node in self.nodes.values() for chunk in node.independent]
        for chunk, values, now in zip(chunks, before, self.independent(), strict=True):
            for place, (was, value) in enumerate(zip(values, now, strict=True), chunk.start):
                if value != was:
                    component, output = self.names[place]
                    raise SimulationError(
                        f"{component} says that it can save and restore its state, but it cannot: "
                        f"{output} was {was!r} when it was saved at t = {self.time_ns / NS!r} s, "
                        f"and is {value!r} now that it has been restored"
                    )


def _restored(injected: Injected, state: Any) -> Injected:
    injected.restore(state)
    return injected


def _gatherer(places: Sequence[int]) -> Callable[[list[Any]], Sequence[Any]]:
    if len(places) == 1:
        place = places[0]
        return lambda signals: (signals[place],)
    return itemgetter(*places)


def sources_by_target(system: System) -> Mapping[Name, Name]:
    """Return which output feeds each connected input."""
    return {connection.target: connection.source for connection in system.connections}
