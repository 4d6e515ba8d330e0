"""Entries that follow from others: references and expressions of a vehicle's file, resolved."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ...errors import InputError, unknown
from ...model.units import Unit, split_quantity
from .entries import Computed, DerivedEntry, Entry, Mark, Resolved, WrittenEntry, common_unit
from .expressions import Value, bare_name, evaluate, is_expression
from .quantities import amount, dimension, in_unit
from .wildcards import expanded

Tables = Mapping[str, Mapping[str, WrittenEntry]]

_MARKS: tuple[Mark, ...] = ("stated", "corrected", "identified", "assumed")
"""From the strongest to the weakest."""
_AXES = {3: ("xyz", "uvw", "pqr", ("xx", "yy", "zz")), 6: (("xx", "yy", "zz", "xy", "xz", "yz"),)}
"""Names of a list's elements, by its length."""


class Entries:
    """The entries of a vehicle in one of its variants, each resolved when it is asked for.

    ``tables`` has those of components; ``presets`` those of named values, by the beginning
    ``TABLE.PORT``. A mistake raises InputError with ``where``, table and key.
    """

    def __init__(self, tables: Tables, presets: Tables, where: str) -> None:
        self._tables = {
            **expanded(tables, where),
            **{f"presets.{place}": p for place, p in presets.items()},
        }
        self._where = where
        self._open: list[tuple[str, str]] = []

    def table(self, name: str) -> dict[str, Resolved]:
        """Return the entries of a component's table."""
        return {key: self._resolved(name, key) for key in self._tables.get(name, {})}

    def presets(self, table: str) -> dict[str, dict[str, Resolved]]:
        """Return the named values of a component's ports, by port and name."""
        beginning = f"presets.{table}."
        places = [place for place in self._tables if place.startswith(beginning)]
        return {place.removeprefix(beginning): self.table(place) for place in places}

    def named(self, name: str, table: str = "") -> Resolved:
        """Return the entry, or the element of one, that ``name`` means inside ``table``."""
        for place, key, axis in self._readings(name, table):
            if key in self._tables[place]:
                entry = self._resolved(place, key)
                return entry if axis is None else _element(entry, axis, name)
        raise InputError(self._lacks(name, table))

    def _resolved(self, table: str, key: str) -> Resolved:
        entry, here = self._tables[table][key], (table, key)
        if isinstance(entry, Entry):
            return entry
        if here in self._open:
            ring = [*self._open[self._open.index(here) :], here]
            names = " -> ".join(".".join(each) for each in ring)
            raise InputError(f"{self._where}: {table}.{key}: it follows from itself: {names}")
        self._open.append(here)
        try:
            return derived(entry, lambda name: self.named(name, table))
        except InputError as error:
            prefix = f"{self._where}: "
            if str(error).startswith(prefix):
                raise
            shown = entry.value if isinstance(entry.value, str) else _list_text(entry.value)
            raise InputError(f"{prefix}{table}.{key}: {shown!r}: {error}") from None
        finally:
            self._open.pop()

    def _readings(self, name: str, table: str) -> Iterator[tuple[str, str, str | None]]:
        """Yield the places that a name may mean: table, key, and element or None."""
        places = sorted((t for t in self._tables if name.startswith(f"{t}.")), key=len)
        rests = [(place, name.removeprefix(f"{place}.")) for place in reversed(places)]
        for place, rest in [*rests, *([(table, name)] if table in self._tables else [])]:
            yield place, rest, None
            key, dot, axis = rest.rpartition(".")
            if dot:
                yield place, key, axis

    def _lacks(self, name: str, table: str) -> str:
        for place in self._tables:
            if name.startswith(f"{place}."):
                return unknown("entry", name, [f"{place}.{key}" for key in self._tables[place]])
        own = self._tables.get(table, {})
        every = [f"{place}.{key}" for place, entries in self._tables.items() for key in entries]
        known = [*own, *every]
        is_minus = any(name.endswith(f"-{each}") for each in known)
        hint = "; a minus has a blank before it" if is_minus else ""
        return f"{unknown('entry', name, known)}{hint}"


def derived(entry: DerivedEntry, look_up: Callable[[str], Resolved]) -> Computed:
    """Return the value of an entry with expressions, whose names ``look_up`` has.

    Raises InputError for what cannot be computed, or does not measure what its unit says.
    """
    constant = entry.mark if entry.source else None
    if isinstance(entry.value, str):
        found = computed(entry.value, look_up, constant)
        if entry.unit is not None:
            found = _converted(found, entry.unit)
    else:
        found = _of_list(entry.value, entry.unit, look_up, constant)
    expression = found.expression
    source = f"{entry.source}: {expression}" if entry.source else expression
    mark = entry.mark or found.mark
    return found.model_copy(update={"source": source, "mark": mark})


def computed(
    text: str, look_up: Callable[[str], Resolved], constant: Mark | None = None
) -> Computed:
    """Return the value of an expression; that of a name alone is its entry's, untouched.

    ``constant`` is the mark of one without a name. Raises InputError.
    """
    marks: list[Mark] = []

    def entry(name: str) -> Resolved:
        found = look_up(name)
        marks.append(found.mark)
        return found

    name = bare_name(text)
    if name is not None:
        found = entry(name)
        by_name = not isinstance(found, Computed) or found.by_name
        value: Any = found.value
        unit: Any = found.unit
    else:
        amounts, by_name = evaluate(text, lambda name: _amounts(entry(name), name)), False
        if isinstance(amounts, tuple):
            value = [each.value for each in amounts]
            unit = common_unit([each.unit for each in amounts])
        else:
            value, unit = amounts.value, amounts.unit
    mark = max(marks, key=_MARKS.index) if marks else constant
    if mark is None:
        raise InputError("an expression without a name needs source and mark")
    return Computed(
        value=value, unit=unit, source=text, mark=mark, expression=text, by_name=by_name
    )


def _of_list(
    elements: list[float | int | str],
    units: str | list[str] | None,
    look_up: Callable[[str], Resolved],
    constant: Mark | None,
) -> Computed:
    """Return a list of which some elements are expressions, others numbers or quantities."""
    if isinstance(units, list) and len(units) != len(elements):
        raise InputError(f"unit: {len(elements)} are needed, found {len(units)}")
    own = units if isinstance(units, list) else [units] * len(elements)
    found = [_of_element(e, u, look_up, constant) for e, u in zip(elements, own, strict=True)]
    known = next((f.unit for f in found if f.unit != "1" or f.expression), "1")
    marks = [f.mark for f in found if f.expression]
    values: Any = [f.value for f in found]
    measured: Any = [known if f.value == 0 and f.unit == "1" else f.unit for f in found]
    return Computed(
        value=values,
        unit=common_unit(measured),
        source=_list_text(elements),
        mark=max(marks, key=_MARKS.index),
        expression=_list_text(elements),
        by_name=all(f.by_name for f in found),
    )


def _of_element(
    element: float | int | str,
    unit: str | None,
    look_up: Callable[[str], Resolved],
    constant: Mark | None,
) -> Computed:
    if is_expression(element):
        found = computed(str(element), look_up, constant)
        if isinstance(found.value, (list, str)):
            raise InputError(f"{element!r}: an element is a number, found {found.value!r}")
        return found if unit is None else _converted(found, unit)
    given: dict[str, Any] = {"source": "", "mark": "stated", "expression": ""}
    if isinstance(element, str):
        quantity = split_quantity(element)
        if quantity is None:
            raise InputError(f"{element!r} is neither a quantity nor an expression")
        found = Computed(value=quantity[0], unit=quantity[1], **given)
        return found if unit is None else _converted(found, unit)
    return Computed(value=element, unit=unit or "1", **given)


def _converted(found: Computed, unit: str | list[str]) -> Computed:
    """Return the value in the unit that its entry says."""
    if isinstance(found.value, str):
        raise InputError(f"a text has no unit, found {unit!r}")
    values = found.value if isinstance(found.value, list) else [found.value]
    targets = unit if isinstance(unit, list) else [unit] * len(values)
    if len(targets) != len(values):
        raise InputError(f"unit: {len(values)} are needed, found {len(targets)}")
    new: Any = [
        in_unit(value, measure, target)
        for value, measure, target in zip(
            values, measures(found, len(values)), targets, strict=True
        )
    ]
    value = new if isinstance(found.value, list) else new[0]
    return found.model_copy(update={"value": value, "unit": unit, "by_name": True})


def measures(entry: Resolved, count: int) -> list[str | Unit]:
    """Return the units of an entry's values, of which there are ``count``."""
    units = entry.unit if isinstance(entry.unit, list) else [entry.unit] * count
    if isinstance(entry, Computed) and not entry.by_name:
        return [dimension(each) for each in units]
    return list(units)


def _amounts(entry: Resolved, name: str) -> Value:
    if isinstance(entry.value, str):
        raise InputError(f"{name} is a text, {entry.value!r}")
    values = entry.value if isinstance(entry.value, list) else [entry.value]
    units = measures(entry, len(values))
    if len(units) != len(values):
        raise InputError(f"{name} has {len(values)} values and {len(units)} units")
    amounts = tuple(amount(v, u) for v, u in zip(values, units, strict=True))
    return amounts if isinstance(entry.value, list) else amounts[0]


def _element(entry: Resolved, axis: str, name: str) -> Resolved:
    """Return an element of a list: by its axis, or by its number from 1 on."""
    if not isinstance(entry.value, list):
        raise InputError(f"{name}: {name.rpartition('.')[0]} is no list, found {entry.value!r}")
    length = len(entry.value)
    names = {str(i + 1): i for i in range(length)}
    for axes in _AXES.get(length, ()):
        names |= {each: i for i, each in enumerate(axes)}
    if axis not in names:
        raise InputError(f"{name}: {unknown('element', axis, names)}")
    index = names[axis]
    unit = entry.unit[index] if isinstance(entry.unit, list) else entry.unit
    return entry.model_copy(update={"value": entry.value[index], "unit": unit})


def _list_text(elements: list[float | int | str]) -> str:
    return f"[{', '.join(str(each) for each in elements)}]"
