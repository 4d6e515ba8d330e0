"""Sailing in reports: wind and marks on the track, and a polar diagram of a campaign."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from ..records.ending import is_whole
from ..records.run_folder import Run, viewed
from .figure import Figure
from .plots import COLOURS, layout

_STEADY = 0.25  # share of a run, at its end, that a point of the polar diagram is the mean of
_DIRECTIONS = 5  # a polar diagram needs at least so many different angles off the wind
_WIND = "#5b6770"


@dataclass(frozen=True)
class PolarPoint:
    """Mean speed over ground (m/s) at a mean angle off the wind (rad, 0 to pi)."""

    label: str
    series: str
    angle: float
    speed: float


def add_wind_and_marks(figure: Figure, run: Run) -> None:
    """Draw the run's mean wind as an arrow, and the marks of its course, into a track."""
    for _, component, ports in viewed(run.manifest, "waypoints"):
        _draw_marks(figure, component["parameters"], ports)
    wind = _mean_wind(run)
    if wind is not None:
        _draw_wind(figure, wind)


def _draw_marks(figure: Figure, parameters: Mapping[str, Any], ports: Mapping[str, str]) -> None:
    for number in range(1, int(parameters[ports["count"]]["value"]) + 1):
        place = f"{ports['place']}_{number}"
        north, east = (parameters[f"{place}.{axis}"]["value"] for axis in ("north", "east"))
        figure.trace(
            "scatter",
            x=[east],
            y=[north],
            mode="markers+text",
            text=[str(number)],
            textposition="middle right",
            name=f"waypoint {number}",
            marker={"size": 12, "symbol": "triangle-up-open", "color": "#d1690e"},
            hovertemplate=f"waypoint {number}: north %{{y:.4g}} m, east %{{x:.4g}} m",
        )


def polar_point(run: Run, label: str, series: str) -> PolarPoint | None:
    """Return where a run lies in a polar diagram: the mean of its last quarter.

    None without a recorded wind and one craft with velocity and heading, or if the run is not
    complete.
    """
    wind, psi = _wind_signals(run), ".attitude.psi"
    craft = [name.removesuffix(psi) for name in run.signals if name.endswith(psi)]
    needed = [f"{name}.velocity.{axis}" for name in craft for axis in ("u", "v")]
    complete = is_whole(run.manifest["status"]) and len(run.time)
    if wind is None or len(craft) != 1 or not complete:
        return None
    if not _are_numbers(run, (craft[0] + psi, *needed)):
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


def _wind_signals(run: Run) -> tuple[str, str] | None:
    """Return the signals of the wind's velocity, north and east, if they were recorded."""
    for name, _, ports in viewed(run.manifest, "wind"):
        north, east = (f"{name}.{ports['velocity']}.{axis}" for axis in ("north", "east"))
        if _are_numbers(run, (north, east)):
            return north, east
    return None


def _are_numbers(run: Run, signals: Iterable[str]) -> bool:
    """Say if signals were recorded, and as numbers: somebody else may have written the record."""
    return all(isinstance(run.signals.get(name), np.ndarray) for name in signals)


def _mean_wind(run: Run) -> tuple[float, float] | None:
    """Return the mean velocity of the air, north and east, m/s."""
    wind = _wind_signals(run)
    if wind is None or not len(run.time):
        return None
    north, east = (run.signals[name].mean() for name in wind)
    return float(north), float(east)


def _draw_wind(figure: Figure, wind: tuple[float, float]) -> None:
    """Draw an arrow of fixed length in the upper left corner, where the wind blows to."""
    north, east = wind
    speed = float(np.hypot(north, east))
    if speed == 0.0:
        return
    figure.annotate(
        x=0.07,
        y=0.86,
        xref="paper",
        yref="paper",
        ax=-44.0 * east / speed,
        ay=44.0 * north / speed,
        arrowhead=2,
        arrowwidth=2,
        arrowcolor=_WIND,
        text="",
    )
    figure.annotate(
        x=0.07,
        y=0.86,
        xref="paper",
        yref="paper",
        xshift=34,
        text=f"wind {speed:.2g} m/s",
        showarrow=False,
        xanchor="left",
        font={"color": _WIND},
    )
