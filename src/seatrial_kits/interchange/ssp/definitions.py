"""Unit and enumeration definitions of SSP files, read and written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml import etree

from seatrial.errors import InputError
from seatrial.model.units import Unit, conversion, defined_unit

from .documents import NAMESPACES, child, known, listed, needed, number, where
from .notes import Notes

_EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

Measure = Unit | str
"""A unit that a file defines, or the name of one."""
Enumerations = Mapping[str, Mapping[str, int]]


def read_units(parent: Any, name: str, notes: Notes) -> dict[str, Unit]:
    """Return the definitions in ``name`` (``ssd:Units``) of ``parent``. Raises InputError."""
    units = {}
    for element in listed(parent, name, {"ssc:Unit"}, notes):
        known(element, {"name"}, {"ssc:BaseUnit", "ssc:Annotations"}, notes)
        text = needed(element, "name")
        bases = child(element, "ssc:BaseUnit")
        if bases is None:
            raise InputError(f"{where(element)}: unit {text!r} has no BaseUnit")
        known(bases, {*_EXPONENTS, "factor", "offset"}, (), notes)
        factor, offset = number(bases, "factor", 1.0), number(bases, "offset", 0.0)
        exponents = {base: _exponent(bases, base) for base in _EXPONENTS}
        try:
            units[text] = defined_unit(text, exponents, factor, offset)
        except InputError as error:
            raise InputError(f"{where(bases)}: {error}") from None
    return units


def measured(element: Any, units: Mapping[str, Unit], notes: Notes) -> Measure | None:
    """Return what the attribute ``unit`` of ``element`` means, None for nothing.

    Some tools write ``[m]`` and define ``m``.
    """
    text = element.get("unit") or None
    if text is None or text in units:
        return None if text is None else units[text]
    inner = text[1:-1]
    if text == f"[{inner}]" and inner in units:
        notes.pass_over(where(element), f"unit {text!r} is not defined; it is read as {inner!r}")
        return units[inner]
    return str(text)


def _exponent(element: Any, name: str) -> int:
    value = number(element, name, 0.0)
    if value != int(value):
        raise InputError(f"{where(element)}: {name}: a whole number is needed, found {value!r}")
    return int(value)


def converted(source: Measure, target: Measure, place: str) -> tuple[float, float]:
    """Return (factor, offset) from ``source`` to ``target``; InputError names ``place``."""
    try:
        return conversion(source, target)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def write_enumerations(parent: Any, used: Enumerations) -> None:
    """Append ``ssd:Enumerations`` with the items of enumerations by name, if there are any."""
    if not used:
        return
    holder = etree.SubElement(parent, f"{{{NAMESPACES['ssd']}}}Enumerations")
    for name, items in sorted(used.items()):
        element = etree.SubElement(holder, f"{{{NAMESPACES['ssc']}}}Enumeration", name=name)
        for item, value in items.items():
            attributes = {"name": item, "value": str(value)}
            etree.SubElement(element, f"{{{NAMESPACES['ssc']}}}Item", attributes)


def write_units(parent: Any, used: Mapping[str, Unit]) -> None:
    """Append ``ssd:Units`` with the definitions of units by name, if there are any."""
    if not used:
        return
    holder = etree.SubElement(parent, f"{{{NAMESPACES['ssd']}}}Units")
    for text, one in sorted(used.items()):
        element = etree.SubElement(holder, f"{{{NAMESPACES['ssc']}}}Unit", name=text)
        attributes = {base: str(power) for base, power in one.exponents.items()}
        if one.factor != 1.0:
            attributes["factor"] = repr(one.factor)
        if one.offset != 0.0:
            attributes["offset"] = repr(one.offset)
        etree.SubElement(element, f"{{{NAMESPACES['ssc']}}}BaseUnit", attributes)


def read_enumerations(parent: Any, name: str, notes: Notes) -> dict[str, dict[str, int]]:
    """Return {enumeration: {item: value}} of ``name`` in ``parent``. Raises InputError."""
    found: dict[str, dict[str, int]] = {}
    for element in listed(parent, name, {"ssc:Enumeration"}, notes):
        known(element, {"name"}, {"ssc:Item", "ssc:Annotations"}, notes)
        items = found.setdefault(needed(element, "name"), {})
        for item in element.iterfind(f"{{{NAMESPACES['ssc']}}}Item"):
            if item.get("value") is not None:
                items[needed(item, "name")] = _exponent(item, "value")
    return found
