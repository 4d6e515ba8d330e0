"""Figures of a manoeuvre: values with units, and reasons for those that cannot be had."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from seatrial.errors import InputError, unknown


@dataclass(frozen=True)
class Figure:
    """A figure in SI units, angles in rad."""

    value: float
    unit: str
    uncertainty: float | None = None
    """Half of the interval of 95 %, where it is known."""

    def as_dict(self) -> dict[str, Any]:
        """Return what JSON holds."""
        said = {"value": self.value, "unit": self.unit}
        return said if self.uncertainty is None else {**said, "uncertainty": self.uncertainty}


@dataclass(frozen=True)
class Figures(Mapping[str, float]):
    """Figures of one manoeuvre by name; ``figures[name]`` is the value.

    Raises InputError, with the reason, for a figure that cannot be had from the record.
    """

    manoeuvre: str
    found: Mapping[str, Figure]
    missing: Mapping[str, str] = field(default_factory=dict)
    """Why a figure cannot be had, by its name."""
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        if name in self.missing:
            raise InputError(f"{self.manoeuvre}: {name} cannot be had: {self.missing[name]}")
        if name not in self.found:
            raise InputError(f"{self.manoeuvre}: {unknown('figure', name, tuple(self.found))}")
        return self.found[name].value

    def __contains__(self, name: object) -> bool:
        return name in self.found

    def __iter__(self) -> Iterator[str]:
        return iter(self.found)

    def __len__(self) -> int:
        return len(self.found)

    def in_lengths(self, length: float) -> dict[str, float]:
        """Return the distances among the figures divided by the ship's length, m."""
        return {name: each.value / length for name, each in self.found.items() if each.unit == "m"}

    def as_dict(self) -> dict[str, Any]:
        """Return what JSON holds: values with units, reasons, notes."""
        figures = {name: figure.as_dict() for name, figure in self.found.items()}
        return {
            "manoeuvre": self.manoeuvre,
            "figures": figures,
            "missing": dict(self.missing),
            "notes": list(self.notes),
        }


class Collector:
    """Figures as they are found, one by one."""

    def __init__(self, manoeuvre: str) -> None:
        self._manoeuvre = manoeuvre
        self._found: dict[str, Figure] = {}
        self._missing: dict[str, str] = {}
        self._notes: list[str] = []

    def add(self, unit: str, /, **values: float) -> None:
        """Add figures of one unit."""
        for name, value in values.items():
            self._found[name] = Figure(float(value), unit)

    def lack(self, reason: str, *names: str) -> None:
        """Say why figures cannot be had."""
        self._missing.update(dict.fromkeys(names, reason))

    def note(self, text: str) -> None:
        """Add a remark for the report."""
        self._notes.append(text)

    def figures(self) -> Figures:
        """Return them; raises InputError if the record holds none."""
        if not self._found:
            reasons = "; ".join(dict.fromkeys(self._missing.values()))
            raise InputError(f"the record holds no {self._manoeuvre}: {reasons}")
        return Figures(self._manoeuvre, self._found, self._missing, tuple(self._notes))
