"""Wind and marks on the track of a report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..records.run_folder import Run, viewed
from .figure import Figure

_WIND = "#5b6770"


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


def wind_signals(run: Run) -> tuple[str, str] | None:
    """Return the signals of the wind's velocity, north and east, if they were recorded."""
    for name, _, ports in viewed(run.manifest, "wind"):
        north, east = (f"{name}.{ports['velocity']}.{axis}" for axis in ("north", "east"))
        if are_numbers(run, (north, east)):
            return north, east
    return None


def are_numbers(run: Run, signals: Iterable[str]) -> bool:
    """Say if signals were recorded, and as numbers: somebody else may have written the record."""
    return all(isinstance(run.signals.get(name), np.ndarray) for name in signals)


def _mean_wind(run: Run) -> tuple[float, float] | None:
    """Return the mean velocity of the air, north and east, m/s."""
    wind = wind_signals(run)
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
