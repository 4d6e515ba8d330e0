"""Transformations of values: linear, and by tables; and what a chain of them makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from lxml import etree

from seatrial.errors import InputError

from .documents import NAMESPACES, boolean, child, known, needed, number, tag, where
from .notes import Notes

KINDS = {
    f"ssc:{kind}Transformation": kind
    for kind in ("Linear", "BooleanMapping", "IntegerMapping", "EnumerationMapping")
}

NEEDED: dict[str, type] = {
    "Linear": float,
    "BooleanMapping": bool,
    "IntegerMapping": int,
    "EnumerationMapping": int,
}
"""Types of the connectors that each is for."""


@dataclass(frozen=True)
class Transformation:
    """One transformation as a file has it."""

    kind: str = ""
    """A value of `KINDS`; empty: none."""
    factor: float = 1.0
    offset: float = 0.0
    table: Mapping[Any, Any] = field(default_factory=dict)
    """Switches, integers or names of items, by what they become."""
    where: str = ""

    def numbers(self, before: Mapping[str, int], after: Mapping[str, int]) -> Mapping[Any, Any]:
        """Return the table of an enumeration by numbers. Raises InputError.

        ``before`` and ``after`` are the items' values on both sides.
        """
        if self.kind != "EnumerationMapping":
            return self.table
        for side, items in ((self.table.keys(), before), (self.table.values(), after)):
            for name in side:
                if name not in items:
                    known_items = ", ".join(items) or "of an enumeration that nobody defines"
                    raise InputError(
                        f"{self.where}: item {name!r} is not known; the items are {known_items}"
                    )
        return {before[one]: after[other] for one, other in self.table.items()}


NONE = Transformation()


def read_transformation(element: Any, notes: Notes) -> Transformation:
    """Return the transformation of a connection or mapping entry. Raises InputError."""
    found = [one for name in KINDS if (one := child(element, name)) is not None]
    if not found:
        return NONE
    if len(found) > 1:
        raise InputError(f"{where(found[1])}: a second transformation in {tag(element)}")
    one, kind = found[0], KINDS[tag(found[0])]
    if kind == "Linear":
        known(one, {"factor", "offset"}, (), notes)
        numbers = number(one, "factor", 1.0), number(one, "offset", 0.0)
        return Transformation(kind, *numbers, where=where(one))
    known(one, (), {"ssc:MapEntry"}, notes)
    table: dict[Any, Any] = {}
    for entry in one.iterfind(f"{{{NAMESPACES['ssc']}}}MapEntry"):
        known(entry, {"source", "target"}, (), notes)
        source, target = (_entry(entry, side, kind) for side in ("source", "target"))
        if source in table:
            raise InputError(f"{where(entry)}: {source!r} is mapped twice")
        table[source] = target
    return Transformation(kind, table=table, where=where(one))


def _entry(element: Any, side: str, kind: str) -> bool | int | str:
    text = needed(element, side)
    if kind == "BooleanMapping":
        return boolean(text, where(element))
    if kind == "EnumerationMapping":
        return text
    try:
        if "_" in text:
            raise ValueError
        return int(text)
    except ValueError:
        raise InputError(f"{where(element)}: a whole number is needed, found {text!r}") from None


def write_table(parent: Any, table: Mapping[bool | int, bool | int]) -> None:
    """Append the mapping transformation of integers or switches."""
    uri = NAMESPACES["ssc"]
    kind = "Boolean" if all(type(one) is bool for one in table) else "Integer"
    holder = etree.SubElement(parent, f"{{{uri}}}{kind}MappingTransformation")
    for one, other in table.items():
        entry = {"source": str(one).lower(), "target": str(other).lower()}
        etree.SubElement(holder, f"{{{uri}}}MapEntry", entry)


@dataclass(frozen=True)
class Way:
    """What becomes of a value on its way: by the table first, then by factor and offset."""

    table: Mapping[Any, Any] = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0

    @property
    def is_linear(self) -> bool:
        """Say if numbers change by factor and offset."""
        return (self.factor, self.offset) != (1.0, 0.0)

    def then(self, factor: float, offset: float) -> Way:
        """Return this way with a factor and an offset behind it."""
        return replace(self, factor=factor * self.factor, offset=factor * self.offset + offset)

    def mapped(self, table: Mapping[Any, Any], place: str) -> Way:
        """Return this way with a table behind it. Raises InputError behind factor and offset."""
        if self.is_linear:
            raise InputError(f"{place}: a mapping behind a factor or offset is not supported")
        joined = {one: table.get(other, other) for one, other in self.table.items()}
        return replace(self, table={**table, **joined})

    def __call__(self, value: Any) -> Any:
        """Return what becomes of ``value``."""
        if self.table:
            value = self.table.get(value, value)
        return value * self.factor + self.offset if self.is_linear else value
