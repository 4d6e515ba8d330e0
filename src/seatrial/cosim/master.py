"""The master: steps instances, moves values along wires, and knows nothing of boats.

Time is a whole number of nanoseconds. At each communication point the values that are valid
there are moved, feed-through outputs are read again in dependency order (so that a controller
adds no hidden delay), then every instance steps with its inputs held (Jacobi). With
``plain-jacobi`` nothing is read again, as in libcosim and ecos: one step of delay per hop.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from operator import itemgetter
from typing import Any

from ..component import seconds
from ..errors import SimulationError
from ..fmi.instance import Reader, Writer
from .order import loops_on_itself, ordered_groups
from .system import Part, System, Wire

Name = tuple[str, str]

_LOOP_TOLERANCE = 1e-12
_LOOP_ITERATIONS = 200


@dataclass
class _Chunk:
    """Outputs of one type of one instance, side by side in the master's signals."""

    start: int
    stop: int
    read: Reader
    is_real: bool


@dataclass
class _Writes:
    """Connected inputs of one type of one instance."""

    wires: list[Wire]
    places: list[int]
    """Where each input's value stands: at its wire's source, or by itself if overridden."""
    write: Writer
    scales: list[tuple[int, float, float]] = field(default_factory=list)
    gather: Any = None

    def bind(self, places: Mapping[Name, int]) -> None:
        """Say how values are gathered and which of them a wire converts."""
        self.gather = _gatherer(self.places)
        # An integer becomes a real number on its way, an overridden input has its unit already.
        self.scales = [
            (i, wire.factor, wire.offset)
            for i, wire in enumerate(self.wires)
            if wire.converts and self.places[i] == places[wire.source]
        ]


@dataclass
class _Node:
    part: Part
    h: float
    chunks: list[_Chunk] = field(default_factory=list)
    """All outputs."""
    reads: list[_Chunk] = field(default_factory=list)
    """Outputs to read after a step: those that no visit reads anyway."""
    writes: list[_Writes] = field(default_factory=list)
    written_by_visit: bool = False
    """Its last visit leaves every input as the step needs it."""


@dataclass
class _Visit:
    """Feed-through outputs to read once the inputs they depend on were moved."""

    node: _Node
    chunks: list[_Chunk]


@dataclass
class _Group:
    """Visits that belong together: of one instance, or of all instances of a loop."""

    outputs: list[Name]
    is_loop: bool
    visits: list[_Visit] = field(default_factory=list)


@dataclass
class _Pin:
    """An overridden output: what its readers get, and what it last was by itself."""

    value: Any
    own: Any


class Master:
    """Runs an assembled system.

    ``signals`` holds the current value of every output; ``names`` says which is which. A value
    is valid at ``time``.
    """

    def __init__(self, system: System, start_ns: int = 0, stop_ns: int = 0) -> None:
        self.system = system
        self.algorithm = system.rig.file.algorithm
        self.step_ns = system.rig.step_ns
        self.start_ns, self.stop_ns = start_ns, stop_ns
        self.steps = 0
        self.names: list[Name] = []
        self.signals: list[Any] = []
        self._pins: dict[int, _Pin] = {}
        self._nodes: dict[str, _Node] = {}
        self._places: dict[Name, int] = {}
        self._groups: list[_Group] = []

    @property
    def time_ns(self) -> int:
        """Simulated time, ns."""
        return self.start_ns + self.steps * self.step_ns

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return seconds(self.time_ns)

    def initialise(self) -> None:
        """Set parameters, start every instance and solve the wires at the start time.

        Raises SimulationError if an instance refuses or a feed-through loop has no solution.
        """
        parts = self.system.parts.values()
        for part in parts:
            part.instance.set_start({name: given.value for name, given in part.given.items()})
        for part in parts:
            part.instance.initialise(seconds(self.start_ns), seconds(self.stop_ns))
        self._groups = self._feedthrough_groups()
        self._prepare()
        self._settle()
        for part in parts:
            part.instance.begin()
        self._settle()
        if self.algorithm == "plain-jacobi":
            self._groups = []
            for node in self._nodes.values():
                node.reads, node.written_by_visit = node.chunks, False

    def step(self) -> None:
        """Advance everything by one communication step. Raises SimulationError."""
        nodes, t, k = self._nodes.values(), self.time, self.steps
        for node in nodes:
            if k % node.part.every == 0:
                if not node.written_by_visit:
                    self._write(node)
                node.part.instance.step(t, node.h)
        self.steps = k = k + 1
        for node in nodes:
            if k % node.part.every == 0:
                self._read(node.reads)
        self._propagate()

    def set(self, component: str, names: Sequence[str], values: Sequence[Any]) -> None:
        """Set tunable parameters or unconnected inputs now; outputs follow at once.

        With plain Jacobi they follow after the next step. Raises SimulationError.
        """
        node = self._nodes[component]
        node.part.instance.writer(names)(values)
        if self.algorithm == "jacobi" and self.steps % node.part.every == 0:
            self._read(node.chunks)
            self._propagate()

    def override(self, component: str, name: str, value: Any) -> None:
        """Replace an output for all its readers, or one connected input, until `release`."""
        self._pin(component, name, value)
        self._propagate()

    def release(self, component: str, name: str) -> None:
        """End an override: the wire carries its own value again."""
        self._pin(component, name, None)
        self._propagate()

    def terminate(self) -> None:
        """Tell every instance that the run has ended. Raises SimulationError."""
        for part in self.system.parts.values():
            part.instance.terminate()

    # ------------------------------------------------------------------ preparation

    def _prepare(self) -> None:
        """Lay out the signals, and bind what reads and writes them."""
        visited = {name for group in self._groups for name in group.outputs}
        for name, part in self.system.parts.items():
            node = self._nodes[name] = _Node(part, seconds(part.every * self.step_ns))
            outputs = [v.name for v in part.instance.variables.values() if v.causality == "output"]
            node.reads = self._chunks(node, [n for n in outputs if (name, n) not in visited])
        for group in self._groups:
            for component in dict.fromkeys(component for component, _ in group.outputs):
                node = self._nodes[component]
                chunks = self._chunks(node, [n for c, n in group.outputs if c == component])
                group.visits.append(_Visit(node, chunks))
        for name, node in self._nodes.items():
            self._prepare_writes(name, node)
            node.written_by_visit = self._visit_writes_all(node)

    def _chunks(self, node: _Node, outputs: Sequence[str]) -> list[_Chunk]:
        """Give outputs of a node their places, those of one type side by side."""
        variables, chunks = node.part.instance.variables, []
        for kind in dict.fromkeys(variables[name].type for name in outputs):
            of_kind = [name for name in outputs if variables[name].type is kind]
            start = len(self.signals)
            for name in of_kind:
                self._places[node.part.name, name] = len(self.signals)
                self.names.append((node.part.name, name))
                self.signals.append(None)
            reader = node.part.instance.reader(of_kind)
            chunks.append(_Chunk(start, len(self.signals), reader, kind is float))
        node.chunks += chunks
        return chunks

    def _visit_writes_all(self, node: _Node) -> bool:
        """Say if everything that feeds a node is final when its last visit writes its inputs."""
        turns = [i for i, g in enumerate(self._groups) if any(v.node is node for v in g.visits)]
        if not turns or self._groups[turns[-1]].is_loop:
            return False
        read_in = {name: i for i, group in enumerate(self._groups) for name in group.outputs}
        sources = [wire.source for writes in node.writes for wire in writes.wires]
        return all(read_in.get(source, -1) < turns[-1] for source in sources)

    def _prepare_writes(self, name: str, node: _Node) -> None:
        variables = node.part.instance.variables
        wires = [w for w in self.system.wires if w.target[0] == name]
        for kind in dict.fromkeys(variables[w.target[1]].type for w in wires):
            of_kind = [w for w in wires if variables[w.target[1]].type is kind]
            writer = node.part.instance.writer([w.target[1] for w in of_kind])
            writes = _Writes(of_kind, [self._places[w.source] for w in of_kind], writer)
            writes.bind(self._places)
            node.writes.append(writes)

    def _feedthrough_groups(self) -> list[_Group]:
        """Return the outputs to visit, in dependency order."""
        source_of = {wire.target: wire.source for wire in self.system.wires}
        depends: dict[Name, list[Name]] = {}
        for name, part in self.system.parts.items():
            for output, inputs in part.instance.feedthrough.items():
                sources = [source_of[name, i] for i in inputs if (name, i) in source_of]
                if sources:
                    depends[name, output] = sources
        groups = [g for g in ordered_groups(depends) if any(n in depends for n in g)]
        return [
            _Group([name for name in group if name in depends], is_loop)
            for group, is_loop in _scheduled(groups, depends)
        ]

    # ------------------------------------------------------------------ running

    def _settle(self) -> None:
        for node in self._nodes.values():
            self._read(node.chunks)
        self._propagate()
        for node in self._nodes.values():
            self._write(node)
            self._read(node.chunks)

    def _propagate(self) -> None:
        for group in self._groups:
            if group.is_loop:
                self._solve(group)
            else:
                for visit in group.visits:
                    self._visit(visit)

    def _visit(self, visit: _Visit) -> None:
        if self.steps % visit.node.part.every == 0:
            self._write(visit.node)
            self._read(visit.chunks)

    def _solve(self, group: _Group) -> None:
        """Fixed-point iteration over a feed-through loop."""
        places = [self._places[name] for name in group.outputs]
        for _ in range(_LOOP_ITERATIONS):
            before = [self.signals[p] for p in places]
            for visit in group.visits:
                self._visit(visit)
            if all(_close(a, self.signals[p]) for a, p in zip(before, places, strict=True)):
                return
        names = ", ".join(".".join(self.names[p]) for p in places)
        raise SimulationError(
            f"at t = {self.time!r} s the loop through {names} does not settle within "
            f"{_LOOP_ITERATIONS} iterations; break it with a component that has a state"
        )

    def _write(self, node: _Node) -> None:
        for writes in node.writes:
            values = writes.gather(self.signals)
            if writes.scales:
                values = list(values)
                for i, factor, offset in writes.scales:
                    values[i] = values[i] * factor + offset
            writes.write(values)

    def _read(self, chunks: Sequence[_Chunk]) -> None:
        for chunk in chunks:
            values = chunk.read()
            if chunk.is_real and not math.isfinite(sum(values)):
                self._refuse_not_finite(range(chunk.start, chunk.stop), values)
            self.signals[chunk.start : chunk.stop] = values
            if self._pins:
                self._keep_pinned(range(chunk.start, chunk.stop))

    def _refuse_not_finite(self, places: Sequence[int], values: Sequence[float]) -> None:
        for place, value in zip(places, values, strict=True):
            if not math.isfinite(value):
                name = ".".join(self.names[place])
                raise SimulationError(f"{name} is {value} at t = {self.time!r} s")

    def _pin(self, component: str, name: str, value: Any) -> None:
        if (component, name) in self._places:
            place = self._places[component, name]
            own = self._pins.pop(place).own if place in self._pins else self.signals[place]
            self.signals[place] = own
            if value is not None:
                self._pins[place] = _Pin(value, own)
                self.signals[place] = value
            return
        for writes in self._nodes[component].writes:
            for index, wire in enumerate(writes.wires):
                if wire.target == (component, name):
                    if value is None:
                        writes.places[index] = self._places[wire.source]
                    else:
                        writes.places[index] = len(self.signals)
                        self.signals.append(value)
            writes.bind(self._places)

    def _keep_pinned(self, places: Sequence[int]) -> None:
        for place, pin in self._pins.items():
            if place in places:
                pin.own = self.signals[place]
                self.signals[place] = pin.value


def _gatherer(places: Sequence[int]) -> Any:
    if len(places) == 1:
        place = places[0]
        return lambda signals: (signals[place],)
    return itemgetter(*places)


def _scheduled(
    groups: list[list[Name]], depends: Mapping[Name, Sequence[Name]]
) -> list[tuple[list[Name], bool]]:
    """Join groups of one instance that can be read together, keeping the dependency order.

    True marks a group that is a loop.
    """
    waiting = list(groups)
    scheduled: list[tuple[list[Name], bool]] = []
    moving = {name for group in groups for name in group}
    while waiting:
        ready = [
            g
            for g in waiting
            if not any(d in moving and d not in g for n in g for d in depends.get(n, ()))
        ]
        first = ready[0]
        is_loop = loops_on_itself(first, depends)
        if is_loop:
            taken = [first]
        else:
            taken = [g for g in ready if g[0][0] == first[0][0] and not loops_on_itself(g, depends)]
        scheduled.append(([name for group in taken for name in group], is_loop))
        waiting = [g for g in waiting if g not in taken]
        moving -= {name for group in taken for name in group}
    return scheduled


def _close(a: Any, b: Any) -> bool:
    if not isinstance(b, float) or not isinstance(a, float):
        return bool(a == b)
    return abs(a - b) <= _LOOP_TOLERANCE * max(1.0, abs(a), abs(b))
