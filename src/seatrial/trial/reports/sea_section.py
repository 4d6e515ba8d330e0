"""Sea, current and wind in reports: over time, and the spectrum of the waves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...physics.sea.currents import CurrentState
from ...physics.sea.seastate import NONE, SeaState
from ...physics.sea.spectra import Spectrum, statistics
from ...physics.sea.winds import WindState
from ..criteria.expressions import FloatArray
from ..files.surroundings import Met
from ..records.run_folder import Run
from .figure import Figure
from .plots import COLOURS, MAX_POINTS, Line, Panel, layout, time_figure

_REFERENCE_HEIGHT = 10.0
_FREQUENCIES = 300


@dataclass(frozen=True)
class Surroundings:
    """What the components of a run met; None of what there was not."""

    sea: SeaState | None
    current: CurrentState | None
    wind: WindState | None


def surroundings_of(run: Run) -> Surroundings:
    """Return sea, current and wind of a run, from the parameters that its manifest has."""
    return Surroundings(
        sea=_first(run, "sea", lambda met: met.sea_state(), lambda state: state.is_calm),
        current=_first(
            run, "current", lambda met: met.current_state(), lambda state: state.is_absent
        ),
        wind=_first(run, "wind", lambda met: met.wind_state(), lambda state: state.is_absent),
    )


def sea_figures(run: Run) -> Iterator[tuple[str, Figure]]:
    """Yield titles and figures of what a run met; none if all was calm."""
    met = surroundings_of(run)
    if not len(run.time):
        return
    rows = np.unique(np.linspace(0, len(run.time) - 1, MAX_POINTS).astype(int))
    time = run.time[rows]
    columns = []
    if met.sea is not None:
        columns.append([_elevation(run, met.sea, rows)])
    air_and_water = list(_over_time(met, time))
    if air_and_water:
        columns.append(air_and_water)
    if columns:
        yield "Sea, current and wind", time_figure(time, columns)
    spectrum = met.sea.spectrum_of_it() if met.sea is not None else None
    if met.sea is not None and spectrum is not None:
        yield _spectrum_title(met.sea, spectrum), _spectrum(met.sea, spectrum)


def _first(run: Run, group: str, state_of: Any, is_none: Any) -> Any:
    """Return the state of the first component that has one; None if nothing meets any."""
    for component in run.manifest["components"].values():
        met = Met("report")
        try:
            for name, entry in component["parameters"].items():
                own = name.startswith(f"{group}_") and name in met.scalar_by_name
                if own and entry["value"] is not None:
                    met.set(name, entry["value"])
            state = state_of(met)
        except InputError:  # a component of somebody else with parameters of such names
            continue
        if not is_none(state):
            return state
    return None


def _elevation(run: Run, sea: SeaState, rows: Any) -> Panel:
    """Return the elevation above each craft of the run that meets waves, or at the origin."""
    waves = sea.waves()
    assert waves is not None
    lines = []
    for name, component in run.manifest["components"].items():
        north, east = (run.signals.get(f"{name}.position.{axis}") for axis in "xy")
        meets = "sea_spectrum" in component["parameters"]
        if meets and isinstance(north, np.ndarray) and isinstance(east, np.ndarray):
            lines.append((name, north[rows], east[rows]))
    time = run.time[rows]
    at = lines or [("origin", np.zeros(len(time)), np.zeros(len(time)))]
    drawn = [Line(name, _heights(waves, time, north, east)) for name, north, east in at]
    return Panel(
        "elevation of the waves" + (f" at {drawn[0].label}" if len(drawn) == 1 else ""), "m", drawn
    )


def _heights(waves: Any, time: FloatArray, north: FloatArray, east: FloatArray) -> FloatArray:
    by = np.stack([np.cos(waves.direction), np.sin(waves.direction)]) * waves.k
    parts = [
        np.cos(np.outer(t, waves.omega) - place @ by + waves.phase) @ waves.amplitude
        for t, place in zip(
            np.array_split(time, 10), np.array_split(np.stack([north, east], 1), 10), strict=True
        )
    ]
    return np.asarray(np.concatenate(parts))


def _over_time(met: Surroundings, time: FloatArray) -> Iterator[Panel]:
    if met.wind is not None:
        air = np.array([met.wind.velocity(t, _REFERENCE_HEIGHT) for t in time.tolist()])
        yield Panel("wind at 10 m", "m/s", [Line("speed", np.hypot(air[:, 0], air[:, 1]))])
    if met.current is not None:
        water = np.array([met.current.velocity(t, 0.0) for t in time.tolist()])
        yield Panel(
            "current at the surface", "m/s", [Line("north", water[:, 0]), Line("east", water[:, 1])]
        )


def _range(sea: SeaState, spectrum: Spectrum) -> tuple[float, float]:
    return 0.5 * min(spectrum.peaks), sea.upper(spectrum)


def _spectrum_title(sea: SeaState, spectrum: Spectrum) -> str:
    of_it = statistics(spectrum, *_range(sea, spectrum))
    swells = len(sea.swells)
    trains = [] if sea.spectrum == NONE else [sea.spectrum]
    if swells:
        trains.append("a swell" if swells == 1 else f"{swells} swells")
    return (
        f"Spectrum of the waves: {' and '.join(trains)}, Hs {of_it.height:.3g} m, "
        f"Tp {math.tau / spectrum.peaks[0]:.3g} s, Tz {of_it.zero_crossing_period:.3g} s"
    )


def _spectrum(sea: SeaState, spectrum: Spectrum) -> Figure:
    low, high = _range(sea, spectrum)
    omega = np.linspace(low, min(high, 4.0 * max(spectrum.peaks)), _FREQUENCIES)
    figure = Figure()
    figure.trace(
        "scatter",
        x=omega,
        y=spectrum.density(omega),
        mode="lines",
        name="density",
        line={"width": 1.8, "color": COLOURS[0]},
        hovertemplate="%{x:.3g} rad/s: %{y:.3g} m²·s",
    )
    figure.x_axis(title={"text": "frequency, rad/s"})
    figure.y_axis(title={"text": "density, m²·s"}, rangemode="tozero")
    figure.lay_out(height=300, showlegend=False, **layout(hovermode="closest"))
    return figure
