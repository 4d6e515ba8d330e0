"""Connections of a structure as a graph: from what each element of a connector has its value."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from seatrial.errors import InputError

from .definitions import Measure, converted
from .model import Connector, Indices
from .transformations import NEEDED, NONE, Transformation, Way

Path_ = tuple[str, ...]
"""Where an element is: the names of the systems around it, and its own."""
Node = tuple[Path_, str]
"""A connector: its element, its name."""


@dataclass(frozen=True)
class Edge:
    """What feeds a connector, or one element of it."""

    source: Node
    of_source: Indices | None
    of_target: Indices | None
    transformation: Transformation
    converts: bool
    where: str

    def passed(self, indices: Indices) -> Indices:
        """Return which element of the source an element of the target has."""
        if self.of_source is not None:
            return self.of_source
        return () if self.of_target is not None else indices


@dataclass(frozen=True)
class Origin:
    """Where the value of a connector comes from, and the connections on its way, from there."""

    node: Node
    indices: Indices
    steps: tuple[tuple[Node, Edge], ...]
    """Each has the connector where it ends."""

    @property
    def whole(self) -> bool:
        """Say if arrays are connected as a whole, all along."""
        return all(e.of_source is None and e.of_target is None for _, e in self.steps)


@dataclass
class Graph:
    """Connectors and what feeds them."""

    connectors: dict[Node, Connector] = field(default_factory=dict)
    _edges: dict[Node, list[Edge]] = field(default_factory=dict)
    _count: int = 0

    def feed(self, target: Node, edge: Edge) -> None:
        """Add a connection. Raises InputError if something feeds the target already."""
        edges = self._edges.setdefault(target, [])
        for other in edges:
            if None in (other.of_target, edge.of_target) or other.of_target == edge.of_target:
                raise InputError(f"{edge.where}: {target[1]} is fed twice, first by {other.where}")
        edges.append(edge)
        self._count += 1

    def pass_on(self, source: Node, target: Node, place: str) -> None:
        """Let ``target`` have the value of ``source``, in its own unit."""
        self.feed(target, Edge(source, None, None, NONE, converts=True, where=place))

    def is_fed(self, node: Node) -> bool:
        """Say if a connection ends at a connector, or at an element of it."""
        return node in self._edges

    def fed(self) -> Iterator[Node]:
        """Yield the connectors at which connections end, in the order of the file."""
        yield from list(self._edges)

    def origin(self, node: Node, indices: Indices) -> Origin:
        """Return where the value of a connector's element comes from; () is a scalar's.

        Raises InputError for a connection that leads back to itself.
        """
        steps: list[tuple[Node, Edge]] = []
        while edge := self._edge(node, indices):
            steps.append((node, edge))
            if len(steps) > self._count:
                raise InputError(f"{edge.where}: the connection leads back to itself")
            node, indices = edge.source, edge.passed(indices)
        return Origin(node, indices, tuple(reversed(steps)))

    def way(self, origin: Origin, begin: Way, unit: Measure | None) -> Way:
        """Return what becomes of a value on its way from ``origin``, where it is in ``unit``.

        It has gone ``begin`` already.

        Raises InputError for units that measure different things, and for transformations that
        make no sense one behind the other.
        """
        way, node = begin, origin.node
        for end, edge in origin.steps:
            there = self.connectors[end].unit
            if edge.converts and unit is not None and there is not None:
                way = way.then(*converted(unit, there, edge.where))
            way = self._transformed(way, node, end, edge)
            unit, node = there or unit, end
        return way

    def _transformed(self, way: Way, start: Node, end: Node, edge: Edge) -> Way:
        made = edge.transformation
        if not made.kind:
            return way
        self._refuse_type(made, start, end)
        if made.kind == "Linear":
            return way.then(made.factor, made.offset)
        before, after = (self.connectors[node].items for node in (start, end))
        return way.mapped(made.numbers(before, after), made.where)

    def _refuse_type(self, made: Transformation, start: Node, end: Node) -> None:
        """Raise InputError for ends that are of another type than a transformation is for."""
        wanted = NEEDED[made.kind]
        for node in (end,) if wanted is float else (start, end):
            kind = self.connectors[node].type
            if kind not in (None, wanted):
                raise InputError(
                    f"{made.where}: {made.kind}Transformation needs connectors of type "
                    f"{wanted.__name__}, {node[1]!r} is of type {kind.__name__}"
                )

    def _edge(self, node: Node, indices: Indices) -> Edge | None:
        for edge in self._edges.get(node, ()):
            if edge.of_target is None or edge.of_target == indices:
                return edge
        return None
