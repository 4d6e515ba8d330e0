"""System structure descriptions (``.ssd``) read as they are written: systems in systems."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from seatrial.errors import InputError

from .annotations import read_step_hint, read_steps
from .bindings import BindingsReader
from .connectors import ConnectorsReader
from .definitions import read_enumerations, read_units
from .documents import (
    NAMESPACES,
    checked,
    child,
    children,
    flag,
    known,
    listed,
    needed,
    number,
    read_document,
    tag,
    where,
)
from .model import (
    DEEPEST,
    DEFINITION,
    FMU,
    MOST_SYSTEMS,
    PACKAGE,
    TABLES,
    Component,
    Connection,
    Dictionary,
    End,
    Indices,
    Reference,
    Source,
    Structure,
    System,
)
from .notes import Notes
from .package import Package, Sources, package_inside
from .transformations import KINDS, read_transformation

_DRAWN = {
    "ssd:ElementGeometry", "ssd:SystemGeometry", "ssd:ConnectionGeometry",
    "ssd:GraphicalElements",
}  # fmt: skip
_PLAIN = {"ssd:Connection", "ssd:SignalDictionaryReference"}
"""Elements in which no annotation that is read can stand."""
_SYSTEM = {
    "ssd:Connectors", "ssd:ParameterBindings", "ssd:Elements", "ssd:Connections",
    "ssd:SignalDictionaries", "ssd:ElementGeometry", "ssd:SystemGeometry",
    "ssd:GraphicalElements", "ssd:Annotations",
}  # fmt: skip
_ELEMENTS = {"ssd:Component", "ssd:System", "ssd:SignalDictionaryReference"}
_IMPLEMENTATIONS = ("any", "CoSimulation", "ModelExchange", "ScheduledExecution")


def read_structure(path: Path, package: Package, notes: Notes) -> Structure:
    """Read the description at ``path`` in a package.

    Raises InputError for anything in the file that could change the result and is not supported;
    the rest of what is not read goes to ``notes``.
    """
    document = read_document(path, package.shown(path), "ssd:SystemStructureDescription", notes)
    return _Reader(document, Sources(path.parent, package), notes).structure()


class _Reader:
    """Reads the elements of one description."""

    def __init__(self, document: Any, sources: Sources, notes: Notes) -> None:
        self._document, self._sources, self._notes = document, sources, notes
        units = read_units(document, "ssd:Units", notes)
        enumerations = read_enumerations(document, "ssd:Enumerations", notes)
        self._bindings = BindingsReader(sources, enumerations, notes)
        self._connectors = ConnectorsReader(units, enumerations, notes)
        self._around: list[Any] = []
        """Systems that are being read because a component refers to them by their id."""
        self._systems = 0

    def structure(self) -> Structure:
        document = self._document
        parts = {"ssd:System", "ssd:Enumerations", "ssd:Units", "ssd:DefaultExperiment"}
        known(document, {"version", "name"}, {*parts, "ssd:Annotations"}, self._notes)
        top = child(document, "ssd:System")
        if top is None:
            raise InputError(f"{where(document)}: there is no ssd:System")
        experiment = child(document, "ssd:DefaultExperiment")
        start = stop = None
        if experiment is not None:
            known(experiment, {"startTime", "stopTime"}, {"ssd:Annotations"}, self._notes)
            start, stop = number(experiment, "startTime"), number(experiment, "stopTime")
        steps = read_steps(experiment, top, self._notes)
        for nested in top.iterdescendants(f"{{{NAMESPACES['ssd']}}}System"):
            if child(nested, "ssd:Annotations") is not None:
                self._notes.pass_over(
                    where(nested), "annotations of systems inside the system are not read"
                )
        return Structure(needed(document, "name"), self._system(top), start, stop, steps)

    def _system(self, element: Any) -> System:
        self._systems += 1
        if self._systems > MOST_SYSTEMS or len(self._around) > DEEPEST:
            raise InputError(
                f"{where(element)}: more than {MOST_SYSTEMS} systems, or deeper than {DEEPEST}"
            )
        self._read_only(element, {"name"}, _SYSTEM)
        elements: dict[str, Component | System | Reference] = {}
        for one in listed(element, "ssd:Elements", _ELEMENTS, self._notes):
            read = self._element(one)
            if read.name in elements:
                raise InputError(f"{read.where}: a second element is called {read.name!r}")
            elements[read.name] = read
        connections = listed(element, "ssd:Connections", {"ssd:Connection"}, self._notes)
        return System(
            needed(element, "name"),
            self._connectors.connectors(element),
            self._bindings.read(element),
            elements,
            [self._connection(one) for one in connections],
            where(element),
            self._dictionaries(element),
        )

    def _element(self, element: Any) -> Component | System | Reference:
        if tag(element) == "ssd:System":
            return self._system(element)
        return (
            self._component(element)
            if tag(element) == "ssd:Component"
            else self._reference(element)
        )

    def _component(self, element: Any) -> Component:
        parts = {"ssd:Connectors", "ssd:ParameterBindings", "ssd:ElementGeometry"}
        self._read_only(
            element, {"name", "type", "source", "implementation"}, {*parts, "ssd:Annotations"}
        )
        kind = element.get("type", FMU)
        implementation = element.get("implementation", "any")
        if implementation not in _IMPLEMENTATIONS:
            raise InputError(
                f"{where(element)}: implementation: one of {', '.join(_IMPLEMENTATIONS)} is "
                f"needed, found {implementation!r}"
            )
        source, inner = self._referred(element, kind)
        label, place = self._sources.package.label, where(element)
        return Component(
            needed(element, "name"),
            kind,
            source,
            inner,
            implementation,
            self._connectors.connectors(element),
            self._bindings.read(element, lambda: package_inside(kind, source.file, label, place)),
            read_step_hint(element, self._notes),
            place,
        )

    def _referred(self, element: Any, kind: str) -> tuple[Source, System | None]:
        """Return what a component refers to, which may be a system of this description."""
        if element.get("source") is None:
            self._notes.pass_over(
                where(element), "a component without source is an empty system: nothing computes it"
            )
            return Source(None, ""), None
        kinds = (FMU, PACKAGE, DEFINITION, *TABLES)
        if kind not in kinds:
            raise InputError(
                f"{where(element)}: components of type {kind!r} are not supported "
                f"(read are: {', '.join(kinds)})"
            )
        source = self._sources.source(element)
        if source.file is None:
            return source, self._same_document(element, source.fragment)
        if (source.fragment and kind != PACKAGE) or (source.isolated and kind != FMU):
            written = element.get("source")
            raise InputError(
                f"{where(element)}: source {written!r}: a plain path is needed: only packages "
                "have variants, only FMUs are run by a proxy"
            )
        return source, None

    def _same_document(self, element: Any, fragment: str) -> System:
        """Return the system of this description that has the id ``fragment``."""
        systems = self._document.iter(f"{{{NAMESPACES['ssd']}}}System")
        found = [one for one in systems if one.get("id") == fragment]
        if len(found) != 1:
            raise InputError(
                f"{where(element)}: source '#{fragment}': one system with this id is needed, "
                f"found {len(found)}"
            )
        if found[0] in self._around or found[0] in element.iterancestors():
            raise InputError(f"{where(element)}: #{fragment} refers to itself")
        self._around.append(found[0])
        system = self._system(found[0])
        self._around.pop()
        return system

    def _reference(self, element: Any) -> Reference:
        parts = {"ssd:Connectors", "ssd:ElementGeometry", "ssd:Annotations"}
        self._read_only(element, {"name", "dictionary"}, parts)
        connectors = self._connectors.connectors(element)
        dictionary = needed(element, "dictionary")
        return Reference(needed(element, "name"), dictionary, connectors, where(element))

    def _dictionaries(self, element: Any) -> dict[str, Dictionary]:
        found: dict[str, Dictionary] = {}
        for one in listed(element, "ssd:SignalDictionaries", {"ssd:SignalDictionary"}, self._notes):
            known(one, {"name", "type", "source"}, {"ssb:SignalDictionary"}, self._notes)
            name, kind = needed(one, "name"), one.get("type", "application/x-ssp-signal-dictionary")
            if kind != "application/x-ssp-signal-dictionary":
                raise InputError(f"{where(one)}: dictionaries of type {kind!r} are not supported")
            if name in found:
                raise InputError(f"{where(one)}: a second dictionary is called {name!r}")
            found[name] = Dictionary(name, self._signals(one), where(one))
        return found

    def _signals(self, element: Any) -> Any:
        inline, root = child(element, "ssb:SignalDictionary"), "ssb:SignalDictionary"
        if (inline is None) == (not element.get("source")):
            raise InputError(f"{where(element)}: either a source or an inline {root} is needed")
        if inline is None:
            path = self._sources.file(element)
            inline = read_document(path, self._sources.package.shown(path), root, self._notes)
        else:
            checked(inline, root, self._notes)
        parts = {"ssb:DictionaryEntry", "ssb:Enumerations", "ssb:Units", "ssb:Annotations"}
        known(inline, {"version"}, parts, self._notes)
        units = read_units(inline, "ssb:Units", self._notes)
        enumerations = read_enumerations(inline, "ssb:Enumerations", self._notes)
        return ConnectorsReader(units, enumerations, self._notes).signals(inline)

    def _connection(self, element: Any) -> Connection:
        ends = {f"{side}{what}" for side in ("start", "end") for what in _OF_ENDS}
        self._read_only(
            element,
            {*ends, "suppressUnitConversion"},
            {*KINDS, "ssd:ConnectionGeometry", "ssd:Annotations"},
        )
        return Connection(
            _end(element, "start"),
            _end(element, "end"),
            read_transformation(element, self._notes),
            not flag(element, "suppressUnitConversion"),
            where(element),
        )

    def _read_only(self, element: Any, attributes: set[str], elements: set[str]) -> None:
        known(element, attributes, elements, self._notes)
        for one in children(element):
            if tag(one) in _DRAWN:
                self._notes.pass_over(where(one), "geometry and drawings are not read")
            elif tag(one) == "ssd:Annotations" and tag(element) in _PLAIN:
                self._notes.pass_over(where(one), f"annotations of {tag(element)} are not read")


_OF_ENDS = ("Element", "Connector", "Indices")


def _end(element: Any, side: str) -> End:
    indices = element.get(f"{side}Indices")
    return End(
        element.get(f"{side}Element", ""),
        needed(element, f"{side}Connector"),
        None if indices is None else _indices(element, indices),
    )


def _indices(element: Any, text: str) -> Indices:
    words = text.split()
    if not words or not all(word.isascii() and word.isdigit() for word in words):
        raise InputError(f"{where(element)}: indices: whole numbers are needed, found {text!r}")
    return tuple(map(int, words))
