"""System structure descriptions (``.ssd``) read as they are written: systems in systems."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from ...errors import InputError
from ...units import Unit
from .annotations import StepSizes, read_step_hint, read_steps
from .definitions import Enumerations, Measure, read_enumerations, read_units
from .documents import (
    NAMESPACES,
    check_version,
    child,
    children,
    flag,
    known,
    needed,
    number,
    read_document,
    tag,
    where,
)
from .parameters import KINDS, Parameter, read_parameter_set

FMU = "application/x-fmu-sharedlibrary"
PACKAGE = "application/x-ssp-package"
DEFINITION = "application/x-ssp-definition"

_DRAWN = {
    "ssd:ElementGeometry", "ssd:SystemGeometry", "ssd:ConnectorGeometry",
    "ssd:ConnectionGeometry", "ssd:GraphicalElements",
}  # fmt: skip
_PLAIN = {"ssd:Connector", "ssd:Connection", "ssd:ParameterBinding"}
"""Elements in which no annotation that is read can stand."""
_TYPES = {f"ssc:{kind}" for kind in KINDS}
_SYSTEM = {
    "ssd:Connectors", "ssd:ParameterBindings", "ssd:Elements", "ssd:Connections",
    "ssd:ElementGeometry", "ssd:SystemGeometry", "ssd:GraphicalElements", "ssd:Annotations",
    "ssc:MetaData",
}  # fmt: skip


@dataclass(frozen=True)
class Connector:
    """A connector of a component or system."""

    name: str
    kind: str
    """input, output, parameter, calculatedParameter or inout."""
    type: type | None
    unit: Measure | None
    where: str


@dataclass(frozen=True)
class Connection:
    """A connection; an end without element is a connector of the system itself."""

    start: tuple[str, str]
    end: tuple[str, str]
    factor: float
    offset: float
    converts: bool
    """Units are converted, before factor and offset apply."""
    where: str


@dataclass(frozen=True)
class Component:
    """A reference to an FMU, a package or another system structure description."""

    name: str
    kind: str
    source: Path
    connectors: dict[str, Connector]
    parameters: list[Parameter]
    step: float | None
    where: str


@dataclass(frozen=True)
class System:
    """A system; its parameters are in the order in which later ones win."""

    name: str
    connectors: dict[str, Connector]
    parameters: list[Parameter]
    elements: dict[str, Component | System]
    connections: list[Connection]
    where: str


@dataclass(frozen=True)
class Structure:
    """A whole description."""

    name: str
    system: System
    start: float | None
    stop: float | None
    steps: StepSizes


@dataclass
class Notes:
    """What a reader met and does not use, once each."""

    texts: dict[str, None] = field(default_factory=dict)

    def add(self, text: str) -> None:
        """Keep ``text``."""
        self.texts.setdefault(text)


def read_structure(path: Path, root: Path, label: str, notes: Notes) -> Structure:
    """Read the description at ``path`` in the package unpacked at ``root``.

    ``label`` names the package in messages. Raises InputError for anything in the file that
    could change the result and is not supported; the rest of what is not read goes to ``notes``.
    """
    name = path.relative_to(root).as_posix()
    document = read_document(path, f"{label}: {name}", "ssd:SystemStructureDescription")
    return _Reader(path.parent, root, label, notes).structure(document)


class _Reader:
    """Reads the elements of one description."""

    def __init__(self, folder: Path, root: Path, label: str, notes: Notes) -> None:
        self._folder, self._root, self._label, self._notes = folder, root, label, notes
        self._units: dict[str, Unit] = {}
        self._enumerations: Enumerations = {}

    def structure(self, document: Any) -> Structure:
        parts = {"ssd:System", "ssd:Enumerations", "ssd:Units", "ssd:DefaultExperiment"}
        known(document, {"version", "name"}, {*parts, "ssd:Annotations", "ssc:MetaData"})
        self._units = read_units(document, "ssd:Units")
        self._enumerations = read_enumerations(document, "ssd:Enumerations")
        top = child(document, "ssd:System")
        if top is None:
            raise InputError(f"{where(document)}: there is no ssd:System")
        experiment = child(document, "ssd:DefaultExperiment")
        start = stop = None
        if experiment is not None:
            known(experiment, {"startTime", "stopTime"}, {"ssd:Annotations"})
            start, stop = number(experiment, "startTime"), number(experiment, "stopTime")
        steps = read_steps(experiment, top, self._notes.add)
        for nested in top.iterdescendants(f"{{{NAMESPACES['ssd']}}}System"):
            if child(nested, "ssd:Annotations") is not None:
                self._notes.add("annotations of systems inside the system are not read")
        system = self._system(top)
        return Structure(needed(document, "name"), system, start, stop, steps)

    def _system(self, element: Any) -> System:
        self._read_only(element, {"name"}, _SYSTEM)
        elements: dict[str, Component | System] = {}
        for one in self._listed(element, "ssd:Elements", {"ssd:Component", "ssd:System"}):
            read = self._component(one) if tag(one) == "ssd:Component" else self._system(one)
            if read.name in elements:
                raise InputError(f"{read.where}: a second element is called {read.name!r}")
            elements[read.name] = read
        connections = self._listed(element, "ssd:Connections", {"ssd:Connection"})
        return System(
            needed(element, "name"),
            self._connectors(element),
            self._parameters(element),
            elements,
            [self._connection(one) for one in connections],
            where(element),
        )

    def _component(self, element: Any) -> Component:
        parts = {"ssd:Connectors", "ssd:ParameterBindings", "ssd:ElementGeometry"}
        self._read_only(
            element,
            {"name", "type", "source", "implementation"},
            {*parts, "ssd:Annotations", "ssc:MetaData"},
        )
        kind = element.get("type", FMU)
        if kind not in (FMU, PACKAGE, DEFINITION):
            raise InputError(
                f"{where(element)}: components of type {kind!r} are not supported "
                f"(read are: {FMU}, {PACKAGE}, {DEFINITION})"
            )
        implementation = element.get("implementation", "any")
        if implementation not in ("any", "CoSimulation"):
            raise InputError(f"{where(element)}: {implementation} is not supported")
        return Component(
            needed(element, "name"),
            kind,
            self._source(element),
            self._connectors(element),
            self._parameters(element),
            read_step_hint(element, self._notes.add),
            where(element),
        )

    def _connectors(self, element: Any) -> dict[str, Connector]:
        found: dict[str, Connector] = {}
        for one in self._listed(element, "ssd:Connectors", {"ssd:Connector"}):
            self._read_only(
                one,
                {"name", "kind"},
                {*_TYPES, "ssd:ConnectorGeometry", "ssd:Annotations", "ssc:MetaData"},
            )
            name, kind, python, unit = needed(one, "name"), needed(one, "kind"), None, None
            for typed in (c for c in children(one) if tag(c) in _TYPES):
                known(typed, {"unit", "name", "mime-type"}, ())
                python = KINDS[tag(typed).partition(":")[2]]
                unit = self._units.get(typed.get("unit"), typed.get("unit"))
            if name in found:
                raise InputError(f"{where(one)}: a second connector is called {name!r}")
            found[name] = Connector(name, kind, python, unit, where(one))
        return found

    def _connection(self, element: Any) -> Connection:
        transformation = "ssc:LinearTransformation"
        self._read_only(
            element,
            {"startElement", "startConnector", "endElement", "endConnector",
             "suppressUnitConversion"},
            {transformation, "ssd:ConnectionGeometry", "ssd:Annotations", "ssc:MetaData"},
        )  # fmt: skip
        factor, offset = 1.0, 0.0
        linear = child(element, transformation)
        if linear is not None:
            known(linear, {"factor", "offset"}, ())
            factor = number(linear, "factor", 1.0)
            offset = number(linear, "offset", 0.0)
        return Connection(
            (element.get("startElement", ""), needed(element, "startConnector")),
            (element.get("endElement", ""), needed(element, "endConnector")),
            factor,
            offset,
            not flag(element, "suppressUnitConversion"),
            where(element),
        )

    def _parameters(self, element: Any) -> list[Parameter]:
        found = []
        for one in self._listed(element, "ssd:ParameterBindings", {"ssd:ParameterBinding"}):
            self._read_only(
                one,
                {"type", "source", "sourceBase", "prefix"},
                {"ssd:ParameterValues", "ssd:Annotations", "ssc:MetaData"},
            )
            kind = one.get("type", "application/x-ssp-parameter-set")
            if kind != "application/x-ssp-parameter-set":
                raise InputError(f"{where(one)}: parameters of type {kind!r} are not supported")
            if one.get("sourceBase", "SSD") != "SSD":
                raise InputError(
                    f"{where(one)}: sourceBase={one.get('sourceBase')!r} is not supported"
                )
            sets = self._parameter_set(one)
            found += read_parameter_set(sets, self._enumerations, one.get("prefix", ""))
        return found

    def _parameter_set(self, binding: Any) -> Any:
        """Return the parameter set of a binding: of its file, or inline."""
        inline = child(binding, "ssd:ParameterValues")
        if (inline is None) == (binding.get("source") is None):
            raise InputError(f"{where(binding)}: either a source or ParameterValues is needed")
        if inline is None:
            path = self._source(binding)
            name = path.relative_to(self._root).as_posix()
            return read_document(path, f"{self._label}: {name}", "ssv:ParameterSet")
        known(inline, (), {"ssv:ParameterSet"})
        sets = list(children(inline))
        if len(sets) != 1:
            raise InputError(f"{where(inline)}: one ParameterSet is needed, found {len(sets)}")
        check_version(sets[0], "ssv:ParameterSet")
        return sets[0]

    def _source(self, element: Any) -> Path:
        """Return the file that ``source`` names, in the package. Raises InputError."""
        written = needed(element, "source")
        try:
            uri = urlsplit(written)
        except ValueError as error:
            raise InputError(f"{where(element)}: source {written!r}: {error}") from None
        if uri.scheme or uri.netloc or uri.path.startswith("/"):
            raise InputError(
                f"{where(element)}: source {written!r}: only files in the package are read"
            )
        if uri.fragment or uri.query or not uri.path:
            raise InputError(f"{where(element)}: source {written!r}: a plain path is needed")
        if "\0" in unquote(uri.path):
            raise InputError(f"{where(element)}: source {written!r} is no path")
        path = (self._folder / unquote(uri.path)).resolve()
        if not path.is_relative_to(self._root.resolve()):
            raise InputError(f"{where(element)}: source {written!r} is outside the package")
        try:
            found = path.is_file()
        except OSError as error:
            message = f"{where(element)}: source {written!r}: {error.strerror}"
            raise InputError(message) from None
        if not found:
            raise InputError(f"{where(element)}: source {written!r}: there is no such file")
        return path

    def _listed(self, element: Any, name: str, allowed: set[str]) -> list[Any]:
        """Return the children of the child ``name``, which holds only ``allowed``."""
        listed = child(element, name)
        if listed is None:
            return []
        known(listed, (), allowed)
        return list(children(listed))

    def _read_only(self, element: Any, attributes: set[str], elements: set[str]) -> None:
        known(element, attributes, elements)
        for one in children(element):
            if tag(one) in _DRAWN:
                self._notes.add("geometry and drawings are not read")
            elif tag(one) == "ssc:MetaData":
                self._notes.add("metadata is not read")
            elif tag(one) == "ssd:Annotations" and tag(element) in _PLAIN:
                self._notes.add(f"annotations of {tag(element)} are not read")
