"""Figures of a report: courses over time, the track and the deck seen from above."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any

import numpy as np

from ..criteria.expressions import FloatArray
from .figure import Figure

MAX_POINTS = 5000
COLOURS = ("#0b6ea8", "#d1690e", "#3a8f5c", "#8a4fa3", "#8c6d31", "#4a5a68")
PASSED, FAILED, MIXED, UNEVALUATED = "#1f7a4d", "#b3261e", "#a15c00", "#5b6770"
_LIMIT = "#b3261e"
_PANEL_HEIGHT = 165
_GUTTER = 0.09
_GRID = "#e6eaee"
_EVENT = {"color": "#9aa5af", "width": 1, "dash": "dot"}
_SPAN = {"fillcolor": "rgba(161,92,0,0.08)", "line": {"width": 0}, "layer": "below"}
_FLAG: dict[str, Any] = {
    "y": 1,
    "yanchor": "top",
    "xanchor": "left",
    "showarrow": False,
    "font": {"size": 10, "color": "#a15c00"},
}
_TITLE: dict[str, Any] = {
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
class Event:
    """Something that happens in the run: from ``at``, s, on, or until ``end``."""

    label: str
    """Short: its number in the list of the page."""
    text: str
    at: float
    end: float | None = None


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
    """A deck with landing points."""

    title: str
    points: Sequence[PadPoint]
    size: tuple[float, float] | None
    """Overall length and beam, m; None: not known, only the points are drawn."""


def decimate(
    time: FloatArray, values: FloatArray, most_points: int = MAX_POINTS
) -> tuple[FloatArray, FloatArray]:
    """Return at most so many points that keep the least and greatest value of each stretch."""
    if len(time) <= most_points:
        return time, values
    edges = np.linspace(0, len(time), (most_points - 2) // 2 + 1).astype(int)
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
    time: FloatArray,
    columns: Sequence[Sequence[Panel]],
    events: Sequence[Event] = (),
    most_points: int = MAX_POINTS,
) -> Figure:
    """Return panels in columns, all over the same time.

    Events are vertical lines, and shades as long as they last, with their labels in the first
    panel of each column. The layout's ``meta`` has what a page needs to place the panels below
    each other where it is narrow, and to show one time in all figures: ``panels`` is their
    number, ``panel_height`` that of each in pixels.
    """
    height = _PANEL_HEIGHT * max(len(column) for column in columns) + 70
    figure = Figure()
    for number, (panel, across, along, is_last) in enumerate(_placed(columns, height), start=1):
        x, y = (axis if number == 1 else f"{axis}{number}" for axis in "xy")
        for trace in _traces(time, panel, most_points):
            figure.trace("scatter", number, **trace)
        figure.x_axis(number, anchor=y, domain=across, showticklabels=is_last)
        figure.y_axis(number, anchor=x, domain=along)
        if number > 1:
            figure.x_axis(number, matches="x")
        if is_last:
            figure.x_axis(number, title={"text": "time, s"})
        place: dict[str, Any] = {"xref": f"{x} domain", "yref": f"{y} domain", **_TITLE}
        figure.annotate(text=_panel_title(panel), **place)
        is_first = along[1] == 1.0
        for event in events:
            _draw_event(figure, event, number, has_flag=is_first)
    meta = {"panels": sum(map(len, columns)), "panel_height": _PANEL_HEIGHT}
    figure.lay_out(height=height, showlegend=False, meta=meta, **layout())
    return figure


def _draw_event(figure: Figure, event: Event, number: int, *, has_flag: bool) -> None:
    figure.vertical(event.at, _EVENT, number)
    y = f"y{number if number > 1 else ''} domain"
    if event.end is not None:
        figure.shape(number, type="rect", yref=y, y0=0, y1=1, x0=event.at, x1=event.end, **_SPAN)
    if has_flag:
        flag = {"x": event.at, "text": escape(event.label), "hovertext": escape(event.text)}
        figure.annotate(number, **{**_FLAG, **flag, "yref": y})


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


def _traces(time: FloatArray, panel: Panel, most_points: int) -> Iterator[dict[str, Any]]:
    unit = escape(panel.unit) if panel.unit not in ("", "1") else ""
    shown = {"hovertemplate": f"%{{y:.5g}} {unit}"}
    for index, line in enumerate(panel.lines):
        x, y = decimate(time, line.values, most_points)
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


def track_figure(tracks: Sequence[tuple[str, FloatArray, FloatArray]]) -> Figure:
    """Return the tracks (name, north, east; m) seen from above, north up, in equal axes."""
    figure = Figure()
    for index, (name, north, east) in enumerate(tracks):
        colour = COLOURS[index % len(COLOURS)]
        step = max(1, -(-len(north) // MAX_POINTS))
        rows = np.unique(np.append(np.arange(0, len(north), step), len(north) - 1))
        figure.trace(
            "scatter",
            x=east[rows],
            y=north[rows],
            name=escape(name),
            mode="lines",
            line={"width": 1.8, "color": colour},
            hovertemplate="north %{y:.4g} m, east %{x:.4g} m",
        )
        for row, symbol, label in ((0, "circle-open", "start"), (-1, "square", "end")):
            figure.trace(
                "scatter",
                x=[east[row]],
                y=[north[row]],
                mode="markers+text",
                text=[label],
                name=label,
                textposition="bottom center",
                marker={"size": 9, "color": colour, "symbol": symbol},
                hovertemplate="north %{y:.4g} m, east %{x:.4g} m",
            )
    figure.lay_out(height=460, showlegend=False, **layout(hovermode="closest"))
    figure.x_axis(title={"text": "east, m"})
    figure.y_axis(title={"text": "north, m"}, scaleanchor="x", scaleratio=1)
    return figure


def deck_figure(decks: Sequence[Deck]) -> Figure:
    """Return decks seen from above, bow up, with their landing points coloured by verdict."""
    titles = [f"<b>{escape(deck.title)}</b>" for deck in decks]
    figure = Figure(titles)
    for col, deck in enumerate(decks, start=1):
        half_length, half_beam = _half_size(deck)
        if deck.size is not None:
            figure.shape(
                type="rect",
                x0=-half_beam,
                x1=half_beam,
                y0=-half_length,
                y1=half_length,
                line={"color": "#4a5a68", "width": 1.5},
                fillcolor="#f1f4f7",
                layer="between",
                column=col,
            )
        figure.annotate(
            x=0,
            y=half_length,
            text="bow ▲",
            showarrow=False,
            yshift=10,
            font={"size": 12},
            column=col,
        )
        figure.trace(
            "scatter",
            x=[0],
            y=[0],
            mode="markers",
            name="body origin",
            hovertemplate="body origin",
            marker={"symbol": "cross-thin", "size": 14, "line": {"width": 1.5, "color": "#4a5a68"}},
            column=col,
        )
        for point in deck.points:
            _draw_pad(figure, point, col)
        margin = 0.32 * max(half_length, half_beam)
        x_anchor = "x" if col == 1 else f"x{col}"
        figure.x_axis(
            title={"text": "starboard, m"},
            range=[-half_beam - margin, half_beam + margin],
            constrain="domain",
            column=col,
        )
        figure.y_axis(
            title={"text": "forward, m"},
            range=[-half_length - margin, half_length + margin],
            constrain="domain",
            scaleanchor=x_anchor,
            scaleratio=1,
            column=col,
        )
    figure.lay_out(height=560, showlegend=False, **layout(hovermode="closest"))
    return figure


def _half_size(deck: Deck) -> tuple[float, float]:
    """Return half of what is shown, ahead and to starboard, m: the deck, or round the points."""
    if deck.size is not None:
        length, beam = deck.size
        return length / 2, beam / 2
    reach = max((max(abs(p.forward), abs(p.starboard)) for p in deck.points), default=0.0) or 1.0
    return reach, reach


def _draw_pad(figure: Figure, point: PadPoint, col: int) -> None:
    colour, symbol, verdict = _verdict_style(point)
    label = "<br>".join(escape(label) for label in point.labels)
    figure.trace(
        "scatter",
        x=[point.starboard],
        y=[point.forward],
        mode="markers+text",
        name=label,
        meta={"cases": list(point.labels[:1])},
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
        column=col,
    )


def _verdict_style(point: PadPoint) -> tuple[str, str, str]:
    if not point.evaluated:
        return UNEVALUATED, "circle-open", "not evaluated"
    if point.passed == point.evaluated:
        return PASSED, "circle", "passed" if point.evaluated == 1 else f"{point.evaluated} passed"
    if not point.passed:
        return FAILED, "x", "FAILED" if point.evaluated == 1 else f"{point.evaluated} FAILED"
    return MIXED, "diamond", f"{point.passed} of {point.evaluated} passed"


def layout(hovermode: str = "x") -> dict[str, Any]:
    """Return what all figures share, for `Figure.lay_out`."""
    axis = {
        "gridcolor": _GRID,
        "zerolinecolor": "#c9d1d8",
        "linecolor": "#9aa5af",
        "ticks": "outside",
        "tickcolor": "#9aa5af",
        "automargin": True,
        "exponentformat": "power",
        "title": {"standoff": 6},
    }
    return {
        "template": {"layout": {"xaxis": axis, "yaxis": axis}},
        "hovermode": hovermode,
        "font": {
            "family": "system-ui, -apple-system, 'Segoe UI', sans-serif",
            "size": 12,
            "color": "#1d2730",
        },
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "#ffffff",
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": "#b4bdc5", "activecolor": "#4a5a68"},
        "margin": {"l": 50, "r": 15, "t": 40, "b": 45},
    }
