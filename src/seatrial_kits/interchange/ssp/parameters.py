"""Parameter sets of SSP (``.ssv`` files, or inline), read and written."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lxml import etree

from seatrial.errors import InputError
from seatrial.model.ports import Scalar
from seatrial.model.units import Unit

from .definitions import Enumerations, Measure, measured, read_enumerations, read_units
from .documents import (
    NAMESPACES,
    boolean,
    child,
    children,
    finite,
    known,
    listed,
    needed,
    tag,
    where,
)
from .notes import Notes

Value = Scalar | bytes

KINDS: dict[str, type] = {
    "Real": float,
    "Float64": float,
    "Float32": float,
    **dict.fromkeys(("Integer", "Int8", "Int16", "Int32", "Int64", "Enumeration"), int),
    **dict.fromkeys(("UInt8", "UInt16", "UInt32", "UInt64"), int),
    "Boolean": bool,
    "String": str,
    "Binary": bytes,
}
"""Types of SSP 1.0 and 2.0, and what they are here."""


@dataclass(frozen=True)
class Written:
    """A value to write, or those of an array, row by row."""

    type: str
    values: Sequence[Value]
    sizes: Sequence[int] = ()


@dataclass(frozen=True)
class Item:
    """A value of an enumeration: the number is what the file of the parameter set says."""

    name: str
    number: int | None


@dataclass(frozen=True)
class Parameter:
    """A value of a parameter set, or those of an array's elements, in the unit of the set."""

    name: str
    values: tuple[Value | Item, ...]
    unit: Measure | None
    """None: the unit of the variable."""
    where: str
    converts: bool = True
    factor: float = 1.0
    """Applies, as the offset, in the unit of the variable."""
    offset: float = 0.0


def read_parameter_set(
    root: Any, enumerations: Enumerations, notes: Notes, prefix: str = ""
) -> list[Parameter]:
    """Return the values of an ``ssv:ParameterSet``, ``prefix`` before every name.

    ``enumerations`` are those of the enclosing file. Raises InputError.
    """
    sections = ("ssv:Parameters", "ssv:Enumerations", "ssv:Units", "ssv:Annotations")
    known(root, {"name", "version"}, sections, notes)
    units = read_units(root, "ssv:Units", notes)
    items = {**enumerations, **read_enumerations(root, "ssv:Enumerations", notes)}
    if child(root, "ssv:Parameters") is None:
        raise InputError(f"{where(root)}: ssv:ParameterSet has no ssv:Parameters")
    elements = listed(root, "ssv:Parameters", {"ssv:Parameter"}, notes)
    return [_parameter(element, units, items, notes, prefix) for element in elements]


def _parameter(
    element: Any, units: Mapping[str, Unit], enumerations: Enumerations, notes: Notes, prefix: str
) -> Parameter:
    types = {f"ssv:{kind}" for kind in KINDS}
    dimension = f"{{{NAMESPACES['ssc']}}}Dimension"
    known(element, {"name"}, {*types, "ssv:Annotations", "ssc:Dimension"}, notes)
    name = needed(element, "name")
    found = [one for one in children(element) if tag(one) in types]
    if len(found) != 1:
        raise InputError(
            f"{where(element)}: parameter {name!r}: one value is needed, found {len(found)}"
        )
    one = found[0]
    known(one, {"value", "unit", "name", "mime-type"}, {"ssv:Value"}, notes)
    values = _values(one, enumerations)
    sizes = [int(_whole(needed(each, "size"), where(each))) for each in element.iterfind(dimension)]
    if sizes and math.prod(sizes) != len(values):
        shape = " by ".join(map(str, sizes))
        raise InputError(
            f"{where(element)}: parameter {name!r}: an array of {shape} has {len(values)} values"
        )
    return Parameter(prefix + name, values, measured(one, units, notes), where(element))


def _values(element: Any, enumerations: Enumerations) -> tuple[Value | Item, ...]:
    """Return the value, or those of an array: words of numbers, elements of all else."""
    kind = tag(element).partition(":")[2]
    elements = list(element.iterfind(f"{{{NAMESPACES['ssv']}}}Value"))
    if elements and element.get("value") is not None:
        raise InputError(f"{where(element)}: either a value or elements ssv:Value are needed")
    if KINDS[kind] in (str, bytes) or kind == "Enumeration":
        return tuple(_text(one, kind, element, enumerations) for one in elements or [element])
    words = needed(element, "value").split()
    if not words:
        raise InputError(f"{where(element)}: a value is needed, found {element.get('value')!r}")
    return tuple(_number(word, KINDS[kind], where(element)) for word in words)


def _text(one: Any, kind: str, element: Any, enumerations: Enumerations) -> Value | Item:
    text = needed(one, "value")
    if kind == "Binary":
        return _binary(one, text)
    if kind == "String":
        return text
    name = element.get("name")
    if name is None and len(enumerations) == 1:
        name = next(iter(enumerations))
    return Item(text, enumerations.get(name or "", {}).get(text))


def _number(word: str, kind: type, place: str) -> Value:
    if kind is bool:
        return boolean(word, place)
    return finite(word, place) if kind is float else _whole(word, place)


def _whole(word: str, place: str) -> int:
    try:
        if "_" in word:
            raise ValueError
        return int(word)
    except ValueError:
        raise InputError(f"{place}: a whole number is needed, found {word!r}") from None


def _binary(element: Any, text: str) -> bytes:
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise InputError(f"{where(element)}: hexadecimal digits are needed") from None


def parameter_set(name: str, values: Mapping[str, Written], version: str) -> Any:
    """Return an ``ssv:ParameterSet`` of a version with values by the names of variables."""
    uri = NAMESPACES["ssv"]
    root = etree.Element(
        f"{{{uri}}}ParameterSet",
        {"name": name, "version": version},
        nsmap={"ssv": uri} | ({"ssc": NAMESPACES["ssc"]} if version != "1.0" else {}),
    )
    holder = etree.SubElement(root, f"{{{uri}}}Parameters")
    for variable, value in sorted(values.items()):
        parameter = etree.SubElement(holder, f"{{{uri}}}Parameter", name=variable)
        _write_values(etree.SubElement(parameter, f"{{{uri}}}{value.type}"), value.values)
        for size in value.sizes:
            attributes = {"size": str(size)}
            etree.SubElement(parameter, f"{{{NAMESPACES['ssc']}}}Dimension", attributes)
    return root


def _write_values(element: Any, values: Sequence[Value]) -> None:
    """Give an element its value; of an array, words of numbers, else elements."""
    if len(values) == 1 or isinstance(values[0], (bool, int, float)):
        element.set("value", " ".join(map(written, values)))
        return
    for value in values:
        holder = etree.SubElement(element, f"{{{NAMESPACES['ssv']}}}Value")
        holder.set("value", written(value))


def type_name(kind: type) -> str:
    """Return SSP 1.0's name of a type: Real, Integer, Boolean, String or Binary."""
    return next(name for name, python in KINDS.items() if python is kind)


def written(value: Value) -> str:
    """Return a value as XML Schema writes it; numbers read back exactly."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, bytes):
        return value.hex()
    return value if isinstance(value, str) else repr(value)
