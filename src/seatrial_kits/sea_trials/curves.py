"""Curves of manoeuvres: spirals, speed and power, and what changes over the time from the order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, Line, Panel, layout, time_figure

from .drawing import DEGREES, from_order, heading_and_helm, rows_of, table, track
from .evaluation import Done, spiral_curve
from .figures.record import Array
from .figures.result import Figures
from .figures.straight import speed_ahead

Trial = tuple[Done, Figures]
Drawn = Iterator[tuple[str, Figure]]
_LARGE = 1e4
"""W; a power from which on it is drawn in kW."""
_POINTS = 100
"""Of a fitted curve."""


def drawings(done: Done, found: Figures) -> Drawn:
    """Yield title and figure of a manoeuvre: its figures, and what is drawn of its kind."""
    name = found.manoeuvre.capitalize()
    yield f"{name}: figures", table(rows_of(found, done.length))
    for title, figure in drawn_together([(done, found)]):
        yield f"{name}: {title}", figure


def drawn_together(trials: Sequence[Trial]) -> Drawn:
    """Yield title and figure of runs of one manoeuvre, to both sides say."""
    for draw in _DRAWN[trials[0][0].kind]:
        yield from draw(trials)


def spiral_figure(spirals: Sequence[Done]) -> Figure:
    """Return r' = r L / U against helm, deg, step by step, of spirals; r in deg/s without L."""
    figure = Figure()
    for number, done in enumerate(spirals):
        helm, rate = spiral_curve(done)
        scale = DEGREES if done.length is None else 1.0
        figure.trace("scatter", x=helm * DEGREES, y=rate * scale, mode="lines+markers",
                     name=done.kind, line={"width": 1.6, "color": COLOURS[number]},
                     hovertemplate="helm %{x:.3g} deg: %{y:.4g}")  # fmt: skip
    figure.lay_out(height=460, showlegend=len(spirals) > 1, **layout(hovermode="closest"))
    figure.x_axis(title={"text": "helm, deg, positive to turn to starboard"})
    r = "r' = r L / U" if spirals[0].length is not None else "r, deg/s"
    figure.y_axis(title={"text": f"{r}, positive to starboard"})
    return figure


def _spirals(trials: Sequence[Trial]) -> Drawn:
    yield "rate of turn against helm", spiral_figure([done for done, _ in trials])


def _track(trials: Sequence[Trial]) -> Drawn:
    yield "track", track([done for done, _ in trials])


def _box(trials: Sequence[Trial]) -> Drawn:
    for done, found in trials:
        yield "track", track([done], found["radius_95"])


def _headings(trials: Sequence[Trial]) -> Drawn:
    for done, found in trials:
        yield f"heading and helm{_side(done)}", heading_and_helm(done, found)


def _speeds(trials: Sequence[Trial]) -> Drawn:
    for done, _ in trials:
        speed = speed_ahead(done.record)(done.record.time)
        yield f"speed{_side(done)}", _over_time(done, "speed along the bow", "m/s", speed)


def _pulls(trials: Sequence[Trial]) -> Drawn:
    for done, _ in trials:
        yield "pull", _over_time(done, "pull of the line", "N", done.record.pull)


def _depths(trials: Sequence[Trial]) -> Drawn:
    for done, _ in trials:
        columns = (("depth, positive down", "m", done.record.depth, 1.0),
                   ("pitch, bow up", "deg", done.record.pitch, DEGREES))  # fmt: skip
        for title, unit, values, scale in columns:
            if values is not None:
                yield title, _over_time(done, title, unit, values * scale)


def _speed_power(trials: Sequence[Trial]) -> Drawn:
    for _, found in trials:
        numbers = [n for n in range(1, 20) if f"speed_{n}" in found]
        speeds = np.array([found[f"speed_{n}"] for n in numbers])
        if "power_1" in found:
            powers = np.array([found[f"power_{n}"] for n in numbers])
            yield "speed and power", _speed_power_figure(speeds, powers, found)


def _speed_power_figure(speeds: Array, powers: Array, found: Figures) -> Figure:
    figure, (scale, unit) = Figure(), (1e-3, "kW") if powers.max() > _LARGE else (1.0, "W")
    if "speed_power_exponent" in found:
        at = np.linspace(speeds.min(), speeds.max(), _POINTS)
        fitted = found["power_at_unit_speed"] * at ** found["speed_power_exponent"]
        figure.trace("scatter", x=at, y=fitted * scale, mode="lines", name="P = c U^n",
                     line={"width": 1.2, "color": COLOURS[1]}, hoverinfo="skip")  # fmt: skip
    figure.trace("scatter", x=speeds, y=powers * scale, mode="markers", name="double runs",
                 marker={"size": 8, "color": COLOURS[0]},
                 hovertemplate=f"%{{x:.3f}} m/s: %{{y:.4g}} {unit}")  # fmt: skip
    figure.lay_out(height=420, showlegend=False, **layout(hovermode="closest"))
    figure.x_axis(title={"text": "speed through the water, m/s"}, rangemode="tozero")
    figure.y_axis(title={"text": f"power, {unit}"}, rangemode="tozero")
    return figure


def _over_time(done: Done, title: str, unit: str, values: Array) -> Figure:
    _, _, _, time = from_order(done)
    panel = Panel(
        f"{title}, over the time from the order", unit, [Line(title, values[-len(time) :])]
    )
    return time_figure(time, [[panel]])


def _side(done: Done) -> str:
    return f", {done.side}" if done.side else ""


_DRAWN: Mapping[str, Sequence[Callable[[Sequence[Trial]], Drawn]]] = {
    "turning-circle": (_track,),
    "zig-zag": (_headings, _track),
    "initial-turning": (_headings,),
    "pull-out": (_headings,),
    "spiral": (_spirals,),
    "reverse-spiral": (_spirals,),
    "crash-stop": (_track, _speeds),
    "stopping": (_speeds,),
    "acceleration": (_speeds,),
    "speed-trial": (_speed_power,),
    "williamson": (_track, _headings),
    "turn-on-the-spot": (_track,),
    "bollard-pull": (_pulls,),
    "station-keeping": (_box,),
    "depth-step": (_depths,),
    "vertical-zig-zag": (_depths,),
}
"""What is drawn of each manoeuvre."""
