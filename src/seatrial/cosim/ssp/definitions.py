"""Unit and enumeration definitions of SSP files, read and written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml import etree

from ...errors import InputError
from ...units import Unit, conversion, defined_unit
from .documents import NAMESPACES, child, children, known, needed, number, where

_EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

Measure = Unit | str
"""A unit that a file defines, or the name of one."""
Enumerations = Mapping[str, Mapping[str, int]]


def read_units(parent: Any, name: str) -> dict[str, Unit]:
    """Return the definitions in ``name`` (``ssd:Units``) of ``parent``. Raises InputError."""
    units = {}
    listed = child(parent, name)
    for element in children(listed) if listed is not None else ():
        known(element, {"name"}, {"ssc:BaseUnit", "ssc:Annotations"})
        text = needed(element, "name")
        bases = child(element, "ssc:BaseUnit")
        if bases is None:
            raise InputError(f"{where(element)}: unit {text!r} has no BaseUnit")
        known(bases, {*_EXPONENTS, "factor", "offset"}, ())
        factor, offset = number(bases, "factor", 1.0), number(bases, "offset", 0.0)
        exponents = {base: _exponent(bases, base) for base in _EXPONENTS}
        try:
            units[text] = defined_unit(text, exponents, factor, offset)
        except InputError as error:
            raise InputError(f"{where(bases)}: {error}") from None
    return units


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


def write_units(parent: Any, used: Mapping[str, Unit]) -> None:
    """Append ``ssd:Units`` with the definitions of units by name, if there are any."""
    if not used:
        return
    listed = etree.SubElement(parent, f"{{{NAMESPACES['ssd']}}}Units")
    for text, one in sorted(used.items()):
        element = etree.SubElement(listed, f"{{{NAMESPACES['ssc']}}}Unit", name=text)
        attributes = {base: str(power) for base, power in one.exponents.items()}
        if one.factor != 1.0:
            attributes["factor"] = repr(one.factor)
        if one.offset != 0.0:
            attributes["offset"] = repr(one.offset)
        etree.SubElement(element, f"{{{NAMESPACES['ssc']}}}BaseUnit", attributes)


def read_enumerations(parent: Any, name: str) -> dict[str, dict[str, int]]:
    """Return {enumeration: {item: value}} of ``name`` in ``parent``. Raises InputError."""
    listed = child(parent, name)
    found: dict[str, dict[str, int]] = {}
    for element in children(listed) if listed is not None else ():
        known(element, {"name"}, {"ssc:Item", "ssc:Annotations"})
        items = found.setdefault(needed(element, "name"), {})
        for item in children(element):
            if item.get("value") is not None:
                items[needed(item, "name")] = _exponent(item, "value")
    return found
