"""Overview of a campaign's table: settings of the cases, values of criteria and figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from seatrial.model.readable import number, quantity_text
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout

from ..columns import settings_in
from .finding import Shown

MOST_CASES = 50
"""Cases that are listed where none has failed."""
_MOST_LISTED = 6
"""Values of a setting that are listed; of more the least, the greatest and the number."""
_MOST_KEPT = 1000
_FEWEST = 3
"""Values of a column that make a figure."""
_MOST_FIGURES = 12
_MOST_POINTS = 1000


class Overview:
    """Collects the rows of a table, of the columns ``names`` with their ``units``."""

    def __init__(self, names: Sequence[str], units: Mapping[str, str]) -> None:
        self._units = dict(units)
        self._settings = settings_in(names)
        found = names[names.index("error") + 1 :]
        self._columns = [
            n for n in found if not n.startswith(("unit of ", "robustness of ")) and n in units
        ]
        self._chosen: dict[str, dict[Any, int]] = {key: {} for key in self._settings}
        self._values: dict[str, list[float]] = {}
        self.first: list[Mapping[str, Any]] = []

    def add(self, row: Mapping[str, Any]) -> None:
        """Add a row."""
        for key, counts in self._chosen.items():
            value = row[key]
            if value is not None and (value in counts or len(counts) < _MOST_KEPT):
                counts[value] = counts.get(value, 0) + 1
        for name in self._columns:
            value = row[name]
            if isinstance(value, float) and math.isfinite(value):
                self._values.setdefault(name, []).append(value)
                if unit := row.get(f"unit of {name.removeprefix('worst of ')}"):
                    self._units[name] = unit
        if len(self.first) < MOST_CASES:
            self.first.append(row)

    def run(self) -> Shown:
        """Return trials and settings, each with its values."""
        rows = []
        for key, counts in self._chosen.items():
            if counts:
                rows.append([key, self._said(counts, self._units[key])])
        return Shown("What was run", ["setting", "values"], rows)

    def values(self) -> Shown:
        """Return the values of all cases: of criteria the worst, of metrics their own, figures."""
        columns = ["column", "unit", "cases", "least", "median", "mean", "95 %", "greatest"]
        rows = []
        for name, values in self._values.items():
            low, middle, most, high = np.quantile(values, [0.0, 0.5, 0.95, 1.0]).tolist()
            unit = "" if self._units[name] == "1" else self._units[name]
            rows.append([name, unit, len(values), low, middle, float(np.mean(values)), most, high])
        return Shown("Values of the cases", columns, rows)

    def cases(self) -> Shown:
        """Return the first cases: their settings and values."""
        named = [name for name in self._values if name.startswith("worst of ")]
        columns = ["case", *self._titles(self._settings), *self._titles(named)]
        shown = ("case", *self._settings, *named)
        rows = [["" if row[key] is None else row[key] for key in shown] for row in self.first]
        return Shown("Cases", columns, rows)

    def figures(self) -> Iterator[str]:
        """Yield the shares of cases below each value, of columns with values enough."""
        drawn = [(n, v) for n, v in self._values.items() if len(set(v)) >= _FEWEST]
        for name, values in drawn[:_MOST_FIGURES]:
            yield self._shares(name, np.sort(values)).json()

    def _said(self, counts: Mapping[Any, int], unit: str) -> str:
        """Return the values of a setting: a list, or the least and the greatest."""
        sizes = [v for v in counts if isinstance(v, (int, float)) and not isinstance(v, bool)]
        if len(counts) <= _MOST_LISTED:
            texts = [quantity_text(v, unit, 6) if v in sizes else str(v) for v in counts]
            return ", ".join(texts)
        several = f"{len(counts)}{' or more' if len(counts) == _MOST_KEPT else ''} values"
        if len(sizes) < len(counts):
            return several
        return f"{number(min(sizes), 6)} to {quantity_text(max(sizes), unit, 6)}, {several}"

    def _titles(self, names: Sequence[str]) -> list[str]:
        return [
            f"{name}, {self._units[name]}" if self._units[name] not in ("", "1") else name
            for name in names
        ]

    def _shares(self, name: str, values: np.ndarray) -> Figure:
        shares = 100.0 * np.arange(1, len(values) + 1) / len(values)
        kept = np.unique(np.linspace(0, len(values) - 1, _MOST_POINTS).astype(int))
        figure = Figure()
        figure.trace(
            "scatter",
            x=values[kept],
            y=shares[kept],
            mode="lines",
            line={"shape": "hv", "color": COLOURS[0]},
            hovertemplate="%{y:.3g} % of cases up to %{x:.4g}",
        )
        figure.lay_out(height=220, showlegend=False, **layout(hovermode="closest"))
        figure.x_axis(title={"text": escape(self._titles([name])[0])})
        figure.y_axis(title={"text": "cases up to it, %"}, range=[0, 100])
        return figure
