"""Parameter bindings of components and systems: their parameter sets, mapped and with prefix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from seatrial.errors import InputError

from .definitions import Enumerations
from .documents import checked, child, known, listed, read_document, where
from .mapping import Entry, mapped, read_mapping
from .notes import Notes
from .package import Package
from .parameters import Parameter, read_parameter_set
from .sources import Sources

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
