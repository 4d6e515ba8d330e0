"""Entries of a proposed vehicle file, each with its formula and the trial that measures it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from .particulars import Particulars, option

WEIGHING = "weighing"
INCLINING = "inclining test"
TOWING = "towing test"
BOLLARD = "bollard pull"
DECAY = "decay test"
TURNING = "turning circle"
ZIGZAG = "zig-zag"


@dataclass(frozen=True)
class Formula:
    """A formula by its source, good while ``symbol`` lies from ``low`` to ``high``."""

    source: str
    symbol: str = ""
    low: float = 0.0
    high: float = float("inf")

    @property
    def text(self) -> str:
        """The source with the range."""
        return f"{self.source}; {self.symbol} {self.range}" if self.symbol else self.source

    @property
    def range(self) -> str:
        """Range of the symbol."""
        if math.isinf(self.high):
            return f"from {self.low:g} on"
        return f"{self.low:g} to {self.high:g}"

    def notes(self, value: float) -> tuple[str, ...]:
        """Return a note if ``value`` of the symbol is outside the range."""
        if self.low <= value <= self.high:
            return ()
        return (f"{self.symbol} is {value:.3g}, outside the range {self.range} of: {self.source}",)


@dataclass(frozen=True)
class Value:
    """One entry: a number, three to six numbers, or a text."""

    name: str
    value: float | tuple[float, ...] | str
    unit: str
    source: str
    measured_by: str = ""
    mark: str = "assumed"
    notes: tuple[str, ...] = ()


def estimated(
    name: str,
    value: float | tuple[float, ...] | str,
    unit: str,
    formula: Formula,
    measured_by: str = "",
    at: float | None = None,
) -> Value:
    """Return an entry by a formula, to four digits, with a note if ``at`` is outside its range."""
    notes = () if at is None else formula.notes(at)
    return Value(name, _rounded(value), unit, formula.text, measured_by, notes=notes)


def _rounded(value: float | tuple[float, ...] | str) -> float | tuple[float, ...] | str:
    if isinstance(value, str):
        return value
    if isinstance(value, tuple):
        return tuple(float(f"{each:.4g}") for each in value)
    return float(f"{value:.4g}")


def given_or(
    particulars: Particulars, name: str, otherwise: float, unit: str, formula: Formula
) -> Value:
    """Return the entry of a particular: as the user gives it, else by the formula."""
    if name in particulars.given:
        return Value(name, particulars[name], unit, f"given: {option(name)}", mark="stated")
    return estimated(name, otherwise, unit, formula)


@dataclass(frozen=True)
class Part:
    """A part of a fitted craft: ``sort`` is ``propulsors`` or ``foils``."""

    sort: str
    kind: str
    values: tuple[Value, ...]


@dataclass(frozen=True)
class Proposal:
    """A vehicle file to be written."""

    kind: str
    length: float
    """Of the outline, m."""
    beam: float
    """Of the outline, m."""
    values: tuple[Value, ...]
    parts: tuple[Part, ...] = ()
    shape: tuple[dict[str, Any], ...] = ()
    remarks: tuple[str, ...] = field(default=())
    """Assumptions that no entry shows."""

    @property
    def notes(self) -> list[str]:
        """Remarks, and what lies outside the range of its formula, each once."""
        found = [*self.remarks, *(note for value in self.all_values() for note in value.notes)]
        return list(dict.fromkeys(found))

    def all_values(self) -> list[Value]:
        """Return the entries of the body and of its parts, with the names of their ports."""
        found = list(self.values)
        for sort in ("propulsors", "foils"):
            parts = [part for part in self.parts if part.sort == sort]
            for number, part in enumerate(parts, 1):
                found += [
                    Value(
                        f"{sort[:-1]}_{v.name}_{number}",
                        v.value,
                        v.unit,
                        v.source,
                        v.measured_by,
                        v.mark,
                        v.notes,
                    )
                    for v in part.values
                ]
        return found
