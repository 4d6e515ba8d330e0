"""Connectors of elements and signals of dictionaries, read from their XML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from seatrial.errors import InputError
from seatrial.model.units import Unit

from .definitions import Enumerations, measured
from .documents import NAMESPACES, children, known, listed, needed, tag, where
from .model import Connector
from .notes import Notes
from .parameters import KINDS

_KINDS = {
    "input", "output", "parameter", "calculatedParameter", "structuralParameter", "inout",
    "constant", "local", "unspecified",
}  # fmt: skip
_TYPES = {f"ssc:{kind}" for kind in (*KINDS, "Clock")}
_OF_TYPES = {"unit", "name", "mime-type"}
_OF_CLOCKS = {
    "intervalVariability", "intervalDecimal", "shiftDecimal", "supportsFraction", "resolution",
    "intervalCounter", "shiftCounter", "priority",
}  # fmt: skip
_PARTS = {*_TYPES, "ssc:Dimension"}


@dataclass(frozen=True)
class ConnectorsReader:
    """Reads the connectors of one file, with the units and enumerations that it defines."""

    units: Mapping[str, Unit]
    enumerations: Enumerations
    notes: Notes

    def connectors(self, element: Any) -> dict[str, Connector]:
        """Return the connectors of an element by name. Raises InputError."""
        found: dict[str, Connector] = {}
        for one in listed(element, "ssd:Connectors", {"ssd:Connector"}, self.notes):
            drawn = {"ssd:ConnectorGeometry", "ssd:Annotations", "ssd:Clock"}
            known(one, {"name", "kind"}, {*_PARTS, *drawn}, self.notes)
            for each in children(one):
                if tag(each) in drawn:
                    self.notes.pass_over(where(one), f"{tag(each)} of ssd:Connector is not read")
            kind = needed(one, "kind")
            if kind not in _KINDS:
                kinds = ", ".join(sorted(_KINDS))
                raise InputError(f"{where(one)}: kind: one of {kinds} is needed, found {kind!r}")
            _add(found, self._typed(one, kind))
        return found

    def signals(self, element: Any) -> dict[str, Connector]:
        """Return the entries of a signal dictionary by name. Raises InputError."""
        found: dict[str, Connector] = {}
        for one in element.iterfind(f"{{{NAMESPACES['ssb']}}}DictionaryEntry"):
            known(one, {"name"}, {*_PARTS, "ssb:Annotations"}, self.notes)
            _add(found, self._typed(one, "inout"))
        return found

    def _typed(self, element: Any, kind: str) -> Connector:
        python, unit, items, is_clock = None, None, dict[str, int](), False
        types = [one for one in children(element) if tag(one) in _TYPES]
        if len(types) > 1:
            raise InputError(f"{where(types[1])}: a second type in {tag(element)}")
        for one in types:
            is_clock = tag(one) == "ssc:Clock"
            known(one, _OF_CLOCKS if is_clock else _OF_TYPES, (), self.notes)
            python = None if is_clock else KINDS[tag(one).partition(":")[2]]
            unit = measured(one, self.units, self.notes)
            items = dict(self.enumerations.get(one.get("name", ""), {}))
        dimensions = element.iterfind(f"{{{NAMESPACES['ssc']}}}Dimension")
        sizes = tuple(self._size(one) for one in dimensions)
        name = needed(element, "name")
        return Connector(name, kind, python, unit, items, sizes, is_clock, where(element))

    def _size(self, dimension: Any) -> int | None:
        known(dimension, {"size", "sizeConnector"}, (), self.notes)
        text = dimension.get("size")
        if text is None:
            return None
        if not text.isascii() or not text.isdigit():
            raise InputError(f"{where(dimension)}: size: a whole number is needed, found {text!r}")
        return int(text)


def _add(found: dict[str, Connector], one: Connector) -> None:
    if one.name in found:
        raise InputError(f"{one.where}: a second connector is called {one.name!r}")
    found[one.name] = one
