"""Maps of a campaign's table: where the cases pass, over two keys, in panels over two more."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.trial.files.map_entry import MOST_PANELS, MOST_VALUES, MapEntry, MapPoint
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout

from ..distributions import number_and_unit
from ..table import read_rows

ROBUSTNESS = "robustness of "
_FEWEST = 4
"""Values of a key that make an axis."""
_SHARES = [[0.0, COLOURS[1]], [0.5, "#f7f7f7"], [1.0, COLOURS[0]]]
_MARGINS = [[0.0, COLOURS[1]], [0.5, "#f6d9bd"], [0.5, "#d3e5f0"], [1.0, COLOURS[0]]]
"""What fails by a little is not to look like what passes by a little."""
_GAP, _TITLE_GAP = 0.05, 0.1
"""Between panels, as shares of the width and of the height, where titles and ticks stand."""
_PANEL_PX = 270
_LEGEND_PX = 60
_TITLE: dict[str, Any] = {
    "xref": "paper",
    "yref": "paper",
    "xanchor": "center",
    "yanchor": "bottom",
    "showarrow": False,
    "font": {"size": 13},
}


@dataclass
class _Cell:
    """The cases of one place on a map."""

    count: int = 0
    passed: int = 0
    margin: float = math.inf
    """Least robustness of any criterion."""
    by: str = ""
    """The criterion that has it."""
    case: int = 0
    """Number of that case."""

    def add(self, row: Mapping[str, Any], criteria: Sequence[str]) -> None:
        self.count += 1
        self.passed += bool(row["passed"])
        found = {name: row[ROBUSTNESS + name] for name in criteria}
        known = {name: value for name, value in found.items() if value is not None}
        least = min(known, key=known.__getitem__, default="")
        margin = known.get(least, 1.0 if row["passed"] else -1.0)
        if row["status"] == "failed":
            margin, least = -math.inf, "it could not go on"
        if margin < self.margin or self.count == 1:
            self.margin, self.by, self.case = margin, least, row["case"]


@dataclass
class Map:
    """A map that can be drawn."""

    entry: MapEntry
    units: Mapping[str, str]
    values: dict[str, list[Any]]
    """Of each key, in order."""
    cells: dict[tuple[Any, ...], _Cell] = field(default_factory=dict)

    @property
    def repeated(self) -> bool:
        """True if a place has several cases: their share that passes is drawn."""
        return any(cell.count > 1 for cell in self.cells.values())


def campaign_map(
    path: Path, written: Mapping[str, Any] | None, units: dict[str, str]
) -> Map | None:
    """Return the map of a table: the one that its campaign says, or that of a whole grid.

    A grid by itself makes one if two of its keys have four numbers or more, and at most two others
    a few values, with cases everywhere; keys named ``seed`` are repetitions. None if there is none.
    """
    names = list(units)
    settings = names[2 : names.index("seed")]
    criteria = [n.removeprefix(ROBUSTNESS) for n in names if n.startswith(ROBUSTNESS)]
    entry = None if written is None else MapEntry.model_validate(written)
    values = _values(path, entry.keys if entry else settings)
    if entry is None:
        entry = _entry(values)
    if entry is None:
        return None
    found = Map(entry, units, {key: values[key] for key in entry.keys})
    needed = [*entry.keys, "case", "passed", "status", *(ROBUSTNESS + name for name in criteria)]
    for row in read_rows(path, list(dict.fromkeys(needed))):
        place = tuple(row[key] for key in entry.keys)
        found.cells.setdefault(place, _Cell()).add(row, criteria)
    whole = math.prod(len(each) for each in found.values.values())
    return found if written is not None or len(found.cells) == whole else None


def map_figure(found: Map) -> Figure:
    """Return the figure of a map.

    Colour is the least robustness of any criterion, cut at 1, with a line where it is 0; with
    several cases at a place it is the share that passes, with a line at one half.
    """
    entry, figure = found.entry, Figure()
    columns = found.values[entry.columns] if entry.columns else [None]
    rows = found.values[entry.rows] if entry.rows else [None]
    width, height = _share(len(columns), _GAP), _share(len(rows), _TITLE_GAP)
    number = 0
    for below, row in enumerate(reversed(rows)):
        for right, column in enumerate(columns):
            number += 1
            left, bottom = right * (width + _GAP), below * (height + _TITLE_GAP)
            _axes(figure, found, number, (left, left + width), (bottom, bottom + height))
            if below:
                figure.x_axis(number, title=None)
            if right:
                figure.y_axis(number, title=None, showticklabels=False)
            said = _panel_title(found, column, row)
            figure.annotate(x=left + width / 2.0, y=bottom + height, text=said, **_TITLE)
            _field(figure, found, number, column, row)
            _points(figure, found, number, column, row)
    figure.lay_out(
        **layout(hovermode="closest"),
        height=_PANEL_PX * len(rows) + _LEGEND_PX,
        showlegend=bool(entry.points),
        legend={"orientation": "h", "x": 0, "y": 1, "yanchor": "top", "yref": "container"},
    )
    figure.lay_out(margin={"l": 70, "r": 10, "t": _LEGEND_PX, "b": 60})
    return figure


def said_of(found: Map) -> str:
    """Return what a map shows, in a sentence."""
    if found.repeated:
        most = max(cell.count for cell in found.cells.values())
        return f"Share of the cases at a place (up to {most}) that pass; on the line one half do."
    return "Least robustness of any criterion, as a share of its limit; on the line it is 0."


# ------------------------------------------------------------------ which map


def _values(path: Path, keys: Sequence[str]) -> dict[str, list[Any]]:
    """Return the values of each key, in order, at most so many that it can be an axis."""
    seen: dict[str, dict[Any, None]] = {key: {} for key in keys}
    for row in read_rows(path, list(keys)) if keys else ():
        for key, of in seen.items():
            if len(of) <= MOST_VALUES:
                of[row[key]] = None
    return {key: sorted(of) if _are_numbers(list(of)) else list(of) for key, of in seen.items()}


def _are_numbers(values: Sequence[Any]) -> bool:
    kinds = {type(value) for value in values}
    return bool(kinds) and kinds <= {int, float}


def _entry(values: Mapping[str, list[Any]]) -> MapEntry | None:
    """Return the map of a grid, if its keys make one."""
    varied = {key: of for key, of in values.items() if len(of) > 1 and not _is_seed(key)}
    axes = [
        key for key, of in varied.items() if _are_numbers(of) and _FEWEST <= len(of) <= MOST_VALUES
    ]
    axes = sorted(axes, key=lambda key: -len(varied[key]))[:2]
    others = [key for key in varied if key not in axes]
    if len(axes) < 2 or len(others) > 2 or any(len(varied[key]) > MOST_PANELS for key in others):
        return None
    columns, rows = (*others, None, None)[:2]
    return MapEntry(x=axes[0], y=axes[1], columns=columns, rows=rows)


def _is_seed(key: str) -> bool:
    return key.rpartition(".")[2] == "seed"


# ------------------------------------------------------------------ drawing


def _share(count: int, gap: float) -> float:
    """Return the share of the width, or height, of each of so many panels."""
    return (1.0 - gap * (count - 1)) / count


def _axes(figure: Figure, found: Map, number: int, x: tuple[float, float], y: Any) -> None:
    name = "" if number == 1 else str(number)
    entry = found.entry
    figure.x_axis(number, domain=x, anchor=f"y{name}", title={"text": _label(found, entry.x)})
    figure.y_axis(number, domain=y, anchor=f"x{name}", title={"text": _label(found, entry.y)})


def _label(found: Map, key: str) -> str:
    unit = found.units[key]
    return escape(found.entry.labels.get(key, key) + (f", {unit}" if unit else ""))


def _panel_title(found: Map, column: Any, row: Any) -> str:
    pairs = ((found.entry.columns, column), (found.entry.rows, row))
    said = []
    for key, value in pairs:
        if key is not None:
            shown = f"{value:g}" if isinstance(value, float) else str(value)
            name = found.entry.labels.get(key, key)
            said.append(f"{name} {shown} {found.units[key]}".rstrip())
    return escape(", ".join(said))


def _field(figure: Figure, found: Map, number: int, column: Any, row: Any) -> None:
    entry = found.entry
    xs, ys = found.values[entry.x], found.values[entry.y]
    panel = [value for key, value in ((entry.columns, column), (entry.rows, row)) if key]
    grid = [[found.cells.get((x, y, *panel), _Cell()) for x in xs] for y in ys]
    repeated = found.repeated
    low, line = (0.0, 0.5) if repeated else (-1.0, 0.0)
    z = [[_shown(cell, repeated) for cell in cells] for cells in grid]
    what = "%{z:.0%} pass" if repeated else "margin %{z:.3g}"
    scale = "share that passes" if repeated else "margin"
    figure.trace(
        "heatmap",
        number,
        x=np.array(xs, float),
        y=np.array(ys, float),
        z=z,
        zmin=low,
        zmax=1.0,
        colorscale=_SHARES if repeated else _MARGINS,
        showscale=number == 1,
        colorbar={"title": {"text": scale}, "thickness": 14},
        customdata=[[cell.case for cell in cells] for cells in grid],
        text=[[escape(cell.by) for cell in cells] for cells in grid],
        hovertemplate=f"%{{x:.4g}}, %{{y:.4g}}: {what}, least in case %{{customdata}}<br>"
        "%{text}<extra></extra>",
    )
    known = [value for values in z for value in values if value is not None]
    if known and min(known) < line < max(known):
        figure.trace(
            "contour",
            number,
            x=np.array(xs, float),
            y=np.array(ys, float),
            z=z,
            showscale=False,
            showlegend=False,
            hoverinfo="skip",
            contours={"coloring": "none", "start": line, "end": line, "size": 1},
            line={"color": "#1d2730", "width": 2.2, "smoothing": 0},
        )


def _shown(cell: _Cell, repeated: bool) -> float | None:
    """Return the value of a place; None if there is none."""
    if not cell.count:
        return None
    return round(cell.passed / cell.count if repeated else max(-1.0, min(cell.margin, 1.0)), 4)


def _points(figure: Figure, found: Map, number: int, column: Any, row: Any) -> None:
    here = {found.entry.columns: column, found.entry.rows: row}
    for holds, name, symbol in (
        (True, "stated: holds", "circle"),
        (False, "stated: fails", "x"),
        (None, "point", "diamond"),
    ):
        points = [p for p in found.entry.points if p.holds is holds and _is_on(p, here)]
        if points:
            places = [[_number(value) for value in point.at] for point in points]
            figure.trace(
                "scatter",
                number,
                x=[x for x, _ in places],
                y=[y for _, y in places],
                mode="markers",
                name=name,
                legendgroup=name,
                text=[escape(point.name) for point in points],
                hovertemplate=f"%{{text}}, {name}<extra></extra>",
                marker={
                    "symbol": symbol,
                    "size": 11,
                    "color": "#ffffff" if holds else "#1d2730",
                    "line": {"color": "#1d2730", "width": 2},
                },
            )


def _is_on(point: MapPoint, here: Mapping[str | None, Any]) -> bool:
    return all(here.get(key) == _number(value) for key, value in point.panel.items())


def _number(value: Any) -> Any:
    return (
        number_and_unit(value)[0] if isinstance(value, str) and number_and_unit(value)[1] else value
    )
