"""Truth, estimate, home, and marks of a run under an autopilot: whose fault a missed mark is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.readable import number
from ..criteria.expressions import FloatArray
from ..records.run_folder import Run, viewed
from .figure import Figure

_BELIEVED = "#8d5fc4"
_HOVER = "north %{y:.4g} m, east %{x:.4g} m"


@dataclass(frozen=True)
class Row:
    """One figure: its subject, and its value in words."""

    what: str
    value: str


@dataclass(frozen=True)
class _Believed:
    """What an autopilot said of itself, in rows from ``first`` on: north and east, m."""

    first: int
    home: tuple[float, float]
    north: FloatArray
    east: FloatArray
    error: FloatArray
    passed: FloatArray
    """Number of marks passed on the true track."""


def add_estimate(figure: Figure, run: Run) -> None:
    """Draw the track that the autopilot takes for its own, and its home, into a track."""
    for _, _, believed in _believed(run):
        figure.trace(
            "scatter",
            x=believed.east,
            y=believed.north,
            name="estimate",
            mode="lines",
            line={"width": 1.4, "color": _BELIEVED, "dash": "dot"},
            hovertemplate=f"estimate: {_HOVER}",
        )
        figure.trace(
            "scatter",
            x=[believed.home[1]],
            y=[believed.home[0]],
            name="home",
            mode="markers+text",
            text=["home of the autopilot"],
            textposition="top center",
            marker={"size": 10, "symbol": "cross-thin-open", "color": _BELIEVED},
            hovertemplate=f"home of the autopilot: {_HOVER}",
        )


def autopilot_rows(run: Run) -> list[Row]:
    """Return the figures of the section; none where no autopilot has said where it is."""
    rows = []
    for name, entry, believed in _believed(run):
        north, east = believed.home
        rows += [
            Row(
                "estimate against truth, horizontally",
                f"at most {number(believed.error.max())} m, "
                f"median {number(np.median(believed.error))} m",
            ),
            Row(
                "home of the autopilot, from the origin",
                f"{number(float(np.hypot(north, east)))} m "
                f"({number(north)} m north, {number(east)} m east)",
            ),
        ]
        rows += list(_nearest(run, name, entry, believed))
    return rows


def _believed(run: Run) -> Iterator[tuple[str, Mapping[str, Any], _Believed]]:
    for name, entry, ports in viewed(run.manifest, "estimate"):
        signals = [
            *(f"{name}.{ports['place']}.{axis}" for axis in ("north", "east")),
            *(f"{name}.{ports['home']}.{axis}" for axis in ("north", "east")),
            *(f"{name}.{ports[port]}" for port in ("error", "passed")),
        ]
        if not all(isinstance(run.signals.get(signal), np.ndarray) for signal in signals):
            continue
        north, east, home_north, home_east, error, passed = (
            run.signals[signal] for signal in signals
        )
        said = np.flatnonzero((north != 0.0) | (east != 0.0))
        if not len(said):
            continue
        first = int(said[0])
        home = float(home_north[-1]), float(home_east[-1])
        of_rows = (values[first:] for values in (north, east, error, passed))
        yield name, entry, _Believed(first, home, *of_rows)


def _nearest(run: Run, name: str, entry: Mapping[str, Any], believed: _Believed) -> Iterator[Row]:
    """Yield how near the true track and the estimate came to each mark, and when."""
    track = _track(run)
    ports = entry["views"].get("waypoints")
    if track is None or ports is None:
        return
    parameters = entry["parameters"]
    for n in range(1, int(parameters[ports["count"]]["value"]) + 1):
        north, east = (parameters[f"{ports['place']}_{n}.{axis}"]["value"] for axis in _HORIZONTAL)
        rows = np.flatnonzero(believed.passed >= n - 1)
        if not len(rows):
            yield Row(_mark(n, north, east), "not on its way there: the one before was not passed")
            return
        true = np.hypot(track[0] - north, track[1] - east)[believed.first :][rows]
        taken = np.hypot(believed.north - north, believed.east - east)[rows]
        at = run.time[believed.first + rows[true.argmin()]]
        yield Row(
            _mark(n, north, east),
            f"nearest {number(true.min())} m at {number(at, 5)} s, "
            f"by its estimate {number(taken.min())} m",
        )


def _mark(n: int, north: float, east: float) -> str:
    return f"mark {n} ({number(north)} m north, {number(east)} m east)"


_HORIZONTAL = ("north", "east")


def _track(run: Run) -> tuple[FloatArray, FloatArray] | None:
    """Return the true track, north and east, m, of the only craft."""
    ends = (".position.x", ".position.y")
    found = [[name for name in run.signals if name.endswith(end)] for end in ends]
    if any(len(names) != 1 for names in found):
        return None
    return run.signals[found[0][0]], run.signals[found[1][0]]
