"""Tethers in reports: their shape in the water, from the side and from above."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import plotly.graph_objects as go
from plotly.colors import sample_colorscale
from plotly.subplots import make_subplots

from .expressions import FloatArray
from .plots import layout
from .run_folder import Run

_INSTANTS = 6
_COLOURS = "Viridis"
_AXES = ("north", "east", "down")


def tether_figures(run: Run) -> Iterator[tuple[str, go.Figure]]:
    """Yield the name of each tether whose whole shape was recorded, and its figure."""
    for name, component in run.manifest["components"].items():
        stations = [s for s in run.signals if s.startswith(f"{name}.north.")]
        signals = [[s.replace(".north.", f".{axis}.") for s in stations] for axis in _AXES]
        whole = all(s in run.signals for axis in signals for s in axis)
        if component["fmu"] == "tether" and len(stations) > 1 and whole and len(run.time):
            shape = [np.stack([run.signals[s] for s in axis]) for axis in signals]
            yield name, shape_figure(run.time, *shape)


def shape_figure(
    time: FloatArray, north: FloatArray, east: FloatArray, down: FloatArray
) -> go.Figure:
    """Return a line at some instants, m in {n}; arrays are (stations, times).

    From the side, it is seen at right angles to the vertical plane through its two ends at the
    end of the record (to the north if they lie on a vertical).
    """
    figure = make_subplots(
        rows=1, cols=2, subplot_titles=["<b>from the side</b>", "<b>from above</b>"]
    )
    run_n, run_e = north[-1, -1] - north[0, -1], east[-1, -1] - east[0, -1]
    length = np.hypot(run_n, run_e)
    along_n, along_e = (run_n / length, run_e / length) if length > 0.0 else (1.0, 0.0)
    along = (north - north[0, -1]) * along_n + (east - east[0, -1]) * along_e
    rows = np.unique(np.searchsorted(time, np.linspace(time[0], time[-1], _INSTANTS)))
    shades = sample_colorscale(_COLOURS, np.linspace(0.85, 0.0, len(rows)))
    for row, colour in zip(rows, shades, strict=True):
        label = f"{time[row]:.4g} s"
        for col, (x, y) in enumerate(((along, down), (east, north)), start=1):
            figure.add_scatter(
                x=x[:, row],
                y=y[:, row],
                name=label,
                legendgroup=label,
                showlegend=col == 1,
                mode="lines+markers",
                line={"width": 1.6, "color": colour},
                marker={"size": 4, "color": colour},
                hovertemplate=f"%{{x:.4g}} m, %{{y:.4g}} m at {label}",
                row=1,
                col=col,
            )
    figure.update_layout(height=480, **layout(hovermode="closest"))
    figure.update_xaxes(title_text="from the top towards the bottom end, m", row=1, col=1)
    figure.update_yaxes(
        title_text="depth, m", autorange="reversed", scaleanchor="x", scaleratio=1, row=1, col=1
    )
    figure.update_xaxes(title_text="east, m", row=1, col=2)
    figure.update_yaxes(title_text="north, m", scaleanchor="x2", scaleratio=1, row=1, col=2)
    return figure
