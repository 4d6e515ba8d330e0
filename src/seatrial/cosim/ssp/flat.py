"""Nested systems made flat: every FMU with its values, every connection from output to input."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ...errors import InputError, unknown
from ...fmi.instance import Variable
from ...fmi.load import load_fmu
from ...fmi.loaded import LoadedFmu
from .definitions import Measure, converted
from .package import DEFAULT, open_package
from .parameters import Parameter, Value, value_for
from .structure import (
    FMU,
    PACKAGE,
    Component,
    Connection,
    Connector,
    Notes,
    Structure,
    System,
    read_structure,
)

Path_ = tuple[str, ...]
"""Where an element is: the names of the systems around it, and its own."""
Node = tuple[Path_, str]
"""A connector: its element, its name."""

_DEEPEST = 32
_MOST_COMPONENTS = 1000
_MOST_SYSTEMS = 1000


@dataclass
class Leaf:
    """One FMU of the flat system."""

    path: Path_
    fmu: LoadedFmu
    step: float | None
    parameters: dict[str, Parameter] = field(default_factory=dict)

    def values(self) -> dict[str, Value]:
        """Return the values set, in the variables' own units. Raises InputError."""
        variables = self.fmu.variables
        return {name: value_for(one, variables[name]) for name, one in self.parameters.items()}


@dataclass(frozen=True)
class FlatConnection:
    """A connection between two FMUs; the target gets factor * value + offset."""

    source: Node
    target: Node
    factor: float
    offset: float


class Flat:
    """The FMUs and connections of a structure, and of all that it refers to."""

    def __init__(self, structure: Structure, root: Path, label: str, notes: Notes) -> None:
        self.leaves: dict[Path_, Leaf] = {}
        self.elements: dict[Path_, list[str]] = {}
        """The names of what each system has inside, by where it is."""
        self._notes = notes
        self._connectors: dict[Node, Connector] = {}
        self._edges: dict[Node, tuple[Node, Connection]] = {}
        description = (root / DEFAULT).resolve()
        self._add_system(structure.system, (), _Place(root, label, (description,)))

    def connections(self) -> list[FlatConnection]:
        """Return all connections. Raises InputError for connections that make no sense."""
        found = []
        for path, name in list(self._edges):
            if path in self.leaves:
                connection = self._connection((path, name))
                if connection is not None:
                    found.append(connection)
        return found

    def _add_system(self, system: System, path: Path_, place: _Place) -> None:
        if len(path) > _DEEPEST:
            raise InputError(f"{system.where}: systems nest deeper than {_DEEPEST} levels")
        if len(self.elements) >= _MOST_SYSTEMS:  # references can double at each level
            raise InputError(f"{system.where}: more than {_MOST_SYSTEMS} systems")
        self.elements[path] = list(system.elements)
        self._connectors.update({(path, name): c for name, c in system.connectors.items()})
        for name, element in system.elements.items():
            inner = (*path, name)
            if isinstance(element, System):
                self._add_system(element, inner, place)
            elif element.kind == FMU:
                self._add_leaf(element, inner, place)
            else:
                self._add_reference(element, inner, place)
        for connection in system.connections:
            self._add_connection(connection, path)
        self._bind(system.parameters, path)

    def _add_reference(self, component: Component, path: Path_, place: _Place) -> None:
        """Add another package or description as if its system stood here."""
        inside = component.source.relative_to(place.root.resolve()).as_posix()
        if component.kind == PACKAGE:
            root = open_package(component.source, f"{place.label}: {inside}", self._notes)
            label, description = f"{place.label}: {inside}", root / DEFAULT
        else:
            root, label, description = place.root, place.label, component.source
        if description.resolve() in place.chain:
            raise InputError(f"{component.where}: {inside} refers to itself")
        structure = read_structure(description, root, label, self._notes)
        chain = (*place.chain, description.resolve())
        self._add_system(structure.system, path, _Place(root, label, chain))
        self._bind(component.parameters, path)

    def _add_leaf(self, component: Component, path: Path_, place: _Place) -> None:
        if len(self.leaves) >= _MOST_COMPONENTS:
            raise InputError(f"{component.where}: more than {_MOST_COMPONENTS} FMUs")
        if component.source.suffix != ".fmu":
            raise InputError(f"{component.where}: the name of an FMU must end in .fmu")
        try:
            leaf = Leaf(path, load_fmu(component.source), component.step)
        except InputError as error:
            raise InputError(f"{component.where}: {error}") from None
        self.leaves[path], variables = leaf, leaf.fmu.variables
        for name, connector in component.connectors.items():
            if name not in variables:
                raise InputError(f"{connector.where}: {unknown('variable', name, variables)}")
            if connector.type not in (None, variables[name].type):
                raise InputError(
                    f"{connector.where}: connector {name!r} is not of the type of the FMU's "
                    f"variable, {variables[name].type.__name__}"
                )
            self._connectors[path, name] = connector
            self._check_unit(variables[name], connector)
        self._bind(component.parameters, path)

    def _check_unit(self, variable: Variable, connector: Connector) -> None:
        if variable.type is not float or not variable.unit or connector.unit is None:
            return
        if converted(connector.unit, variable.measure, connector.where) != (1.0, 0.0):
            raise InputError(
                f"{connector.where}: connector {connector.name!r} is in another unit than the "
                f"FMU's variable, which is in {variable.unit}"
            )

    def _add_connection(self, connection: Connection, path: Path_) -> None:
        ends = []
        for element, name in (connection.start, connection.end):
            node = ((*path, element) if element else path, name)
            if element and element not in self.elements[path]:
                message = unknown("element", element, self.elements[path])
                raise InputError(f"{connection.where}: {message}")
            if node not in self._connectors:
                names = [n for p, n in self._connectors if p == node[0]]
                raise InputError(f"{connection.where}: {unknown('connector', name, names)}")
            kind = self._connectors[node].kind
            if kind not in ("input", "output"):
                raise InputError(
                    f"{connection.where}: connections of kind {kind!r} are not supported; bind "
                    "the value to each component instead"
                )
            # Seen from inside, an input of the system itself is where values come from.
            ends.append((node, (kind == "output") == bool(element)))
        if ends[0][1] == ends[1][1]:
            kinds = "sources" if ends[0][1] else "targets"
            raise InputError(f"{connection.where}: both ends are {kinds}")
        (source, _), (target, _) = ends if ends[0][1] else reversed(ends)
        if target in self._edges:
            before = self._edges[target][1].where
            raise InputError(f"{connection.where}: {target[1]} is fed twice, first by {before}")
        self._edges[target] = (source, connection)

    def _bind(self, parameters: list[Parameter], path: Path_) -> None:
        """Give values to the variables below ``path``; they win over those given before."""
        for parameter in parameters:
            found = self._variables(parameter, parameter.name, path)
            if not found:
                self._notes.add(
                    f"{parameter.where}: {parameter.name!r} fits no variable; SSP has it ignored"
                )
            for leaf, variable in found:
                leaf.parameters[variable] = parameter

    def _variables(self, parameter: Parameter, name: str, path: Path_) -> list[tuple[Leaf, str]]:
        """Return the variables with the hierarchical name ``name`` seen from ``path``."""
        if path in self.leaves:
            leaf = self.leaves[path]
            return [(leaf, name)] if name in leaf.fmu.variables else []
        if (path, name) in self._connectors:
            raise InputError(
                f"{parameter.where}: {parameter.name!r} is a connector of a system; values for "
                "those are not supported, bind them to the components"
            )
        found = []
        for element in self.elements[path]:
            if name.startswith(f"{element}."):
                rest = name.removeprefix(f"{element}.")
                found += self._variables(parameter, rest, (*path, element))
        return found

    def _connection(self, target: Node) -> FlatConnection | None:
        """Return the connection that ends at an FMU's input; None if it starts at no FMU."""
        chain, node = [], target
        while node in self._edges:
            source, connection = self._edges[node]
            chain.append((node, connection))
            if len(chain) > len(self._edges):
                raise InputError(f"{connection.where}: the connection leads back to itself")
            node = source
        if node[0] not in self.leaves:
            shown = ".".join((*node[0], node[1]))
            self._notes.add(f"connector {shown} of the system: nothing feeds it")
            return None
        unit = self._unit(node)
        factor, offset = 1.0, 0.0
        for end, connection in reversed(chain):
            there = self._unit(end)
            if connection.converts and unit is not None and there is not None:
                scale, shift = converted(unit, there, connection.where)
                factor, offset = scale * factor, scale * offset + shift
            factor = connection.factor * factor
            offset = connection.factor * offset + connection.offset
            unit = there or unit
        return FlatConnection(node, target, factor, offset)

    def _unit(self, node: Node) -> Measure | None:
        unit = self._connectors[node].unit
        if unit is None and node[0] in self.leaves:
            variable = self.leaves[node[0]].fmu.variables[node[1]]
            return variable.measure if variable.type is float and variable.unit else None
        return unit


@dataclass(frozen=True)
class _Place:
    """The description that is being read, and those that refer to it."""

    root: Path
    label: str
    chain: tuple[Path, ...]
