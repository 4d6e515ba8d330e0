"""OspSystemStructure.xml as it stands: simulators, functions, connections, each with its line."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote, urlsplit

from lxml import etree

from seatrial.errors import InputError, unknown
from seatrial.fmi.files.xmlfile import read_xml
from seatrial.fmi.instance import Value
from seatrial.system.rig import LONGEST_S

from ..proxied import proxied_file
from ..ssp.documents import boolean, child, children, needed, number, tag, where

NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
ALGORITHMS = ("fixedStep", "ecco")
_MOST = 1000
"""Simulators, functions, terms of a sum, and its dimension."""


@dataclass(frozen=True)
class InitialValue:
    """A value set before the start."""

    value: Value
    where: str


@dataclass(frozen=True)
class Simulator:
    """One FMU."""

    source: Path
    isolated: bool
    """It runs in a process of its own."""
    step: float | None
    """Its own communication step, s."""
    values: dict[str, InitialValue]
    where: str


@dataclass(frozen=True)
class Transformation:
    """A LinearTransformation: ``out`` is factor * ``in`` + offset."""

    factor: float
    offset: float
    where: str


@dataclass(frozen=True)
class Sum:
    """A Sum, or a VectorSum with its dimension."""

    inputs: int
    dimension: int | None
    where: str


class End(NamedTuple):
    """A variable or a group of one simulator; a signal or a group of one function."""

    owner: str
    name: str


@dataclass(frozen=True)
class Connection:
    """Two ends as written; ``signal`` is that of the function, if there is one."""

    variables: tuple[End, ...]
    signal: End | None
    groups: bool
    where: str
    bond: str | None = None
    """Name of the power bond that it is one half of."""


@dataclass
class Structure:
    """The content of a file."""

    start: float | None = None
    stop: float | None = None
    step: float | None = None
    algorithm: str | None = None
    ecco: Any | None = None
    """The element with the settings of ecco."""
    simulators: dict[str, Simulator] = field(default_factory=dict)
    functions: dict[str, Transformation | Sum] = field(default_factory=dict)
    connections: list[Connection] = field(default_factory=list)


def read_structure(path: Path) -> Structure:
    """Read the file at ``path``. Raises InputError for what does not fit OSP-IS' schema 0.1."""
    root = read_xml(path, path.name)
    root.getroottree().docinfo.URL = path.name
    for element in root.iter(etree.Element):
        name = etree.QName(element)
        if name.namespace == NAMESPACE:
            element.tag = name.localname
    if tag(root) != "OspSystemStructure":
        raise InputError(
            f"{where(root)}: OspSystemStructure (in {NAMESPACE}) is needed, found {tag(root)}"
        )
    _only(root, {"version"}, {*_READERS, "EccoConfiguration"})
    if needed(root, "version") != "0.1":
        raise InputError(
            f"{where(root)}: version {root.get('version')!r} of the system structure; 0.1 is read"
        )
    reading = _Reading(path.parent)
    for name, read in _READERS.items():
        element = child(root, name)
        if element is not None:
            read(reading, element)
    reading.structure.ecco = child(root, "EccoConfiguration")
    if not reading.structure.simulators:
        raise InputError(f"{where(root)}: there is no Simulator")
    return reading.structure


def _only(element: Any, attributes: Collection[str], elements: Collection[str]) -> None:
    """Raise InputError if ``element`` has anything else: what is not read could matter."""
    for name in element.attrib:
        if not name.startswith("{") and name not in attributes:
            raise InputError(
                f"{where(element)}: {tag(element)}: {unknown('attribute', name, attributes)}"
            )
    for one in children(element):
        if tag(one) not in elements:
            raise InputError(
                f"{where(one)}: {tag(one)} in {tag(element)} is not supported "
                f"(read are: {', '.join(sorted(elements)) or 'none'})"
            )


class _Reading:
    """Reads the parts of a file."""

    def __init__(self, folder: Path) -> None:
        self.structure = Structure()
        self._folder = folder

    def read_start(self, element: Any) -> None:
        self.structure.start = content_of(element)

    def read_stop(self, element: Any) -> None:
        self.structure.stop = content_of(element)

    def read_step(self, element: Any) -> None:
        self.structure.step = _positive(content_of(element), element, "BaseStepSize")

    def read_algorithm(self, element: Any) -> None:
        _only(element, (), ())
        text = (element.text or "").strip() or ALGORITHMS[0]
        found = {name.lower(): name for name in ALGORITHMS}.get(text.lower())
        if found is None:
            raise InputError(f"{where(element)}: {unknown('Algorithm', text, ALGORITHMS)}")
        self.structure.algorithm = found

    def read_simulators(self, element: Any) -> None:
        _only(element, (), {"Simulator"})
        for one in children(element):
            _only(one, {"name", "source", "stepSize"}, {"InitialValues"})
            name = self._new_name(one)
            step = number(one, "stepSize")
            if step == 0.0:  # libcosim's way to say none
                step = None
            if step is not None:
                _positive(step, one, "stepSize")
            place = f"{where(one)}: simulator {name!r}"
            source, isolated = self._source(needed(one, "source"), place)
            values = _initial_values(child(one, "InitialValues"))
            self.structure.simulators[name] = Simulator(source, isolated, step, values, place)

    def _source(self, text: str, place: str) -> tuple[Path, bool]:
        """Return the path of an FMU, and whether it runs in a process of its own.

        Paths and URIs are relative to the file's folder.
        """
        try:
            parts = urlsplit(text)
        except ValueError:
            raise InputError(f"{place}: source {text!r} is no URI") from None
        proxied = proxied_file(parts)
        plain = parts.scheme in ("", "file") and parts.netloc in ("", "localhost")
        if proxied is None and (parts.query or not plain):
            raise InputError(
                f"{place}: source {text!r}: FMUs at a path, file:///PATH or "
                "proxyfmu://localhost?file=PATH are read"
            )
        path = Path(unquote(parts.path) if proxied is None else proxied)
        if path.suffix != ".fmu":
            raise InputError(f"{place}: source {text!r}: the name of an FMU must end in .fmu")
        return self._folder / path, proxied is not None

    def read_functions(self, element: Any) -> None:
        _only(element, (), {"LinearTransformation", "Sum", "VectorSum"})
        for one in children(element):
            name, kind = self._new_name(one), tag(one)
            self.structure.functions[name] = _function(one, kind)

    def _new_name(self, element: Any) -> str:
        name = needed(element, "name")
        structure = self.structure
        if not name:
            raise InputError(f"{where(element)}: {tag(element)} has an empty name")
        if name in structure.simulators or name in structure.functions:
            raise InputError(f"{where(element)}: a second simulator or function {name!r}")
        if len(structure.simulators) + len(structure.functions) >= _MOST:
            raise InputError(f"{where(element)}: more than {_MOST} simulators and functions")
        return name

    def read_connections(self, element: Any) -> None:
        _only(element, (), set(_ENDS))
        for one in children(element):
            kinds = _ENDS[tag(one)]
            _only(one, {"powerBond"} if kinds[0] == kinds[1] else (), set(kinds))
            found = list(children(one))
            if sorted(map(tag, found)) != sorted(kinds):
                raise InputError(
                    f"{where(one)}: {tag(one)} needs {' and '.join(kinds)}, found "
                    f"{', '.join(map(tag, found)) or 'nothing'}"
                )
            self.structure.connections.append(_connection(one, found))


_ENDS = {
    "VariableConnection": ("Variable", "Variable"),
    "SignalConnection": ("Signal", "Variable"),
    "VariableGroupConnection": ("VariableGroup", "VariableGroup"),
    "SignalGroupConnection": ("SignalGroup", "VariableGroup"),
}
"""What each kind of connection has inside."""

_READERS: dict[str, Callable[[_Reading, Any], None]] = {
    "StartTime": _Reading.read_start,
    "EndTime": _Reading.read_stop,
    "BaseStepSize": _Reading.read_step,
    "Algorithm": _Reading.read_algorithm,
    "Simulators": _Reading.read_simulators,
    "Functions": _Reading.read_functions,
    "Connections": _Reading.read_connections,
}
"""Elements of the file, in the order in which they are read."""


def _connection(element: Any, ends: list[Any]) -> Connection:
    variables, signal = [], None
    for one in ends:
        of_function = tag(one) in ("Signal", "SignalGroup")
        owner = "function" if of_function else "simulator"
        _only(one, {owner, "name"} if of_function else {owner, "name", "causality"}, ())
        end = End(needed(one, owner), needed(one, "name"))
        if of_function:
            signal = end
        else:
            variables.append(end)
    groups = tag(element).endswith("GroupConnection")
    return Connection(tuple(variables), signal, groups, where(element), element.get("powerBond"))


def _function(element: Any, kind: str) -> Transformation | Sum:
    if kind == "LinearTransformation":
        _only(element, {"name", "factor", "offset"}, ())
        factor, offset = number(element, "factor", 1.0), number(element, "offset", 0.0)
        return Transformation(factor, offset, where(element))
    vector = kind == "VectorSum"
    _only(element, {"name", "inputCount", *(["dimension"] if vector else [])}, ())
    inputs = _count(element, "inputCount")
    return Sum(inputs, _count(element, "dimension") if vector else None, where(element))


def _count(element: Any, name: str) -> int:
    needed(element, name)
    value = number(element, name, 0.0)
    if value != int(value) or not 1 <= value <= _MOST:
        raise InputError(
            f"{where(element)}: {name}: a whole number from 1 to {_MOST} is needed, "
            f"found {element.get(name)!r}"
        )
    return int(value)


def _initial_values(element: Any | None) -> dict[str, InitialValue]:
    found: dict[str, InitialValue] = {}
    if element is not None:
        _only(element, (), {"InitialValue"})
    for one in children(element) if element is not None else ():
        _only(one, {"variable"}, set(_TYPES))
        name, values = needed(one, "variable"), list(children(one))
        if len(values) != 1:
            raise InputError(f"{where(one)}: one value of {name!r} is needed, found {len(values)}")
        if name in found:
            raise InputError(f"{where(one)}: a second value of {name!r}")
        _only(values[0], {"value"}, ())
        found[name] = InitialValue(_TYPES[tag(values[0])](values[0]), where(one))
    return found


def _real(element: Any) -> float:
    needed(element, "value")
    return number(element, "value", 0.0)


def _integer(element: Any) -> int:
    text = needed(element, "value")
    try:
        if "_" in text:
            raise ValueError
        return int(text)
    except ValueError:
        message = f"{where(element)}: a whole number is needed, found {text!r}"
        raise InputError(message) from None


_TYPES: dict[str, Callable[[Any], Value]] = {
    "Real": _real,
    "Integer": _integer,
    "Boolean": lambda element: boolean(needed(element, "value"), where(element)),
    "String": lambda element: needed(element, "value"),
}


def content_of(element: Any) -> float:
    """Return the number that an element holds. Raises InputError."""
    _only(element, (), ())
    text = (element.text or "").strip()
    try:
        value = float(text)
        if not abs(value) <= LONGEST_S or "_" in text:
            raise ValueError
    except ValueError:
        raise InputError(
            f"{where(element)}: {tag(element)}: a time in s, at most {LONGEST_S:g}, is needed, "
            f"found {text!r}"
        ) from None
    return value


def _positive(value: float, element: Any, name: str) -> float:
    if not 0.0 < value <= LONGEST_S:
        raise InputError(
            f"{where(element)}: {name}: must be above 0, at most {LONGEST_S:g}, found {value!r}"
        )
    return value
