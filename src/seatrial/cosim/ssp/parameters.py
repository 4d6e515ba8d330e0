"""Parameter sets of SSP (``.ssv`` files, or inline), read and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lxml import etree

from ...errors import InputError
from ...fmi.instance import Variable
from ...ports import Scalar
from ...units import Unit
from .definitions import Enumerations, Measure, converted, read_enumerations, read_units
from .documents import NAMESPACES, boolean, child, children, known, needed, number, tag, where

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
class Parameter:
    """One value of a parameter set, in the unit that the set says."""

    name: str
    value: Value
    unit: Measure | None
    """None: the unit of the variable."""
    where: str


def read_parameter_set(root: Any, enumerations: Enumerations, prefix: str = "") -> list[Parameter]:
    """Return the values of an ``ssv:ParameterSet``, ``prefix`` before every name.

    ``enumerations`` are those of the enclosing file. Raises InputError.
    """
    sections = ("ssv:Parameters", "ssv:Enumerations", "ssv:Units", "ssv:Annotations")
    known(root, {"name", "version"}, {*sections, "ssc:MetaData"})
    units = read_units(root, "ssv:Units")
    items = {**enumerations, **read_enumerations(root, "ssv:Enumerations")}
    listed = child(root, "ssv:Parameters")
    if listed is None:
        raise InputError(f"{where(root)}: ssv:ParameterSet has no ssv:Parameters")
    known(listed, (), {"ssv:Parameter"})
    return [_parameter(element, units, items, prefix) for element in children(listed)]


def _parameter(
    element: Any, units: Mapping[str, Unit], enumerations: Enumerations, prefix: str
) -> Parameter:
    known(element, {"name"}, {*(f"ssv:{kind}" for kind in KINDS), "ssv:Annotations"})
    name = needed(element, "name")
    values = [one for one in children(element) if tag(one) != "ssv:Annotations"]
    if len(values) != 1:
        raise InputError(
            f"{where(element)}: parameter {name!r}: one value is needed, found {len(values)}"
        )
    one = values[0]
    known(one, {"value", "unit", "name", "mime-type"}, ())
    unit = one.get("unit")
    measure = None if unit is None else units.get(unit, unit)
    return Parameter(prefix + name, _value(one, enumerations), measure, where(element))


def _value(element: Any, enumerations: Enumerations) -> Value:
    kind, text = tag(element).partition(":")[2], needed(element, "value")
    python = KINDS[kind]
    if kind == "Enumeration":
        return _item(element, text, enumerations)
    if python is bytes:
        return _binary(element, text)
    if python is str:
        return text
    if len(text.split()) > 1:
        raise InputError(f"{where(element)}: arrays are not supported, found {text!r}")
    if python is bool:
        return boolean(text, where(element))
    if python is float:
        value = number(element, "value")
        assert value is not None
        return value
    try:
        if "_" in text:
            raise ValueError
        return int(text)
    except ValueError:
        message = f"{where(element)}: a whole number is needed, found {text!r}"
        raise InputError(message) from None


def _binary(element: Any, text: str) -> bytes:
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise InputError(f"{where(element)}: hexadecimal digits are needed") from None


def _item(element: Any, text: str, enumerations: Enumerations) -> Value:
    """Return an item's number, or its name where only the FMU can know the number."""
    name = element.get("name")
    if name is None and len(enumerations) == 1:
        name = next(iter(enumerations))
    return enumerations.get(name or "", {}).get(text, text)


def value_for(parameter: Parameter, variable: Variable) -> Value:
    """Return the value in the unit of ``variable``; InputError if type or unit do not fit."""
    value, kind = parameter.value, variable.type
    if type(value) is int and kind is float:
        try:
            value = float(value)
        except OverflowError:
            message = f"{parameter.where}: {parameter.name}: beyond the range of doubles"
            raise InputError(message) from None
    if isinstance(value, str) and kind is int:
        if value not in variable.items:
            raise InputError(
                f"{parameter.where}: {parameter.name}: item {value!r} is of no enumeration that "
                "the file or the FMU defines"
            )
        return variable.items[value]
    if type(value) is not kind:
        raise InputError(
            f"{parameter.where}: {parameter.name} is of type {type(value).__name__}, "
            f"its variable is of type {kind.__name__}"
        )
    if not isinstance(value, float) or parameter.unit is None or not variable.unit:
        return value
    factor, offset = converted(parameter.unit, variable.measure, parameter.where)
    return value if (factor, offset) == (1.0, 0.0) else factor * value + offset


def parameter_set(name: str, values: Mapping[str, Value]) -> Any:
    """Return an ``ssv:ParameterSet`` of version 1.0 with values by variable name."""
    uri = NAMESPACES["ssv"]
    root = etree.Element(
        f"{{{uri}}}ParameterSet", {"name": name, "version": "1.0"}, nsmap={"ssv": uri}
    )
    listed = etree.SubElement(root, f"{{{uri}}}Parameters")
    for variable, value in sorted(values.items()):
        parameter = etree.SubElement(listed, f"{{{uri}}}Parameter", name=variable)
        etree.SubElement(parameter, f"{{{uri}}}{type_name(type(value))}", value=written(value))
    return root


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
