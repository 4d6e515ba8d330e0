"""Parameter mappings of SSP (``.ssm`` files, or inline): names and values before they apply."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from seatrial.errors import InputError

from .documents import flag, known, needed, where
from .notes import Notes
from .parameters import Item, Parameter, Value
from .transformations import KINDS, Transformation, read_transformation

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
