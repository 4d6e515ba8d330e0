"""Tracks, heading and helm of manoeuvres as naval architects draw them, and tables of figures."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from seatrial.model.readable import number, person_scale
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, Line, Mark, Panel, layout, time_figure

from .evaluation import Done
from .figures.record import Array
from .figures.result import Figures

_INTERVALS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0)
"""Times between two outlines, s."""
_OUTLINES = 40
"""Most outlines of a track."""
_SLENDER = 6.0
"""Length by beam of an outline whose beam is not known."""
_ROW = 22
"""Height of a row of figures, pixels."""
_ROUNDING = 1e-6
DEGREES = math.degrees(1.0)


def rows_of(found: Figures, length: float | None) -> list[tuple[str, str, str]]:
    """Return name, value with unit, and value in ship lengths of figures, as text."""
    rows = []
    for name, figure in found.found.items():
        factor, unit = person_scale(figure.unit)
        shown = f"{shown_number(factor * figure.value)} {unit if unit != '1' else ''}".rstrip()
        in_lengths = length is not None and figure.unit == "m"
        ratio = f"{number(figure.value / length)} L" if in_lengths and length else ""
        rows.append((name.replace("_", " "), shown, ratio))
    return [*rows, *((name.replace("_", " "), "–", why) for name, why in found.missing.items())]


def shown_number(value: float) -> str:
    """Return a figure as text; what is smaller than a millionth is rounding, and 0."""
    return number(value if abs(value) >= _ROUNDING else 0.0)


def table(rows: Sequence[tuple[str, str, str]]) -> Figure:
    """Return rows of text as a figure."""
    figure = Figure()
    height = _ROW * len(rows) + 20
    for row, texts in enumerate(rows):
        for at, anchor, text in zip((0.0, 0.42, 0.46), ("left", "right", "left"), texts,
                                    strict=True):  # fmt: skip
            figure.annotate(
                text=text,
                x=at,
                y=1.0 - (row + 0.5) / len(rows),
                xref="paper",
                yref="paper",
                xanchor=anchor,
                showarrow=False,
            )
    figure.lay_out(height=height, showlegend=False, **layout(hovermode="closest"))
    figure.lay_out(margin={"l": 10, "r": 10, "t": 5, "b": 5})
    figure.x_axis(visible=False)
    figure.y_axis(visible=False)
    return figure


def track(trials: Sequence[Done], circle: float | None = None) -> Figure:
    """Return tracks from the order on, the approach course up, in ship lengths, with outlines.

    Without a length they are in m, without outlines. The outlines stand where the craft was at
    equal times, at most forty; one whose beam is not known is a sixth of its length wide. A
    ``circle`` has a radius in m, about the place of the order.
    """
    figure = Figure()
    for index, done in enumerate(trials):
        colour = COLOURS[index % len(COLOURS)]
        across, along, heading, time = from_order(done)
        scale = done.length or 1.0
        figure.trace("scatter", x=across / scale, y=along / scale, mode="lines",
                     name=done.side or done.kind, line={"width": 1.6, "color": colour},
                     hovertemplate="%{y:.3f} ahead, %{x:.3f} to starboard")  # fmt: skip
        if done.length is not None:
            _outlines(figure, done, (across, along, heading, time), colour)
        if circle is not None:
            angle = np.linspace(0.0, math.tau, 73)
            figure.trace("scatter", x=circle / scale * np.sin(angle),
                         y=circle / scale * np.cos(angle), mode="lines",
                         hoverinfo="skip", name="95 % of the time",
                         line={"width": 1.0, "color": "#4a5a68"})  # fmt: skip
    unit = "ship lengths" if all(done.length for done in trials) else "m"
    figure.lay_out(height=560, showlegend=False, **layout(hovermode="closest"))
    figure.x_axis(title={"text": f"to starboard, {unit}"})
    figure.y_axis(title={"text": f"along the approach, {unit}"}, scaleanchor="x", scaleratio=1)
    return figure


def heading_and_helm(done: Done, found: Figures) -> Figure:
    """Return heading change and helm over the time from the order, overshoots marked, deg."""
    _, _, heading, time = from_order(done)
    helm = done.record.helm[-len(time) :] if done.record.helm is not None else 0.0 * time
    angle = done.heading * DEGREES
    marks = [Mark(f"{sign * angle:g} deg", sign * angle, is_band=True) for sign in (1.0, -1.0)]
    lines = [Line("heading change", heading * DEGREES), Line("helm", helm * DEGREES)]
    panel = Panel("heading change and helm, to starboard", "deg", lines, marks)
    figure = time_figure(time, [[panel]])
    figure.lay_out(height=420)
    for number_of in range(1, 5):
        names = f"reversal_{number_of}_time", f"time_to_check_yaw_{number_of}"
        if not all(name in found for name in names):
            continue
        at = found[names[0]] + found[names[1]]
        peak = float(np.interp(at, time, heading)) * DEGREES
        text = f"{found[f'overshoot_{number_of}'] * DEGREES:.1f}°"
        place = "top center" if peak > 0.0 else "bottom center"
        figure.trace("scatter", x=[at], y=[peak], mode="markers+text", text=[text],
                     textposition=place, marker={"size": 8, "color": COLOURS[1]},
                     hovertemplate=f"overshoot {number_of}: {text}")  # fmt: skip
    return figure


def from_order(done: Done) -> tuple[Array, Array, Array, Array]:
    """Return way across and along the approach, m, heading change, rad, and time, s, since then."""
    record = done.record
    order = record.start if done.first is None else done.first
    rows = record.time >= order
    course = float(record.course_kept(order))
    north, east = (np.column_stack((record.north, record.east))[rows] - record.place(order)).T
    along = north * math.cos(course) + east * math.sin(course)
    across = east * math.cos(course) - north * math.sin(course)
    return across, along, record.heading[rows] - course, record.time[rows] - order


def _outlines(
    figure: Figure, done: Done, way: tuple[Array, Array, Array, Array], colour: str
) -> None:
    across, along, heading, time = way
    assert done.length is not None
    every = next(
        (each for each in _INTERVALS if time[-1] / each <= _OUTLINES), time[-1] / _OUTLINES
    )
    half = 0.5 / _SLENDER if done.beam is None else 0.5 * done.beam / done.length
    ahead, aside = np.array([[0.5, 0.0], [0.25, half], [-0.5, half], [-0.5, -half], [0.25, -half],
                             [0.5, 0.0]]).T  # fmt: skip
    x: list[float] = []
    y: list[float] = []
    for row in np.searchsorted(time, np.arange(0.0, time[-1], every)):
        cos, sin = math.cos(heading[row]), math.sin(heading[row])
        x += [*(across[row] / done.length + ahead * sin + aside * cos).tolist(), math.nan]
        y += [*(along[row] / done.length + ahead * cos - aside * sin).tolist(), math.nan]
    figure.trace("scatter", x=np.array(x), y=np.array(y), mode="lines", hoverinfo="skip",
                 name=f"every {every:g} s", line={"width": 0.8, "color": colour})  # fmt: skip
