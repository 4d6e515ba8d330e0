"""Layout of a rig in a package: systems in systems, or all parts in one."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from seatrial.system.part import Part
from seatrial.system.paths import joined
from seatrial.system.rig import Scope
from seatrial.system.system import Connection, System

Output = tuple[str, str]
"""An output: its part's name, its own."""
End = tuple[str, str]
"""Element and connector; without element, a connector of the system itself."""
Path_ = tuple[str, ...]


Kind = Literal["input", "output", "parameter", "calculatedParameter"]


class Boundary(NamedTuple):
    """A connector of a system: what goes through it."""

    kind: Kind
    carries: Output


@dataclass
class Level:
    """A system of a package: its elements, its own connectors, the connections inside."""

    name: str
    elements: dict[str, Part | Level] = field(default_factory=dict)
    """By the names that they have here."""
    connectors: dict[str, Boundary] = field(default_factory=dict)
    connections: dict[tuple[End, End], Connection | None] = field(default_factory=dict)
    """The last one on the way to an input has what is done to the value; others pass it on."""
    crossing: dict[Output, str] = field(default_factory=dict)
    """Connectors by what goes in or out through them."""

    def parts(self, path: str = "") -> Iterator[tuple[str, Part]]:
        """Yield all parts inside, each with its path from the system at ``path``."""
        for name, element in self.elements.items():
            if isinstance(element, Level):
                yield from element.parts(joined(path, name))
            else:
                yield joined(path, name), element

    def connector(self, kind: Kind, carried: Output, path: Path_, variable: str) -> str:
        """Return the connector through which a value goes; a new one is called by what it is of.

        Dots of the path become ``_``: with them it would be called as a variable inside is in
        tools that join names by dots.
        """
        if carried in self.crossing:
            return self.crossing[carried]
        base = prefix = "_".join(path)
        count = 1
        while (name := f"{prefix}_{variable}") in self.connectors or (
            name.partition(".")[0] in self.elements
        ):
            count += 1
            prefix = f"{base}_{count}"
        self.connectors[name] = Boundary(kind, carried)
        self.crossing[carried] = name
        return name


def flat(system: System, connections: Iterable[Connection]) -> Level:
    """Return one system of all parts, which are called by their paths with ``_`` for dots."""
    top, names = Level("root"), dict[str, str]()
    for part in system.parts.values():
        names[part.name] = name = unused(part.name.replace(".", "_"), top.elements)
        top.elements[name] = part
    for connection in connections:
        (source, output), (target, variable) = connection.source, connection.target
        top.connections[(names[source], output), (names[target], variable)] = connection
    return top


def nested(system: System, connections: Iterable[Connection]) -> Level:
    """Return the systems of a rig and of those inside it, connected through their connectors.

    A connector is called by what stands behind it, seen from its system, ``hull_position.x``:
    the output that it gives, or the first of the inputs that it feeds.
    """
    levels: dict[Path_, Level] = {}
    top = _level(system, system.rig.top, "root", (), levels)
    if system.rig.top.inner:  # the same names for the same system, in whatever order it was written
        connections = sorted(connections, key=_place_of_targets(system))
    once = {connection.target for connection in system.initial}
    for connection in connections:
        _route(connection, levels, calculated=connection.target in once)
    return top


def unused(name: str, taken: Container[str]) -> str:
    """Return ``name`` as an identifier that is not ``taken``."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    first = found = f"_{plain}" if plain[:1].isdigit() else plain
    count = 1
    while found in taken:
        count += 1
        found = f"{first}_{count}"
    return found


def _level(
    system: System, scope: Scope, name: str, path: Path_, levels: dict[Path_, Level]
) -> Level:
    """Return the system of a rig, connected to nothing; ``levels`` gets it and those inside."""
    level = levels[path] = Level(name)
    for each in scope.file.components:
        inside = (*path, each)
        level.elements[each] = (
            _level(system, scope.inner[each], each, inside, levels)
            if each in scope.inner
            else system.parts[".".join(inside)]
        )
    return level


def _place_of_targets(system: System) -> Callable[[Connection], tuple[int, int]]:
    """Return a function that says where a connection ends: the number of part and variable."""
    parts = {name: number for number, name in enumerate(system.parts)}
    variables = {
        name: {variable: number for number, variable in enumerate(part.instance.variables)}
        for name, part in system.parts.items()
    }
    return lambda one: (parts[one.target[0]], variables[one.target[0]][one.target[1]])


def _route(connection: Connection, levels: dict[Path_, Level], *, calculated: bool) -> None:
    """Take a value up to the system that has both ends inside, and down from there."""
    upwards: Kind = "calculatedParameter" if calculated else "output"
    downwards: Kind = "parameter" if calculated else "input"
    source, target = (tuple(name.split(".")) for name, _ in (connection.source, connection.target))
    output, variable = connection.source[1], connection.target[1]
    shared = _shared(source[:-1], target[:-1])
    start = (source[-1], output)
    for depth in range(len(source) - 1, shared, -1):
        level = levels[source[:depth]]
        name = level.connector(upwards, connection.source, source[depth:], output)
        level.connections[start, ("", name)] = None
        start = (source[depth - 1], name)
    for depth in range(shared + 1, len(target)):
        level = levels[target[:depth]]
        name = level.connector(downwards, connection.source, target[depth:], variable)
        levels[target[: depth - 1]].connections[start, (target[depth - 1], name)] = None
        start = ("", name)
    levels[target[:-1]].connections[start, (target[-1], variable)] = connection


def _shared(one: Path_, other: Path_) -> int:
    """Return how many systems from the top on have both inside."""
    count = 0
    while count < min(len(one), len(other)) and one[count] == other[count]:
        count += 1
    return count
