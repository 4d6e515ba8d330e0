"""Parameter bindings of components and systems: their parameter sets, mapped and with prefix."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from seatrial.errors import InputError

from .definitions import Enumerations
from .documents import checked, child, flag, known, listed, needed, read_document, where
from .notes import Notes
from .package import Package, Sources
from .parameters import Item, Parameter, Value, read_parameter_set
from .transformations import KINDS, Transformation, read_transformation

_SET = "application/x-ssp-parameter-set"
_MAPPING = "application/x-ssp-parameter-mapping"


Inside = Callable[[], Package]
"""Finds what a component refers to. Raises InputError."""


@dataclass(frozen=True)
class BindingsReader:
    """Reads the bindings of one description."""

    sources: Sources
    enumerations: Enumerations
    notes: Notes

    def read(self, element: Any, inside: Inside | None = None) -> list[Parameter]:
        """Return the parameters of an element's bindings; later ones win.

        ``inside`` is for a component, whose bindings may have files in it. Raises InputError.
        """
        bindings = listed(element, "ssd:ParameterBindings", {"ssd:ParameterBinding"}, self.notes)
        return [parameter for one in bindings for parameter in self._binding(one, inside)]

    def _binding(self, element: Any, inside: Inside | None) -> list[Parameter]:
        known(
            element,
            {"type", "source", "sourceBase", "prefix"},
            {"ssd:ParameterValues", "ssd:ParameterMapping", "ssd:Annotations"},
            self.notes,
        )
        _refuse_other(element, _SET, "parameters")
        values = child(element, "ssd:ParameterValues")
        if values is not None:
            known(values, (), {"ssv:ParameterSet"}, self.notes)
        root = self._content(element, values, "ssv:ParameterSet", inside)
        prefix = element.get("prefix", "")
        found = read_parameter_set(root, self.enumerations, self.notes, prefix)
        mapping = child(element, "ssd:ParameterMapping")
        return (
            found if mapping is None else mapped(found, self._mapping(mapping, inside), self.notes)
        )

    def _mapping(self, element: Any, inside: Inside | None) -> list[Entry]:
        known(
            element,
            {"type", "source", "sourceBase"},
            {"ssm:ParameterMapping", "ssd:Annotations"},
            self.notes,
        )
        _refuse_other(element, _MAPPING, "mappings")
        root = self._content(element, element, "ssm:ParameterMapping", inside)
        return read_mapping(root, self.notes)

    def _content(self, element: Any, holder: Any | None, kind: str, inside: Inside | None) -> Any:
        """Return what an element refers to: of its file, or what ``holder`` has inline."""
        inline = None if holder is None else child(holder, kind)
        if (inline is None) == (not element.get("source")):
            raise InputError(f"{where(element)}: either a source or an inline {kind} is needed")
        if inline is not None:
            return checked(inline, kind, self.notes)
        sources = self._sources(element, inside)
        path = sources.file(element)
        return read_document(path, sources.package.shown(path), kind, self.notes)

    def _sources(self, element: Any, inside: Inside | None) -> Sources:
        """Return what the source of an element is relative to."""
        base = element.get("sourceBase", "SSD")
        if base == "SSD":
            return self.sources
        if base != "component" or inside is None:
            of = "SSD or component" if inside else "SSD, outside a component,"
            raise InputError(f"{where(element)}: sourceBase: {of} is needed, found {base!r}")
        package = inside()
        return Sources(package.folder, package)


def _refuse_other(element: Any, kind: str, what: str) -> None:
    """Raise InputError for a format that is none of SSP's."""
    found = element.get("type", kind)
    if found != kind:
        raise InputError(
            f"{where(element)}: {what} of type {found!r} are not supported (read are: {kind})"
        )


_ENTRY = "ssm:MappingEntry"


@dataclass(frozen=True)
class Entry:
    """One entry: which parameter becomes which, and how."""

    source: str
    target: str
    transformation: Transformation
    converts: bool
    where: str


def read_mapping(root: Any, notes: Notes) -> list[Entry]:
    """Return the entries of an ``ssm:ParameterMapping``. Raises InputError."""
    known(root, {"version"}, {_ENTRY, "ssm:Annotations"}, notes)
    return [_entry(one, notes) for one in root.iterfind("{*}MappingEntry")]


def _entry(element: Any, notes: Notes) -> Entry:
    known(
        element, {"source", "target", "suppressUnitConversion"}, {*KINDS, "ssm:Annotations"}, notes
    )
    return Entry(
        needed(element, "source"),
        needed(element, "target"),
        read_transformation(element, notes),
        not flag(element, "suppressUnitConversion"),
        where(element),
    )


def mapped(
    parameters: Sequence[Parameter], entries: Sequence[Entry], notes: Notes
) -> list[Parameter]:
    """Return the parameters that ``entries`` name, as they are called and valued behind them.

    Raises InputError for two parameters with one name behind them.
    """
    by_name = {parameter.name: parameter for parameter in parameters}
    found: dict[str, Parameter] = {}
    for entry in entries:
        if entry.source not in by_name:
            if entry.source:
                missing = f"the parameter set has no {entry.source!r} to map"
                notes.add(f"{entry.where}: {missing}")
            continue
        if entry.target in found:
            raise InputError(f"{entry.where}: a second parameter is mapped to {entry.target!r}")
        found[entry.target] = _behind(by_name[entry.source], entry)
    return list(found.values())


def _behind(parameter: Parameter, entry: Entry) -> Parameter:
    """Return a parameter as it is behind an entry. Raises InputError."""
    made = entry.transformation
    values = tuple(_value(value, made) for value in parameter.values)
    named = replace(parameter, name=entry.target, values=values, converts=entry.converts)
    return replace(named, factor=made.factor, offset=made.offset) if made.kind else named


def _value(value: Value | Item, made: Transformation) -> Value | Item:
    """Return a value behind a table, or before a factor and an offset. Raises InputError."""
    if made.kind == "Linear":
        if type(value) is not float:
            raise InputError(f"{made.where}: a real number is needed, found {_shown(value)}")
        return value
    if made.kind == "EnumerationMapping":
        if not isinstance(value, Item):
            raise InputError(f"{made.where}: an enumeration is needed, found {_shown(value)}")
        other = made.table.get(value.name)
        return value if other is None else Item(other, None)
    if made.kind:
        if isinstance(value, Item):
            value = value.name if value.number is None else value.number
        wanted = bool if made.kind == "BooleanMapping" else int
        if type(value) is not wanted:
            kind = "a Boolean" if wanted is bool else "an integer"
            raise InputError(f"{made.where}: {kind} is needed, found {_shown(value)}")
        result: Value = made.table.get(value, value)
        return result
    return value


def _shown(value: Value | Item) -> str:
    return f"item {value.name!r}" if isinstance(value, Item) else repr(value)
