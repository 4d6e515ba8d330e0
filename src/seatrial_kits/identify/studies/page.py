"""The page of an identification: parameters, rules, fit, residual, and a free run."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number, person_scale
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, Line, Panel, layout, time_figure
from seatrial.trial.reports.report import REPORT, render

from .study import Study

_BAND = {"color": "#b3261e", "width": 1.2, "dash": "dot"}


@dataclass(frozen=True)
class RatioRow:
    """A ratio as the page and the terminal show it: ours, its deviation, the source's method."""

    symbol: str
    unit: str
    ours: str
    deviation: str
    source: str


@dataclass(frozen=True)
class PhysicalRow:
    """A parameter of the vehicle."""

    name: str
    value: str
    deviation: str
    unit: str


def write_page(study: Study, folder: Path, parameters: str | None) -> Path:
    """Write ``report.html`` into a folder; ``parameters`` names the file written beside it."""
    experiment = study.experiment
    page = render(
        "identification.html.j2",
        title=experiment.file.title or experiment.name,
        axis=experiment.file.axis,
        study=study,
        accepted=study.accepted,
        parameters=parameters,
        log=study.log_path,
        test_log=None if study.test_path == study.log_path else study.test_path,
        rows=f"{len(study.fitted.command)} rows, {number(study.fitted.period, 6)} s apart",
        held_out=f"{len(study.test.command)} rows",
        thrust_law=experiment.file.thrust_law,
        ratios=ratio_rows(study),
        physical=physical_rows(study),
        delay=f"{number(study.delay, 6)} s",
        source_delay=f"{number(study.source.delay * study.fitted.period, 6)} s",
        mass=experiment.file.known.mass,
        thrust=experiment.file.known.thrust,
        known_source=experiment.file.known.source,
        free_run_fit=f"{100.0 * study.free_run_fit:.1f} %",
        outside=f"{study.whiteness.outside} of {len(study.whiteness.correlation)}",
        ratio=number(_correlation_factor(study), 2),
        fitted=_time_figure(study, held_out=False).json(),
        held_out_figure=_time_figure(study, held_out=True).json(),
        autocorrelation=_autocorrelation_figure(study).json(),
        delays=_delay_figure(study).json(),
    )
    path = folder / REPORT
    write_whole(path, page)
    return path


def ratio_rows(study: Study) -> list[RatioRow]:
    """Return what the log shows, beside what the method of [Paulino2015] makes of it."""
    angle = study.experiment.rotation
    units = ("1/s", "1/rad" if angle else "1/m", *(("rad/s2",) * 2 if angle else ("m/s2",) * 2))
    names = ("linear", "quadratic", "offset", "thrust")
    rows = []
    for symbol, name, unit in zip(("B/A", "C/A", "D/A", "E/A"), names, units, strict=True):
        if name == "offset" and not study.experiment.offset:
            continue
        rows.append(
            RatioRow(
                symbol,
                unit,
                number(study.estimate.values[name], 5),
                number(study.estimate.deviation(name), 2),
                number(getattr(study.source, name), 5),
            )
        )
    if study.estimate.structure.lag == "thruster":
        value = number(study.estimate.values["time_constant"], 4)
        rows.append(
            RatioRow("T", "s", value, number(study.estimate.deviation("time_constant"), 2), "")
        )
    return rows


def physical_rows(study: Study) -> list[PhysicalRow]:
    """Return the parameters of the vehicle with their deviations."""
    angle = study.experiment.rotation
    mass, force, velocity = ("kg.m2", "N.m", "rad") if angle else ("kg", "N", "m")
    drag = (f"{force}.s/{velocity}", f"{force}.s2/{velocity}2")
    what = "inertia" if angle else "mass"
    names = {
        "total mass": (f"{what} with added {what}", mass),
        "added mass": (f"added {what}", mass),
        "linear": ("linear drag", drag[0]),
        "quadratic": ("quadratic drag", drag[1]),
        "offset": ("constant moment" if angle else "constant force", force),
    }
    if not study.experiment.offset:
        del names["offset"]
    found = study.physical()
    return [
        PhysicalRow(text, number(found[key].value, 5), number(found[key].deviation, 2), unit)
        for key, (text, unit) in names.items()
    ]


def _correlation_factor(study: Study) -> float:
    """Return how many times a deviation is at most what a white residual would make it."""
    white, coloured = (
        np.diag(covariance)
        for covariance in (study.estimate.white_covariance, study.estimate.covariance)
    )
    known = white > 0.0
    return float(np.sqrt((coloured[known] / white[known]).max(initial=0.0)))


def _time_figure(study: Study, *, held_out: bool) -> Figure:
    log = study.test if held_out else study.fitted
    residual = log.measured - study.free_run if held_out else study.estimate.residual
    if log.reading == "acceleration":
        what, unit = "acceleration", "m/s2"
    else:
        what, unit = ("heading", "rad") if log.rotation else ("depth", "m")
    factor, shown = person_scale(unit)
    rows = np.arange(len(log.command), dtype=np.float64) + len(log.before)
    time: FloatArray = log.period * rows
    panels = [
        Panel("command", "1", [Line("command", log.command)]),
        Panel(
            what,
            shown,
            [
                Line("measured", factor * log.measured),
                Line("simulated", factor * (log.measured - residual)),
            ],
        ),
        Panel("measured less simulated", shown, [Line("residual", factor * residual)]),
    ]
    return time_figure(time, [panels])


def _autocorrelation_figure(study: Study) -> Figure:
    found = study.whiteness
    lags = [lag * study.fitted.period for lag in range(1, len(found.correlation) + 1)]
    figure = Figure()
    figure.trace(
        "bar",
        x=lags,
        y=found.correlation,
        marker={"color": COLOURS[0]},
        hovertemplate="%{x:.3g} s: %{y:.3f}",
    )
    for sign in (1.0, -1.0):
        figure.horizontal(sign * found.bound, line=_BAND)
    figure.x_axis(title={"text": "lag, s"})
    figure.y_axis(title={"text": "autocorrelation"})
    figure.lay_out(height=300, showlegend=False, **layout(hovermode="closest"))
    return figure


def _delay_figure(study: Study) -> Figure:
    errors = study.estimate.errors
    unit = "m/s2" if study.fitted.reading == "acceleration" else "m"
    factor, shown = person_scale("rad" if study.experiment.rotation else unit)
    figure = Figure()
    figure.trace(
        "scatter",
        x=[delay * study.fitted.period for delay in errors],
        y=[factor * error for error in errors.values()],
        mode="lines+markers",
        line={"width": 1.6, "color": COLOURS[0]},
        hovertemplate="%{x:.3g} s: %{y:.4g} " + shown,
    )
    figure.x_axis(title={"text": "delay, s"})
    figure.y_axis(title={"text": f"rms residual, {shown}"}, rangemode="tozero")
    figure.lay_out(height=300, showlegend=False, **layout(hovermode="closest"))
    return figure
