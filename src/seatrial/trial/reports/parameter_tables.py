"""Tables of the parameters of a run's components, for its report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ...model.readable import number, person_scale
from ...system.paths import split_axis
from ..records.run_folder import Run

_MOST_ROWS = 500
"""Of one component; a table of more is not read but searched, and the manifest has them all."""


@dataclass
class ParameterRow:
    """A parameter, whole: the values of all its axes and where they come from."""

    name: str
    axes: list[str]
    values: list[str]
    unit: str
    origin: str
    source: str
    mark: str


@dataclass(frozen=True)
class ParameterTable:
    """The parameters of a component: the first rows, and how many more there are."""

    component: str
    rows: Sequence[ParameterRow]
    more: int


def parameter_tables(run: Run) -> Iterator[ParameterTable]:
    """Yield a table for each component of a run."""
    for name, component in run.manifest["components"].items():
        rows = _parameter_rows(component["parameters"])
        yield ParameterTable(name, rows[:_MOST_ROWS], max(0, len(rows) - _MOST_ROWS))


def _parameter_rows(parameters: dict[str, dict[str, Any]]) -> list[ParameterRow]:
    """Return one row per port: scalars that share name, unit and origin are put together."""
    rows: list[ParameterRow] = []
    for name, entry in parameters.items():
        base, axis = split_axis(name)
        value, unit = _for_person(entry["value"], entry["unit"])
        row = ParameterRow(
            base,
            [axis] if axis else [],
            [value_text(value)],
            unit,
            entry.get("from") or "",
            entry.get("source") or "",
            entry.get("mark") or "",
        )
        last = rows[-1] if rows else None
        if last and axis and _alike(last, row):
            last.axes += row.axes
            last.values += row.values
        else:
            rows.append(row)
    return rows


def _alike(a: ParameterRow, b: ParameterRow) -> bool:
    return (a.name, a.unit, a.origin, a.source, a.mark) == (
        b.name, b.unit, b.origin, b.source, b.mark,
    )  # fmt: skip


def _for_person(value: Any, unit: str) -> tuple[Any, str]:
    if not isinstance(value, float):
        return value, unit
    factor, readable = person_scale(unit)
    return value * factor, readable


def value_text(value: Any) -> str:
    """Return a value as a person reads it."""
    if value is None:  # it comes over a connection
        return ""
    return number(value, 8) if isinstance(value, float) else str(value)
