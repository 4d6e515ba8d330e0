"""Figures of a report: courses over time, the track and the deck seen from above."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from .expressions import FloatArray

MAX_POINTS = 5000
COLOURS = ("#0b6ea8", "#d1690e", "#3a8f5c", "#8a4fa3", "#8c6d31", "#4a5a68")
PASSED, FAILED, MIXED, UNJUDGED = "#1f7a4d", "#b3261e", "#a15c00", "#5b6770"
_LIMIT = "#b3261e"
_PANEL_HEIGHT = 165
_GUTTER = 0.09
_GRID = "#e6eaee"
_EVENT = {"color": "#9aa5af", "width": 1, "dash": "dot"}
_TITLE = {
    "x": 0,
    "y": 1,
    "xanchor": "left",
    "yanchor": "bottom",
    "showarrow": False,
    "font": {"size": 13},
}


@dataclass(frozen=True)
class Line:
    """A signal to draw, in the panel's unit."""

    label: str
    values: FloatArray


@dataclass(frozen=True)
class Mark:
    """A horizontal line at a limit, or at the edge of a band, in the panel's unit."""

    label: str
    value: float
    is_band: bool = False


@dataclass(frozen=True)
class Panel:
    """One set of axes over time."""

    title: str
    unit: str
    lines: Sequence[Line]
    marks: Sequence[Mark] = ()


@dataclass(frozen=True)
class PadPoint:
    """A landing point on the deck: forward and starboard of the body origin, m."""

    forward: float
    starboard: float
    labels: Sequence[str]
    """The runs that land there."""
    passed: int
    """How many of the ``evaluated`` ones among them passed."""
    evaluated: int


@dataclass(frozen=True)
class Deck:
    """A deck with landing points, and its overall length and beam, m."""

    title: str
    points: Sequence[PadPoint]
    length: float
    beam: float


def decimate(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return at most `MAX_POINTS` points that keep the least and greatest value of each stretch."""
    if len(time) <= MAX_POINTS:
        return time, values
    edges = np.linspace(0, len(time), (MAX_POINTS - 2) // 2 + 1).astype(int)
    kept = {0, len(time) - 1}
    low, high = (
        np.where(np.isnan(values), np.inf, values),
        np.where(np.isnan(values), -np.inf, values),
    )
    for start, end in pairwise(edges):
        kept.add(start + int(np.argmin(low[start:end])))
        kept.add(start + int(np.argmax(high[start:end])))
    rows = sorted(kept)
    return time[rows], values[rows]


def time_figure(
    time: FloatArray, columns: Sequence[Sequence[Panel]], events: Sequence[float] = ()
) -> go.Figure:
    """Return panels in columns, all over the same time, with events as vertical lines."""
    height = _PANEL_HEIGHT * max(len(column) for column in columns) + 70
    traces: list[dict[str, Any]] = []
    axes: dict[str, Any] = {}
    titles, events_drawn = [], []
    for number, (panel, across, along, is_last) in enumerate(_placed(columns, height), start=1):
        x, y = (axis if number == 1 else f"{axis}{number}" for axis in "xy")
        traces += [{**trace, "xaxis": x, "yaxis": y} for trace in _traces(time, panel)]
        axes[f"xaxis{number}"] = {"anchor": y, "domain": across, "showticklabels": is_last}
        axes[f"yaxis{number}"] = {"anchor": x, "domain": along}
        if number > 1:
            axes[f"xaxis{number}"]["matches"] = "x"
        if is_last:
            axes[f"xaxis{number}"]["title"] = {"text": "time, s"}
        place = {"xref": f"{x} domain", "yref": f"{y} domain"}
        titles.append({"text": _panel_title(panel), **place, **_TITLE})
        ends = {"xref": x, "yref": f"{y} domain", "y0": 0, "y1": 1}
        events_drawn += [
            {"type": "line", "x0": at, "x1": at, "line": _EVENT, **ends} for at in events
        ]
    # All at once: whatever is added later has the whole figure checked again.
    return go.Figure(
        traces,
        {
            **axes,
            "annotations": titles,
            "shapes": events_drawn,
            "height": height,
            "showlegend": False,
            **layout(),
        },
    )


def _placed(
    columns: Sequence[Sequence[Panel]], height: float
) -> Iterator[tuple[Panel, list[float], list[float], bool]]:
    """Yield panels, their parts of the width and of the height, and if one ends its column."""
    rows = max(len(column) for column in columns)
    gap = min(0.2, 38 / height)
    wide = (1.0 - _GUTTER * (len(columns) - 1)) / len(columns)
    high = (1.0 - gap * (rows - 1)) / rows
    for c, column in enumerate(columns):
        left = c * (wide + _GUTTER)
        for r, panel in enumerate(column):
            top = 1.0 - r * (high + gap)
            is_last = r == len(column) - 1
            yield panel, [left, min(left + wide, 1.0)], [max(top - high, 0.0), top], is_last


def _panel_title(panel: Panel) -> str:
    unit = f", {escape(panel.unit)}" if panel.unit not in ("", "1") else ""
    title = f"<b>{escape(panel.title)}</b>{unit}"
    if len(panel.lines) > 1:
        keys = (
            f'<span style="color:{COLOURS[i % len(COLOURS)]}">━ {escape(line.label)}</span>'
            for i, line in enumerate(panel.lines)
        )
        title += "    " + "  ".join(keys)
    return title


def _traces(time: FloatArray, panel: Panel) -> Iterator[dict[str, Any]]:
    unit = escape(panel.unit) if panel.unit not in ("", "1") else ""
    shown = {"type": "scatter", "hovertemplate": f"%{{y:.5g}} {unit}"}
    for index, line in enumerate(panel.lines):
        x, y = decimate(time, line.values)
        yield {
            **shown,
            "x": x,
            "y": y,
            "name": escape(line.label),
            "mode": "lines" if len(x) > 1 else "markers",
            "line": {"width": 1.6, "color": COLOURS[index % len(COLOURS)]},
        }
    for mark in panel.marks if len(time) else ():
        yield {
            **shown,
            "x": [time[0], time[-1]],
            "y": [mark.value, mark.value],
            "name": escape(mark.label),
            "mode": "lines",
            "line": {"width": 1.3, "color": _LIMIT, "dash": "dot" if mark.is_band else "dash"},
        }


def track_figure(tracks: Sequence[tuple[str, FloatArray, FloatArray]]) -> go.Figure:
    """Return the tracks (name, north, east; m) seen from above, north up, in equal axes."""
    figure = go.Figure()
    for index, (name, north, east) in enumerate(tracks):
        colour = COLOURS[index % len(COLOURS)]
        step = max(1, -(-len(north) // MAX_POINTS))
        rows = np.unique(np.append(np.arange(0, len(north), step), len(north) - 1))
        figure.add_scatter(
            x=east[rows],
            y=north[rows],
            name=escape(name),
            mode="lines",
            line={"width": 1.8, "color": colour},
            hovertemplate="north %{y:.4g} m, east %{x:.4g} m",
        )
        for row, symbol, label in ((0, "circle-open", "start"), (-1, "square", "end")):
            figure.add_scatter(
                x=[east[row]],
                y=[north[row]],
                mode="markers+text",
                text=[label],
                name=label,
                textposition="bottom center",
                marker={"size": 9, "color": colour, "symbol": symbol},
                hovertemplate="north %{y:.4g} m, east %{x:.4g} m",
            )
    figure.update_layout(height=460, showlegend=False, **layout(hovermode="closest"))
    figure.update_xaxes(title_text="east, m")
    figure.update_yaxes(title_text="north, m", scaleanchor="x", scaleratio=1)
    return figure


def deck_figure(decks: Sequence[Deck]) -> go.Figure:
    """Return decks seen from above, bow up, with their landing points coloured by verdict."""
    titles = [f"<b>{escape(deck.title)}</b>" for deck in decks]
    figure = make_subplots(rows=1, cols=len(decks), subplot_titles=titles)
    for col, deck in enumerate(decks, start=1):
        half_beam, half_length = deck.beam / 2, deck.length / 2
        figure.add_shape(
            type="rect",
            x0=-half_beam,
            x1=half_beam,
            y0=-half_length,
            y1=half_length,
            line={"color": "#4a5a68", "width": 1.5},
            fillcolor="#f1f4f7",
            layer="between",
            row=1,
            col=col,
        )
        figure.add_annotation(
            x=0,
            y=half_length,
            text="bow ▲",
            showarrow=False,
            yshift=10,
            font_size=12,
            row=1,
            col=col,
        )
        figure.add_scatter(
            x=[0],
            y=[0],
            mode="markers",
            name="body origin",
            hovertemplate="body origin",
            marker={"symbol": "cross-thin", "size": 14, "line": {"width": 1.5, "color": "#4a5a68"}},
            row=1,
            col=col,
        )
        for point in deck.points:
            _draw_pad(figure, point, col)
        margin = 0.16 * max(deck.length, deck.beam)
        x_anchor = "x" if col == 1 else f"x{col}"
        figure.update_xaxes(
            title_text="starboard, m",
            range=[-half_beam - margin, half_beam + margin],
            constrain="domain",
            row=1,
            col=col,
        )
        figure.update_yaxes(
            title_text="forward, m",
            range=[-half_length - margin, half_length + margin],
            constrain="domain",
            scaleanchor=x_anchor,
            scaleratio=1,
            row=1,
            col=col,
        )
    figure.update_layout(height=560, showlegend=False, **layout(hovermode="closest"))
    return figure


def _draw_pad(figure: go.Figure, point: PadPoint, col: int) -> None:
    colour, symbol, verdict = _verdict_style(point)
    label = "<br>".join(escape(label) for label in point.labels)
    figure.add_scatter(
        x=[point.starboard],
        y=[point.forward],
        mode="markers+text",
        name=label,
        text=[verdict],
        textposition="bottom center",
        textfont={"color": colour, "size": 12},
        marker={
            "size": 15,
            "symbol": symbol,
            "color": colour,
            "line": {"width": 1, "color": "#fff"},
        },
        hovertemplate=f"{label}<br>%{{y:.3f}} m forward, %{{x:.3f}} m starboard",
        row=1,
        col=col,
    )


def _verdict_style(point: PadPoint) -> tuple[str, str, str]:
    if not point.evaluated:
        return UNJUDGED, "circle-open", "not evaluated"
    if point.passed == point.evaluated:
        return PASSED, "circle", "passed" if point.evaluated == 1 else f"{point.evaluated} passed"
    if not point.passed:
        return FAILED, "x", "FAILED" if point.evaluated == 1 else f"{point.evaluated} FAILED"
    return MIXED, "diamond", f"{point.passed} of {point.evaluated} passed"


def figure_json(figure: go.Figure) -> str:
    """Return a figure as JSON that may stand inside a script element."""
    text: str = figure.to_json()
    return text.replace("<", "\\u003c")


def layout(hovermode: str = "x") -> dict[str, Any]:
    """Return what all figures share, for ``update_layout``."""
    axis = {
        "gridcolor": _GRID,
        "zerolinecolor": "#c9d1d8",
        "linecolor": "#9aa5af",
        "ticks": "outside",
        "tickcolor": "#9aa5af",
        "automargin": True,
        "exponentformat": "power",
        "title_standoff": 6,
    }
    template = go.layout.Template(layout={"xaxis": axis, "yaxis": axis})
    return {
        "template": template,
        "hovermode": hovermode,
        "font": {"family": "system-ui, -apple-system, 'Segoe UI', sans-serif", "size": 12},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#b4bdc5", "activecolor": "#4a5a68"},
        "margin": {"l": 50, "r": 15, "t": 40, "b": 45},
    }
