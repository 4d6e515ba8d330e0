"""Tethers in reports: their shape in the water, from the side and from above."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..criteria.expressions import FloatArray
from ..records.run_folder import Run, viewed
from .figure import Figure
from .plots import layout

_INSTANTS = 6
_VIRIDIS = bytes.fromhex("440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725")
_AXES = ("north", "east", "down")


def tether_figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Yield the name of each line whose whole shape was recorded, and its figure."""
    for name, _, ports in viewed(run.manifest, "line"):
        first = f"{name}.{ports['north']}."
        stations = [s.removeprefix(first) for s in run.signals if s.startswith(first)]
        signals = [[f"{name}.{ports[axis]}.{s}" for s in stations] for axis in _AXES]
        whole = all(s in run.signals for axis in signals for s in axis)
        if len(stations) > 1 and whole and len(run.time):
            shape = [np.stack([run.signals[s] for s in axis]) for axis in signals]
            yield name, shape_figure(run.time, *shape)


def shape_figure(time: FloatArray, north: FloatArray, east: FloatArray, down: FloatArray) -> Figure:
    """Return a line at some instants, m in {n}; arrays are (stations, times).

    From the side, it is seen at right angles to the vertical plane through its two ends at the
    end of the record (to the north if they lie on a vertical).
    """
    figure = Figure(["<b>from the side</b>", "<b>from above</b>"])
    run_n, run_e = north[-1, -1] - north[0, -1], east[-1, -1] - east[0, -1]
    length = np.hypot(run_n, run_e)
    along_n, along_e = (run_n / length, run_e / length) if length > 0.0 else (1.0, 0.0)
    along = (north - north[0, -1]) * along_n + (east - east[0, -1]) * along_e
    rows = np.unique(np.searchsorted(time, np.linspace(time[0], time[-1], _INSTANTS)))
    shades = _shades(np.linspace(0.85, 0.0, len(rows)))
    for row, colour in zip(rows, shades, strict=True):
        label = f"{time[row]:.4g} s"
        for col, (x, y) in enumerate(((along, down), (east, north)), start=1):
            figure.trace(
                "scatter",
                x=x[:, row],
                y=y[:, row],
                name=label,
                legendgroup=label,
                showlegend=col == 1,
                mode="lines+markers",
                line={"width": 1.6, "color": colour},
                marker={"size": 4, "color": colour},
                hovertemplate=f"%{{x:.4g}} m, %{{y:.4g}} m at {label}",
                column=col,
            )
    figure.lay_out(height=480, **layout(hovermode="closest"))
    figure.x_axis(title={"text": "from the top towards the bottom end, m"}, column=1)
    figure.y_axis(
        title={"text": "depth, m"}, autorange="reversed", scaleanchor="x", scaleratio=1, column=1
    )
    figure.x_axis(title={"text": "east, m"}, column=2)
    figure.y_axis(title={"text": "north, m"}, scaleanchor="x2", scaleratio=1, column=2)
    return figure


def _shades(places: FloatArray) -> list[str]:
    """Return the colours at places from 0 to 1 of the scale Viridis, dark to light."""
    scale = np.frombuffer(_VIRIDIS, np.uint8).reshape(-1, 3)
    whole = np.linspace(0.0, 1.0, len(scale))
    mixed = np.stack([np.interp(places, whole, part) for part in scale.T], axis=1)
    return ["#" + bytes(row).hex() for row in np.rint(mixed).astype(int).tolist()]
