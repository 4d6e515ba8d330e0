"""The page of an identification of sway: parameters, rules, a free run and the fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number, person_scale
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import Line, Panel, time_figure
from seatrial.trial.reports.report import REPORT, render

from ..planar_output_error import PlanarLog
from .page import RatioRow
from .planar_study import READINGS, PlanarStudy

_FOUND = (
    ("m22", "mass", "m22", "kg"),
    ("d22", "linear", "d22", "N.s/m"),
    ("q22", "quadratic", None, "N.s2/m2"),
    ("E1", "thrust_1", "E1", "N"),
    ("E2", "thrust_2", "E2", "N"),
)
"""Symbol, name of the output error's, name of the source's (it has no quadratic drag), unit."""
_UNITS = ("m/s2", "m/s2", "rad")


def planar_rows(study: PlanarStudy) -> list[RatioRow]:
    """Return what the log shows, beside what the method of [Paulino2015] makes of it."""
    return [
        RatioRow(
            symbol,
            unit,
            number(study.fit.values[ours], 5),
            number(study.fit.deviation(ours), 2),
            number(getattr(study.source, source), 5) if source else "",
        )
        for symbol, ours, source, unit in _FOUND
    ]


def write_planar_page(study: PlanarStudy, folder: Path, parameters: str | None) -> Path:
    """Write ``report.html`` into a folder; ``parameters`` names the file written beside it."""
    experiment, count = study.experiment, len(study.fitted.commands)
    simulated = study.fitted.readings - study.fit.residual
    page = render(
        "identification_planar.html.j2",
        title=experiment.file.title or experiment.name,
        study=study,
        parameters=parameters,
        log=study.log_path,
        rows=f"{count} rows, {number(study.fitted.period, 6)} s apart",
        held_out=f"{len(study.test.commands)} rows",
        arm=experiment.file.known.arm,
        found=planar_rows(study),
        fits=[
            (name, f"{100.0 * value:.1f} %")
            for name, value in zip(READINGS, study.free_run_fits, strict=True)
        ],
        held_out_figure=_figure(study.test, study.free_run).json(),
        fitted=_figure(study.fitted, simulated).json(),
    )
    path = folder / REPORT
    write_whole(path, page)
    return path


def _figure(log: PlanarLog, simulated: FloatArray) -> Figure:
    rows = np.arange(len(log.commands), dtype=np.float64) + len(log.before)
    time: FloatArray = log.period * rows
    commands = [
        Line(name, values)
        for name, values in zip(("port", "starboard"), log.commands.T, strict=True)
    ]
    panels = [Panel("commands", "1", commands)]
    for name, unit, measured, found in zip(
        READINGS, _UNITS, log.readings.T, simulated.T, strict=True
    ):
        factor, shown = person_scale(unit)
        lines = [Line("measured", factor * measured), Line("simulated", factor * found)]
        panels.append(Panel(name, shown, lines))
    return time_figure(time, [panels])
