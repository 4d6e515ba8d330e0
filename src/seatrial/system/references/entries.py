"""Entries of vehicles' files: values with unit, source and mark, or expressions of others."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Discriminator, Tag, field_validator
from pydantic_core import PydanticCustomError

from ...errors import InputError
from ...model.units import split_quantity
from ..files import FileModel
from .expressions import is_expression, names_in

Mark = Literal["stated", "corrected", "assumed", "identified"]
SHARED = ("source", "mark")
"""Keys that a table or a part gives for those of its entries that lack them."""


class Resolved(BaseModel):
    """One value: a number, a list of numbers for a port with axes, or a text.

    ``unit`` is that of all numbers, or a list with one for each.
    """

    model_config = FileModel.model_config

    value: float | int | str | list[float | int]
    unit: str | list[str] = "1"
    source: str
    mark: Mark


class Entry(Resolved, FileModel):
    """One value as a file has it."""

    @field_validator("value", mode="before")
    @classmethod
    def _one_kind(cls, value: Any) -> Any:
        """Refuse a list that has quantities and numbers without a unit."""
        if isinstance(value, list) and any(isinstance(each, str) for each in value):
            needed = "quantities as '0.1 m', with a unit for all but 0, or numbers alone"
            raise PydanticCustomError("mixed", "a list has {needed}", {"needed": needed})
        return value


class DerivedEntry(FileModel):
    """One value by an expression, ``"= hull.mass / 2"``, or a list with expressions in it.

    Without ``unit`` the value has that of the expression; without ``source`` and ``mark`` it has
    the expression for its source, and the weakest mark of the entries in it.
    """

    value: str | list[float | int | str]
    unit: str | list[str] | None = None
    source: str = ""
    mark: Mark | None = None


def _form(entry: Any) -> str:
    value = entry.get("value") if isinstance(entry, dict) else getattr(entry, "value", None)
    return "derived" if _has_expression(value) else "given"


WrittenEntry = Annotated[
    Annotated[Entry, Tag("given")] | Annotated[DerivedEntry, Tag("derived")], Discriminator(_form)
]
"""An entry as a file has it."""


class Computed(Resolved):
    """The value of an expression, which it keeps."""

    expression: str
    by_name: bool = True
    """False if the unit is the dimension of what was computed: a radian is a number then."""


def written_out(table: dict[str, Any], where: str) -> dict[str, Any]:
    """Return a component's table with parts numbered, bare values as entries, shared keys given.

    Raises InputError, saying ``where``, for an entry that is there twice.
    """
    shared = _shared(table)
    entries: dict[str, Any] = {}
    for key, value in table.items():
        if key in shared:
            continue
        new = (
            _parts(key, value, shared, f"{where}: {key}")
            if _is_list_of_parts(value)
            else {key: _entry(value, shared)}
        )
        for name in new:
            if name in entries or (name != key and name in table):
                raise InputError(f"{where}: {key}: {name} is there twice")
        entries.update(new)
    return entries


def _parts(
    key: str, parts: list[dict[str, Any]], shared: dict[str, str], where: str
) -> dict[str, Any]:
    """Return the entries of a list of like parts, each with the number of its part.

    Entry ``position`` of part 2 is ``position_2``. Where parts have a ``kind``, names begin with
    the singular of the list, ``foil_position_2`` of ``foils``, and the list itself is the text of
    the kinds in order. Raises InputError, saying ``where``, for a kind that some parts lack.
    """
    kinds = [str(part["kind"]) for part in parts if "kind" in part]
    if kinds and len(kinds) < len(parts):
        lacking = next(n for n, part in enumerate(parts, 1) if "kind" not in part)
        raise InputError(f"{where}: part {lacking} has no kind, and others have one")
    prefix = f"{key.removesuffix('s')}_" if kinds else ""
    entries: dict[str, Any] = {}
    for number, part in enumerate(parts, 1):
        own = {**shared, **_shared(part)}
        for name, value in part.items():
            if name not in SHARED and name != "kind":
                entries[f"{prefix}{name}_{number}"] = _entry(value, own)
    if kinds:
        entries[key] = _entry(" ".join(kinds), {**shared, **_shared(parts[0])})
    return entries


def _is_list_of_parts(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, dict) for v in value)


def _shared(table: dict[str, Any]) -> dict[str, str]:
    """Return source and mark of a table; of those names, a component may have entries, too."""
    return {key: table[key] for key in SHARED if isinstance(table.get(key), str)}


def _entry(value: Any, shared: dict[str, str]) -> Any:
    """Return an entry with what its table shares, which one that follows from others needs not."""
    entry = value if isinstance(value, dict) else _bare(value)
    follows = any(names_in(text) for text in _expressions(entry.get("value")))
    return entry if follows else {**shared, **entry}


def _bare(value: Any) -> dict[str, Any]:
    """Return a bare value as an entry: a number, a text, a quantity, or a list of them."""
    if isinstance(value, str):
        quantity = None if is_expression(value) else split_quantity(value)
        return (
            {"value": value}
            if quantity is None
            else dict(zip(("value", "unit"), quantity, strict=True))
        )
    if isinstance(value, list) and not _has_expression(value):
        found = [split_quantity(each) if isinstance(each, str) else None for each in value]
        units = [each[1] for each in found if each is not None]
        if units and all(one or _is_zero(each) for one, each in zip(found, value, strict=True)):
            elements = [one or (0.0, units[0]) for one in found]
            units = [each[1] for each in elements]
            return {"value": [each[0] for each in elements], "unit": common_unit(units)}
    return {"value": value}


def common_unit(units: list[str]) -> str | list[str]:
    """Return the unit that all of a list have, or the list."""
    return units[0] if len(set(units)) == 1 else units


def _is_zero(value: Any) -> bool:
    """Return whether an element of a list needs no unit of its own."""
    return type(value) in (int, float) and value == 0


def _expressions(value: Any) -> list[str]:
    values = value if isinstance(value, list) else [value]
    return [each for each in values if is_expression(each)]


def _has_expression(value: Any) -> bool:
    return bool(_expressions(value))
