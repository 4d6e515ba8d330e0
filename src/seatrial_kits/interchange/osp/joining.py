"""Connections of a system structure as scalars: groups taken apart, functions resolved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from seatrial.errors import InputError, unknown
from seatrial.fmi.files.osp import osp_file
from seatrial.fmi.files.terminals import attribute
from seatrial.fmi.files.xmlfile import read_xml
from seatrial.fmi.instance import Variable
from seatrial.fmi.interfaces.loaded import LoadedFmu

from .structure import Connection, End, Structure, Sum, Transformation

_OUTPUTS = ("output", "calculatedParameter")


@dataclass(frozen=True)
class Link:
    """What feeds an input; ends are of simulators, or of sums: ``in[0]``, ``out``."""

    source: End
    target: End
    factor: float
    offset: float
    where: str


@dataclass(frozen=True)
class _Joined:
    """What one signal, or group of signals, of a function is connected to."""

    ends: tuple[End, ...]
    where: str


class Joining:
    """Makes the connections of a structure whose simulators are ``fmus``."""

    def __init__(self, structure: Structure, fmus: Mapping[str, LoadedFmu], folder: Path) -> None:
        self._structure, self._fmus, self._folder = structure, fmus, folder
        self._groups: dict[str, Groups] = {}
        self._links: list[Link] = []
        self._fed: dict[End, str] = {}

    def links(self) -> list[Link]:
        """Return all connections. Raises InputError, with the line, for what does not fit."""
        signals: dict[End, _Joined] = {}
        for connection in self._structure.connections:
            try:
                if connection.signal is None:
                    for one, other in self._pairs(connection):
                        self._connect(one, other, connection.where)
                else:
                    self._add_signal(signals, connection, connection.signal)
            except InputError as error:
                raise InputError(f"{connection.where}: {error}") from None
        for name, function in self._structure.functions.items():
            try:
                self._join_function(name, function, signals)
            except InputError as error:
                raise InputError(f"{function.where}: function {name!r}: {error}") from None
        return self._links

    def bonds(self) -> dict[str, list[tuple[list[End], str]]]:
        """Return, of each connection of a power bond, the inputs that it feeds, and its line."""
        found: dict[str, list[tuple[list[End], str]]] = {}
        for connection in self._structure.connections:
            if connection.bond is not None:
                targets = [self._directed(*pair)[1] for pair in self._pairs(connection)]
                found.setdefault(connection.bond, []).append((targets, connection.where))
        return found

    def _pairs(self, connection: Connection) -> Iterator[tuple[End, End]]:
        one, other = connection.variables
        if not connection.groups:
            yield one, other
            return
        for a, b in pairs(self._group(one), self._group(other)):
            yield End(one.owner, a), End(other.owner, b)

    def _group(self, end: End) -> Group:
        fmu = self._fmu(end)
        if end.owner not in self._groups:
            self._groups[end.owner] = Groups(fmu, self._folder)
        return self._groups[end.owner].named(end.name)

    def _fmu(self, end: End) -> LoadedFmu:
        if end.owner not in self._fmus:
            raise InputError(unknown("simulator", end.owner, self._fmus))
        return self._fmus[end.owner]

    def _variable(self, end: End) -> Variable:
        variables = self._fmu(end).variables
        if end.name not in variables:
            raise InputError(f"{end.owner}: {unknown('variable', end.name, variables)}")
        return variables[end.name]

    def _connect(self, one: End, other: End, where: str) -> None:
        """Connect two variables, from the output to the input."""
        source, target = self._directed(one, other)
        self._link(source, target, Transformation(1.0, 0.0, where), where)

    def _directed(self, one: End, other: End) -> tuple[End, End]:
        """Return two variables, the output first."""
        return (one, other) if self._variable(one).causality in _OUTPUTS else (other, one)

    def _link(self, source: End, target: End, by: Transformation, where: str) -> None:
        for end, causalities in ((source, _OUTPUTS), (target, ("input",))):
            of_function = end.owner in self._structure.functions
            if not of_function and self._variable(end).causality not in causalities:
                raise InputError(
                    f"{end.owner}: {end.name} is {self._variable(end).causality}, "
                    f"{causalities[0]} is needed"
                )
        if target in self._fed:
            raise InputError(
                f"{target.owner}: {target.name} is fed twice, first by {self._fed[target]}"
            )
        self._fed[target] = where
        self._links.append(Link(source, target, by.factor, by.offset, where))

    # ------------------------------------------------------------------ functions

    def _add_signal(self, signals: dict[End, _Joined], connection: Connection, signal: End) -> None:
        """Keep what a signal is connected to."""
        functions = self._structure.functions
        if signal.owner not in functions:
            raise InputError(unknown("function", signal.owner, functions))
        function = functions[signal.owner]
        by_groups = isinstance(function, Sum) and function.dimension is not None
        if by_groups != connection.groups:
            needed = "SignalGroupConnection" if by_groups else "SignalConnection"
            raise InputError(f"function {signal.owner!r} takes a {needed}")
        names = [*_inputs(function), "out"]
        if signal.name not in names:
            raise InputError(f"function {signal.owner!r}: {unknown('signal', signal.name, names)}")
        if signal in signals:
            raise InputError(
                f"function {signal.owner!r}: {signal.name!r} is connected twice, first by "
                f"{signals[signal].where}; libcosim takes the first alone"
            )
        (end,) = connection.variables
        ends = [end]
        if connection.groups:
            ends = [End(end.owner, name) for name in self._group(end).flat()]
        for each in ends:
            if self._variable(each).type is not float:
                raise InputError(f"{each.owner}: {each.name} is no real number")
        signals[signal] = _Joined(tuple(ends), connection.where)

    def _join_function(
        self, name: str, function: Transformation | Sum, signals: Mapping[End, _Joined]
    ) -> None:
        joined = {}
        for signal in [*_inputs(function), "out"]:
            if End(name, signal) not in signals:
                raise InputError(f"nothing is connected to {signal!r}")
            joined[signal] = signals[End(name, signal)]
        if isinstance(function, Transformation):
            (source,), (target,) = joined["in"].ends, joined["out"].ends
            self._link(source, target, function, function.where)
            return
        plain = Transformation(1.0, 0.0, function.where)
        for signal, to in joined.items():
            if function.dimension not in (None, len(to.ends)):
                raise InputError(
                    f"{signal!r} has {function.dimension} signals, the group that "
                    f"{to.where} connects it to has {len(to.ends)} variables"
                )
            for axis, end in enumerate(to.ends):
                port = signal if function.dimension is None else f"{signal}[{axis}]"
                own = End(name, port)
                source, target = (own, end) if signal == "out" else (end, own)
                self._link(source, target, plain, to.where)


def _inputs(function: Transformation | Sum) -> list[str]:
    if isinstance(function, Transformation):
        return ["in"]
    return [f"in[{number}]" for number in range(function.inputs)]


@dataclass(frozen=True)
class Group:
    """A group: its variables, and the groups inside it."""

    name: str
    variables: tuple[str, ...]
    groups: tuple[Group, ...]

    def all(self) -> Iterator[Group]:
        """Yield this group and those inside."""
        yield self
        for group in self.groups:
            yield from group.all()

    def flat(self) -> list[str]:
        """Return all variables, those of inner groups after its own."""
        return [*self.variables, *(name for group in self.groups for name in group.flat())]


class Groups:
    """The variable groups of one FMU; ``beside`` is the folder of the system structure.

    The file stands beside the FMU, or in that folder. Raises InputError with file and line.
    """

    def __init__(self, fmu: LoadedFmu, beside: Path) -> None:
        name = fmu.description.modelName or ""
        files = [osp_file(folder, name) for folder in (fmu.path.parent, beside)]
        # Any text may be a modelName: no other folder.
        found = [f for f in files if Path(name).name == name and f.is_file()]
        groups = _read(found[0], fmu) if found else ()
        self._top, self._all = _by_name(groups), _by_name(g for one in groups for g in one.all())
        self._file = found[0] if found else files[0]

    def named(self, name: str) -> Group:
        """Return the group ``name``; one inside others only if none at the top has the name."""
        found = self._top.get(name) or self._all.get(name)
        if not found:
            if not self._file.is_file():
                raise InputError(f"group {name!r}: there is no file {self._file.name}")
            raise InputError(f"{self._file.name}: {unknown('group', name, self._all)}")
        if len(found) > 1:
            raise InputError(f"{self._file.name}: {len(found)} groups are called {name!r}")
        return found[0]


def pairs(one: Group, other: Group) -> Iterator[tuple[str, str]]:
    """Yield what two groups connect. Raises InputError if they are not alike."""
    for what in ("variables", "groups"):
        counts = [len(getattr(group, what)) for group in (one, other)]
        if counts[0] != counts[1]:
            raise InputError(
                f"group {one.name!r} has {counts[0]} {what}, group {other.name!r} has {counts[1]}"
            )
    yield from zip(one.variables, other.variables, strict=True)
    for a, b in zip(one.groups, other.groups, strict=True):
        yield from pairs(a, b)


def _by_name(groups: Iterable[Group]) -> dict[str, list[Group]]:
    found: dict[str, list[Group]] = {}
    for group in groups:
        found.setdefault(group.name, []).append(group)
    return found


def _read(file: Path, fmu: LoadedFmu) -> tuple[Group, ...]:
    root = read_xml(file, file.name)
    if _name(root) != "OspModelDescription":
        raise InputError(
            f"{file.name}: an element OspModelDescription is needed, found {_name(root)}"
        )
    try:
        return tuple(
            _group(element, fmu.variables) for element in root.iterfind("{*}VariableGroups/{*}*")
        )
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None


def _group(element: Any, known: Mapping[str, Any]) -> Group:
    variables, groups = [], []
    for one in element.iterchildren(tag=etree.Element):
        if _name(one) != "Variable":
            groups.append(_group(one, known))
            continue
        variables.append(attribute(one, "ref"))
        if variables[-1] not in known:
            raise InputError(f"line {one.sourceline}: {unknown('variable', variables[-1], known)}")
    return Group(attribute(element, "name"), tuple(variables), tuple(groups))


def _name(element: Any) -> str:
    return str(etree.QName(element).localname)
