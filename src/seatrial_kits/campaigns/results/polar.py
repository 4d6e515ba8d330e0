"""Polar diagram of a campaign: speed over the angle off the wind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from seatrial.trial.records.ending import is_whole
from seatrial.trial.records.run_folder import Run
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout
from seatrial.trial.reports.wind_and_marks import are_numbers, wind_signals

_STEADY = 0.25  # share of a run, at its end, that a point of the diagram is the mean of
_DIRECTIONS = 5  # the diagram needs at least so many different angles off the wind


@dataclass(frozen=True)
class PolarPoint:
    """Mean speed over ground (m/s) at a mean angle off the wind (rad, 0 to pi)."""

    label: str
    series: str
    angle: float
    speed: float


def polar_point(run: Run, label: str, series: str) -> PolarPoint | None:
    """Return where a run lies in a polar diagram: the mean of its last quarter.

    None without a recorded wind and one craft with velocity and heading, or if the run is not
    complete.
    """
    wind, psi = wind_signals(run), ".attitude.psi"
    craft = [name.removesuffix(psi) for name in run.signals if name.endswith(psi)]
    needed = [f"{name}.velocity.{axis}" for name in craft for axis in ("u", "v")]
    complete = is_whole(run.manifest["status"]) and len(run.time)
    if wind is None or len(craft) != 1 or not complete:
        return None
    if not are_numbers(run, (craft[0] + psi, *needed)):
        return None
    last = run.time >= run.time[-1] - _STEADY * (run.time[-1] - run.time[0])
    north, east = (run.signals[name][last] for name in wind)
    off = run.signals[craft[0] + psi][last] - np.arctan2(-east, -north)
    speed = np.hypot(*(run.signals[name][last] for name in needed))
    angle = abs(float(np.angle(np.exp(1j * off).mean())))
    return PolarPoint(label, series, angle, float(speed.mean()))


def polar_figure(points: Sequence[PolarPoint]) -> Figure | None:
    """Return speed over the angle off the wind, or None if the points lie in few directions."""
    if len({round(np.degrees(p.angle) / 5.0) for p in points}) < _DIRECTIONS:
        return None
    figure = Figure()
    for index, series in enumerate(dict.fromkeys(p.series for p in points)):
        own = sorted((p for p in points if p.series == series), key=lambda p: p.angle)
        figure.trace(
            "scatterpolar",
            theta=[float(np.degrees(p.angle)) for p in own],
            r=[p.speed for p in own],
            mode="lines+markers",
            name=escape(series),
            line={"width": 1.8, "color": COLOURS[index % len(COLOURS)]},
            text=[escape(p.label) for p in own],
            meta={"cases": [p.label for p in own]},
            hovertemplate="%{text}<br>%{theta:.1f}° off the wind, %{r:.3g} m/s",
        )
    figure.lay_out(height=560, **layout(hovermode="closest"))
    figure.lay_out(
        polar={
            "sector": [-90, 90],
            "bgcolor": "#ffffff",
            "angularaxis": {"rotation": 90, "direction": "clockwise", "dtick": 15},
            "radialaxis": {"rangemode": "tozero", "angle": 90, "tickangle": 90},
        }
    )
    return figure
