"""Nested systems made flat: every FMU with its values, every connection from output to input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from seatrial.errors import InputError, unknown
from seatrial.fmi.building.bundle_name import bundle_name
from seatrial.fmi.building.export import cached_fmu
from seatrial.fmi.components.source import table_source
from seatrial.fmi.components.table_file import SUFFIXES
from seatrial.fmi.files.options import FmuOptions, Interface
from seatrial.fmi.loading.load import load_fmu
from seatrial.system.packages import SSP_FILE

from .binding import Bound
from .graph import Edge, Graph, Node, Origin, Path_
from .leaf import Leaf, SizesOnly, as_variable, connectors_of
from .model import (
    DEEPEST,
    FMU,
    MOST_SYSTEMS,
    PACKAGE,
    TABLES,
    Component,
    Connection,
    Connector,
    Dictionary,
    End,
    Reference,
    Structure,
    System,
)
from .notes import Notes
from .package import Package, open_package
from .parameters import Parameter
from .structure import read_structure
from .transformations import Way


@dataclass
class Dictionaries:
    """The dictionaries of all systems, and what refers to their signals."""

    _places: dict[Path_, Mapping[str, Dictionary]] = field(default_factory=dict)
    """By the system that has them."""
    _references: dict[Node, list[tuple[Node, str]]] = field(default_factory=dict)
    """Connectors of references, and where those are, by signal."""

    def add(self, dictionaries: Mapping[str, Dictionary], path: Path_, graph: Graph) -> None:
        """Add the dictionaries of the system at ``path``."""
        self._places[path] = dictionaries
        for name, dictionary in dictionaries.items():
            for signal, connector in dictionary.signals.items():
                graph.connectors[_place(path, name), signal] = connector

    def refer(self, reference: Reference, path: Path_, graph: Graph) -> None:
        """Add a reference at ``path``. Raises InputError for what its dictionary does not have."""
        around = path[:-1]
        while reference.dictionary not in self._places.get(around, {}):
            if not around:
                known = {name for each in self._places.values() for name in each}
                message = unknown("signal dictionary", reference.dictionary, known)
                raise InputError(f"{reference.where}: {message}")
            around = around[:-1]
        signals = self._places[around][reference.dictionary].signals
        for name, connector in reference.connectors.items():
            if name not in signals:
                raise InputError(f"{connector.where}: {unknown('signal', name, signals)}")
            items = connector.items or signals[name].items
            graph.connectors[path, name] = replace(connector, items=items)
            signal = (_place(around, reference.dictionary), name)
            self._references.setdefault(signal, []).append(((path, name), connector.where))

    def connect(self, graph: Graph) -> None:
        """Let the references of each signal have what one of them is given.

        Raises InputError for a signal that two are given.
        """
        for signal, references in self._references.items():
            given = [(node, place) for node, place in references if graph.is_fed(node)]
            if len(given) > 1:
                raise InputError(
                    f"{given[1][1]}: the signal {signal[1]!r} of the dictionary "
                    f"{signal[0][-1][1:]!r} is given twice, first at {given[0][1]}"
                )
            if not given:
                continue
            graph.pass_on(given[0][0], signal, given[0][1])
            for node, place in references:
                if node != given[0][0]:
                    graph.pass_on(signal, node, place)


def _place(path: Path_, name: str) -> Path_:
    return (*path, f"\0{name}")  # no element of an XML file is called so


_MOST_COMPONENTS = 1000
_INTERFACES: dict[str, Interface] = {
    "CoSimulation": "co-simulation",
    "ModelExchange": "model exchange",
}
"""Interfaces by what SSP calls the implementation; of others the FMU's first one."""

_OUT = {"output", "calculatedParameter", "constant", "local", "independent"}
"""Kinds of connectors of an element that give a value; seen from inside, a system's take it."""
_EITHER = {"inout", "unspecified"}


@dataclass(frozen=True)
class FlatConnection:
    """A connection between two variables of FMUs."""

    source: Node
    target: Node
    way: Way
    where: str


@dataclass(frozen=True)
class _Place:
    """The description that is being read, and those that refer to it."""

    package: Package
    chain: tuple[Path, ...]


@dataclass
class Flat:
    """The FMUs and connections of a structure, and of all that it refers to."""

    notes: Notes
    leaves: dict[Path_, Leaf] = field(default_factory=dict)
    elements: dict[Path_, list[str]] = field(default_factory=dict)
    """The names of what each system has inside, by where it is."""
    graph: Graph = field(default_factory=Graph)
    _dictionaries: Dictionaries = field(default_factory=Dictionaries)
    _bound: Bound = field(default_factory=Bound)
    _bindings: list[tuple[Sequence[Parameter], Path_]] = field(default_factory=list)
    """Values and where they are bound, inner before outer."""
    _components: dict[Path_, Component] = field(default_factory=dict)
    """FMUs as the description has them."""

    @classmethod
    def of(cls, structure: Structure, package: Package, notes: Notes) -> Flat:
        """Return what ``structure``, a package's first, is, made flat.

        Raises InputError for what does not fit together.
        """
        made = cls(notes)
        made._add_system(structure.system, (), _Place(package, (package.description,)))
        made._dictionaries.connect(made.graph)
        made._resize()
        for parameters, path in made._bindings:
            made._bound.bind(parameters, path, made)
        return made

    def connections(self) -> list[FlatConnection]:
        """Return all connections, and give FMUs the values that come from systems' connectors.

        Raises InputError for connections that make no sense.
        """
        found = []
        for path, name in self.graph.fed():
            if path in self.leaves:
                for indices, variable in self.leaves[path].scalars(name).items():
                    origin = self.graph.origin((path, name), indices)
                    if origin.steps:
                        found += self._connected(origin, (path, variable), len(indices))
        self._bound.note_unused(self.graph, self.notes)
        return found

    # ------------------------------------------------------------------ sizes

    def _resize(self) -> None:
        """Load FMUs again whose structural parameters have values: sizes of arrays follow."""
        sized: dict[Path_, Leaf] = {path: SizesOnly.of(leaf) for path, leaf in self.leaves.items()}
        if not any(leaf.structural for leaf in self.leaves.values()):
            return
        probe = replace(self, notes=Notes(), leaves=sized, _bound=Bound())
        for parameters, path in self._bindings:
            probe._bound.bind(parameters, path, probe)
        for path, name in self.graph.fed():
            if path in sized and name in sized[path].structural:
                origin = self.graph.origin((path, name), ())
                if origin.steps:
                    probe._connected(origin, (path, name), 0)
        for path, leaf in sized.items():
            if leaf.values:
                self.leaves[path].resize({name: one for name, (one, _) in leaf.values.items()})
            if leaf.structural:
                component = self._components[path]
                self._add_connectors(self.leaves[path], component, self.notes)

    # ------------------------------------------------------------------ elements

    def _add_system(self, system: System, path: Path_, place: _Place) -> None:
        if len(path) > DEEPEST:
            raise InputError(f"{system.where}: systems nest deeper than {DEEPEST} levels")
        if len(self.elements) >= MOST_SYSTEMS:  # references can double at each level
            raise InputError(f"{system.where}: more than {MOST_SYSTEMS} systems")
        self.elements[path] = [
            name for name, one in system.elements.items() if not isinstance(one, Reference)
        ]
        self.graph.connectors.update({(path, name): c for name, c in system.connectors.items()})
        self._dictionaries.add(system.dictionaries, path, self.graph)
        for name, element in system.elements.items():
            inner = (*path, name)
            if isinstance(element, Reference):
                self._dictionaries.refer(element, inner, self.graph)
            elif isinstance(element, System):
                self._add_system(element, inner, place)
            else:
                self._add_component(element, inner, place)
        known = list(system.elements)
        for connection in system.connections:
            self._add_connection(connection, path, known)
        self._bindings.append((system.parameters, path))

    def _add_component(self, component: Component, path: Path_, place: _Place) -> None:
        if component.inner is not None:
            self._add_system(component.inner, path, place)
            self._bindings.append((component.parameters, path))
        elif component.source.file is None:
            self.elements[path] = []
            connectors = {(path, name): c for name, c in component.connectors.items()}
            self.graph.connectors.update(connectors)
            self._bindings.append((component.parameters, path))
        elif component.kind in (FMU, *TABLES):
            self._add_leaf(component, component.source.file, path)
        else:
            self._add_reference(component, component.source.file, path, place)

    def _add_reference(
        self, component: Component, source: Path, path: Path_, place: _Place
    ) -> None:
        """Add another package or description as if its system stood here."""
        package, description = place.package, source
        if component.kind == PACKAGE:
            package = open_package(source, place.package.shown(source), self.notes)
            description = package.folder / (component.source.fragment or SSP_FILE)
            if not description.is_file() or description.parent != package.folder:
                raise InputError(
                    f"{component.where}: {package.label} has no {component.source.fragment!r}"
                )
        if description.resolve() in place.chain:
            inside = place.package.name_of(source)
            raise InputError(f"{component.where}: {inside} refers to itself")
        structure = read_structure(description, package, self.notes)
        chain = (*place.chain, description.resolve())
        self._add_system(structure.system, path, _Place(package, chain))
        self._bindings.append((component.parameters, path))

    def _add_leaf(self, component: Component, source: Path, path: Path_) -> None:
        if len(self.leaves) >= _MOST_COMPONENTS:
            raise InputError(f"{component.where}: more than {_MOST_COMPONENTS} FMUs")
        kind, suffixes = ("an FMU", (".fmu",)) if component.kind == FMU else ("a table", SUFFIXES)
        if source.suffix not in suffixes:
            ends = " or ".join(suffixes)
            raise InputError(f"{component.where}: the name of {kind} must end in {ends}")
        if component.implementation == "ScheduledExecution":
            raise InputError(f"{component.where}: ScheduledExecution is not supported")
        try:
            if component.kind != FMU:
                source = _table_fmu(component, source)
            fmu = load_fmu(source, FmuOptions(_INTERFACES.get(component.implementation)))
        except InputError as error:
            raise InputError(f"{component.where}: {error}") from None
        leaf = self.leaves[path] = Leaf(
            path, fmu, component.source.isolated, component.step, component.where
        )
        # Those of one that may change its sizes are checked when these are known.
        self._components[path] = component
        self._add_connectors(leaf, component, Notes() if leaf.structural else self.notes)
        self._bindings.append((component.parameters, path))

    def _add_connectors(self, leaf: Leaf, component: Component, notes: Notes) -> None:
        connectors = connectors_of(leaf, component, notes)
        self.graph.connectors.update({(leaf.path, name): c for name, c in connectors.items()})

    # ------------------------------------------------------------------ connections

    def _add_connection(self, connection: Connection, path: Path_, known: list[str]) -> None:
        ends = []
        for end in (connection.start, connection.end):
            if end.element and end.element not in known:
                message = unknown("element", end.element, known)
                raise InputError(f"{connection.where}: {message}")
            node = ((*path, end.element) if end.element else path, end.connector)
            kind = self._connector(node, connection.where).kind
            # Seen from inside, an input of the system itself is where values come from.
            gives = None if kind in _EITHER else (kind in _OUT) == bool(end.element)
            ends.append((node, end, gives))
        (first, start, gives), (second, end, takes) = ends
        if gives is not None and gives == takes:
            kinds = "sources" if gives else "targets"
            raise InputError(f"{connection.where}: both ends are {kinds}")
        if gives is False or takes is True:
            (first, start), (second, end) = (second, end), (first, start)
        self.graph.feed(second, self._edge(first, start, end, connection))

    def _edge(self, source: Node, start: End, end: End, connection: Connection) -> Edge:
        return Edge(
            source,
            start.indices,
            end.indices,
            connection.transformation,
            connection.converts,
            connection.where,
        )

    def _connector(self, node: Node, where: str) -> Connector:
        """Return a connector; one of an FMU need not be declared. Raises InputError."""
        connectors = self.graph.connectors
        if node not in connectors:
            leaf = self.leaves.get(node[0])
            scalars = {} if leaf is None else leaf.scalars(node[1])
            if leaf is not None and node[1] in leaf.fmu.others:
                raise InputError(
                    f"{where}: connections of clocks, and of data of bus terminals, are not "
                    f"supported: {node[1]!r}"
                )
            if leaf is None or not scalars:
                names = [n for p, n in connectors if p == node[0]]
                raise InputError(f"{where}: {unknown('connector', node[1], names)}")
            self.notes.pass_over(where, f"{node[1]!r} is no connector, but a variable of the FMU")
            variable = leaf.fmu.variables[next(iter(scalars.values()))]
            bare = Connector(node[1], "", None, None, {}, (), False, where)
            connectors[node] = as_variable(bare, variable)
        if connectors[node].is_clock:
            raise InputError(f"{where}: connections of clocks are not supported: {node[1]!r}")
        if connectors[node].problem:
            raise InputError(f"{connectors[node].where}: {connectors[node].problem}")
        return connectors[node]

    def _connected(self, origin: Origin, target: Node, dimensions: int) -> list[FlatConnection]:
        """Return the connection that ends at a variable; a start value instead, if that comes."""
        leaf, place = self.leaves.get(origin.node[0]), origin.steps[-1][1].where
        if leaf is None:
            self._bound.carry(origin, self.leaves[target[0]], target[1], self)
            return []
        scalars = leaf.scalars(origin.node[1])
        count = len(self.leaves[target[0]].scalars(origin.steps[-1][0][1]))
        if origin.indices not in scalars or (origin.whole and len(scalars) != count):
            raise InputError(
                f"{place}: {origin.node[1]!r} has {len(scalars)} values, {target[1]!r} is one of "
                f"{count}; an element needs its indices"
            )
        self._refuse_fixed(leaf, scalars[origin.indices], target, place)
        way = self.graph.way(origin, Way(), self.graph.connectors[origin.node].unit)
        return [FlatConnection((leaf.path, scalars[origin.indices]), target, way, place)]

    def _refuse_fixed(self, leaf: Leaf, output: str, target: Node, place: str) -> None:
        source = leaf.fmu.variables[output]
        variable = self.leaves[target[0]].fmu.variables[target[1]]
        if source.causality == "local":
            leaf.locals[output] = None
        if variable.causality != "parameter" or source.causality == "calculatedParameter":
            return
        if variable.variability == "fixed" and source.variability not in ("constant", "fixed"):
            raise InputError(
                f"{place}: {output!r}, an output, cannot feed {target[1]!r}, a fixed parameter"
            )


def _table_fmu(component: Component, source: Path) -> Path:
    """Return the FMU of a file of values over time; connectors say the types of its columns."""
    connectors = component.connectors.values()
    table = table_source(source, {one.name: one.type for one in connectors if one.type})
    return cached_fmu(table, bundle_name(table))
