"""Feed-through: outputs that depend on inputs at the same instant, read again in order.

Whoever moved values along connections alone would add a delay of one step per hop. Here the outputs
that were declared to depend on inputs are visited in the order of their dependencies at every
communication point. Outputs that depend on each other in a loop are found by fixed-point
iteration: with relaxation where it grows, with Anderson's acceleration where it is slow.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

from ..errors import ExcessError, SimulationError
from ..model.component import NS
from .network import Name, Network, sources_by_target
from .node import Chunk, Node
from .order import loops_on_itself, ordered_groups, unrolled

_TOLERANCE = 1e-12
_ITERATIONS = 200
_LEAST_RELAXATION = 1 / 16
_ACCELERATED = 0.0
"""Stands for Anderson's acceleration in place of a relaxation."""
_TRIED = (1.0, 1 / 2, 1 / 4, 1 / 8, _LEAST_RELAXATION, _ACCELERATED)
_MEMORY = 8
"""Repetitions that the acceleration looks back on."""


@dataclass
class Visit:
    """Outputs of one node to read once the inputs they depend on were moved."""

    node: Node
    chunks: list[Chunk]


@dataclass
class Group:
    """Visits that belong together: of one component, or of all components of a loop."""

    outputs: list[Name]
    is_loop: bool
    visits: list[Visit] = field(default_factory=list)
    relaxation: float = 1.0
    """What the loop last settled with."""


class Feedthrough:
    """Visits feed-through outputs of a network. Making one gives all outputs their places."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self.groups = _groups(network)
        """In the order in which they are visited."""
        visited = {name for group in self.groups for name in group.outputs}
        for name, node in network.nodes.items():
            outputs = [
                v.name for v in node.part.instance.variables.values() if v.causality == "output"
            ]
            rest = [n for n in outputs if (name, n) not in visited]
            node.reads = node.independent = network.add_chunks(node, rest)
        for group in self.groups:
            for component in dict.fromkeys(component for component, _ in group.outputs):
                node = network.nodes[component]
                of_node = [n for c, n in group.outputs if c == component]
                group.visits.append(Visit(node, network.add_chunks(node, of_node)))
        network.bind_inputs()
        for node in network.nodes.values():
            node.written_by_visit = self._writes_all(node)
            self._defer_reads(node)

    def propagate(self, steps: int) -> None:
        """Visit everything that has a value at this communication point.

        ``steps`` counts communication steps: a component with a longer step of its own has
        values at whole multiples only. Raises SimulationError for a loop that does not settle.
        """
        for group in self.groups:
            if group.is_loop:
                self.solve(group, steps)
            else:
                for visit in group.visits:
                    if steps % visit.node.every == 0:
                        self._network.write(visit.node)
                        self._network.read(visit.chunks)

    def among(self, names: Collection[str]) -> Feedthrough:
        """Return the visits to some components alone."""
        some = copy(self)
        some.groups = [
            replace(group, visits=[v for v in group.visits if v.node.part.name in names])
            for group in self.groups
        ]
        return some

    def forget(self) -> None:
        """Visit nothing any more but sums, which take no step: values move by steps alone."""
        visits = [v for group in self.groups for v in group.visits if v.node.part.is_sum]
        self.groups = [Group([], is_loop=False, visits=[visit]) for visit in visits]
        for node in self._network.nodes.values():
            if not node.part.is_sum:
                node.reads = node.independent = node.chunks
                node.written_by_visit = False

    def save(self) -> list[float]:
        """Return what the loops have learned, for a rollback."""
        return [group.relaxation for group in self.groups]

    def restore(self, state: list[float]) -> None:
        """Restore what `save` returned."""
        for group, relaxation in zip(self.groups, state, strict=True):
            group.relaxation = relaxation

    def _writes_all(self, node: Node) -> bool:
        """Say if everything that feeds a node is final when its last visit writes its inputs."""
        turns = [i for i, g in enumerate(self.groups) if any(v.node is node for v in g.visits)]
        if not turns or self.groups[turns[-1]].is_loop:
            return False
        read_in = {name: i for i, group in enumerate(self.groups) for name in group.outputs}
        sources = [connection.source for writes in node.writes for connection in writes.connections]
        return all(read_in.get(source, -1) < turns[-1] for source in sources)

    def _defer_reads(self, node: Node) -> None:
        """Let the first visit read all outputs of a node, if nobody needs the others before.

        A component computes all its outputs at once: it need not do so before its inputs came.
        """
        turns = [(i, v) for i, g in enumerate(self.groups) for v in g.visits if v.node is node]
        if not turns or self.groups[turns[0][0]].is_loop:
            return
        first, visit = turns[0]
        early = [v.node for group in self.groups[: first + 1] for v in group.visits]
        needed = {one.source[0] for other in early for w in other.writes for one in w.connections}
        if node.part.name not in needed:
            visit.chunks = [*node.independent, *visit.chunks]
            node.reads = []

    # ------------------------------------------------------------------ loops

    def solve(self, group: Group, steps: int) -> None:
        """Find a fixed point of a loop: as it was last found, else in every other way.

        Relaxation is for iterations that grow and alternate, acceleration for those that shrink too
        slowly and for fixed points that repel.
        """
        places = [self._network.places[name] for name in group.outputs]
        begun = [self._network.signals[p] for p in places]
        factor, has_reals = 0.0, any(isinstance(value, float) for value in begun)
        excess: ExcessError | None = None
        for relaxation in dict.fromkeys((group.relaxation, *_TRIED)):
            if relaxation == _ACCELERATED and not has_reals:
                continue
            group.relaxation = relaxation
            iterate = self._accelerate if relaxation == _ACCELERATED else self._iterate
            try:
                settled, factor = iterate(group, places, steps)
                excess = None
            except ExcessError as error:  # on its way: another relaxation may not go there
                settled, factor, excess = False, float("inf"), error
            if settled:
                return
            for place, value in zip(places, begun, strict=True):
                self._network.signals[place] = value
        group.relaxation = 1.0
        if excess is not None:
            raise excess
        names = ", ".join(".".join(name) for name in group.outputs)
        raise SimulationError(
            f"at t = {self._network.time_ns / NS!r} s the loop through {names} does not settle: "
            f"each repetition changes it {factor:.3g} times as much as the one before, even with "
            f"a relaxation of {_LEAST_RELAXATION:g}, or has no solution; break it with a component "
            "that has a state"
        )

    def _iterate(self, group: Group, places: list[int], steps: int) -> tuple[bool, float]:
        """Return whether the loop settles, and the factor between the last two changes."""
        signals, relaxation = self._network.signals, group.relaxation
        change, factor, growing = 0.0, 0.0, 0
        for _ in range(_ITERATIONS):
            before, after = self._sweep(group, places, steps)
            if _all_close(before, after):
                return True, 0.0
            last, change = change, max(_distance(a, b) for a, b in zip(before, after, strict=True))
            factor = change / last if last else 0.0
            growing = growing + 1 if factor > 1.0 else 0
            if growing == 5:
                break
            if relaxation != 1.0:
                for place, a, b in zip(places, before, after, strict=True):
                    if isinstance(b, float) and isinstance(a, float):
                        signals[place] = a + relaxation * (b - a)
        return False, factor

    def _accelerate(self, group: Group, places: list[int], steps: int) -> tuple[bool, float]:
        """Return the same as `_iterate`, with Anderson's acceleration of the real outputs.

        Each new point is the combination of the last ones whose changes cancel best.
        """
        import numpy as np

        signals, change, factor = self._network.signals, 0.0, 0.0
        real = [i for i, place in enumerate(places) if isinstance(signals[place], float)]
        points: list[Any] = []
        changes: list[Any] = []
        for _ in range(_ITERATIONS):
            before, after = self._sweep(group, places, steps)
            if _all_close(before, after):
                return True, 0.0
            last, change = change, max(_distance(a, b) for a, b in zip(before, after, strict=True))
            factor = change / last if last else 0.0
            points = [*points[-_MEMORY:], np.array([before[i] for i in real])]
            changes = [*changes[-_MEMORY:], np.array([after[i] for i in real]) - points[-1]]
            if len(points) > 1:
                moved, changed = np.diff(points, axis=0).T, np.diff(changes, axis=0).T
                share = np.linalg.lstsq(changed, changes[-1], rcond=None)[0]
                found = points[-1] + changes[-1] - (moved + changed) @ share
                for i, value in zip(real, found.tolist(), strict=True):
                    signals[places[i]] = value
        return False, factor

    def _sweep(self, group: Group, places: list[int], steps: int) -> tuple[list[Any], list[Any]]:
        """Visit a loop once; return its values before and after."""
        signals = self._network.signals
        before = [signals[p] for p in places]
        for visit in group.visits:
            if steps % visit.node.every == 0:
                self._network.write(visit.node)
                self._network.read(visit.chunks)
        return before, [signals[p] for p in places]


def _groups(network: Network) -> list[Group]:
    """Return the outputs to visit, in dependency order."""
    depends = _dependencies(network)
    outputs = {
        name for name in depends if name[1] in network.nodes[name[0]].part.instance.variables
    }
    groups = [g for g in ordered_groups(depends) if any(n in depends for n in g)]
    scheduled = _scheduled(groups, depends)
    named = [([n for n in group if n in outputs], is_loop) for group, is_loop in scheduled]
    return [Group(names, is_loop) for names, is_loop in named if names]


def _dependencies(network: Network) -> dict[Name, list[Name]]:
    """Return what feed-through outputs depend on, through hubs.

    Outputs of an FMU that says nothing depend on all its inputs: they share one hub, which
    depends on the sources of these inputs, or a large FMU would have millions of pairs.
    """
    source_of = sources_by_target(network.system)
    depends: dict[Name, list[Name]] = {}
    for name, part in network.system.parts.items():
        hubs: dict[tuple[str, ...], Name] = {}
        of_list: dict[int, Name] = {}  # outputs share lists of inputs, which may be long
        for output, inputs in part.instance.feedthrough.items():
            hub = of_list.get(id(inputs))
            key = () if hub else tuple(inputs)
            if hub is None and key not in hubs:
                hubs[key] = (name, f"\0{len(hubs)}")  # no variable's name: XML cannot hold it
                sources = [source_of[name, i] for i in key if (name, i) in source_of]
                if sources:
                    depends[hubs[key]] = sources
            hub = of_list.setdefault(id(inputs), hub or hubs[key])
            if hub in depends:
                depends[name, output] = [hub]
    return depends


def _scheduled(
    groups: list[list[Name]], depends: Mapping[Name, Sequence[Name]]
) -> list[tuple[list[Name], bool]]:
    """Join groups of one component that can be read together, keeping the dependency order.

    True marks a group that is a loop. A component whose outputs are not ready all waits, if another
    is: it computes them all at once.
    """
    index = {name: i for i, group in enumerate(groups) for name in group}
    needs = [
        {index[d] for name in group for d in depends.get(name, ()) if d in index} - {i}
        for i, group in enumerate(groups)
    ]
    waiting = {
        i: unrolled(g, depends) if loops_on_itself(g, depends) else g for i, g in enumerate(groups)
    }
    owner = [group[0][0] for group in groups]
    scheduled: list[tuple[list[Name], bool]] = []
    while waiting:
        ready = {i: None for i in waiting if needs[i].isdisjoint(waiting)}
        late = {
            owner[i]
            for i in waiting
            if any(k not in ready or owner[k] != owner[i] for k in needs[i] & waiting.keys())
        }
        chosen = next((i for i in ready if owner[i] not in late), next(iter(ready)))
        first, taken = waiting[chosen], [chosen]
        is_loop = loops_on_itself(first, depends)
        if not is_loop:
            of_node = [i for i in ready if waiting[i][0][0] == first[0][0]]
            taken = [i for i in of_node if not loops_on_itself(waiting[i], depends)]
        scheduled.append(([name for i in taken for name in waiting.pop(i)], is_loop))
    return scheduled


def _all_close(before: Sequence[Any], after: Sequence[Any]) -> bool:
    return all(_close(a, b) for a, b in zip(before, after, strict=True))


def _close(a: Any, b: Any) -> bool:
    if not isinstance(b, float) or not isinstance(a, float):
        return bool(a == b)
    return abs(a - b) <= _TOLERANCE * max(1.0, abs(a), abs(b))


def _distance(a: Any, b: Any) -> float:
    if not isinstance(b, float) or not isinstance(a, float):
        return float(a != b)
    return abs(b - a)
