"""The page of an identification from manoeuvres: parameters, and each trial shown again."""

from __future__ import annotations

import math
from pathlib import Path

from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.trial.reports.plots import Line, Panel, time_figure, track_figure
from seatrial.trial.reports.report import REPORT, render

from .intervals import WITHIN
from .study import ManoeuvreStudy, Row, Shown

HEADINGS = ("", "before", "identified", "+-", "unit", "identifiable", "+- by bootstrap")
_DEGREES = math.degrees(1.0)


def table_rows(study: ManoeuvreStudy) -> list[tuple[str, ...]]:
    """Return the parameters as text, in the order of `HEADINGS`."""
    return [_texts(row) for row in study.rows]


def _texts(row: Row) -> tuple[str, ...]:
    before = "" if row.is_current else number(row.before, 4)
    if not row.is_identifiable:
        return (row.name, before, "kept", "", row.unit, "no", "")
    errors = (row.deviation, row.resampled)
    half, drawn = (number(WITHIN * each + row.integration, 2) for each in errors)
    said = "hardly" if row.partner else "yes"
    return (row.name, before, number(row.value, 4), half, row.unit, said, drawn)


def pass_rows(study: ManoeuvreStudy) -> list[tuple[str, ...]]:
    """Return pass, and distance of track and heading of the model before and after, as text."""
    rows = []
    for shown in study.shown:
        (track, heading), (track_now, heading_now) = (
            shown.rms(each) for each in (shown.before, shown.after)
        )
        rows.append((
            shown.run.name if shown.is_fitted else f"{shown.run.name} (check)",
            *(f"{number(each, 3)} m" for each in (track, track_now)),
            *(f"{number(_DEGREES * each, 3)} deg" for each in (heading, heading_now)),
        ))  # fmt: skip
    return rows


def write_page(study: ManoeuvreStudy, folder: Path, file: Path | None) -> Path:
    """Write ``report.html`` into a folder; ``file`` is the vehicle's that was written beside it."""
    page = render(
        "identification_manoeuvres.html.j2",
        title=f"{study.vehicle} calibrated from manoeuvres",
        accepted=study.accepted,
        parameters=None if file is None else file.relative_to(folder),
        verdicts=study.verdicts,
        headings=HEADINGS,
        rows=table_rows(study),
        notes=study.notes,
        passes=pass_rows(study),
        figures=[(shown.run.name, *_figures(shown)) for shown in study.shown],
    )
    write_whole(folder / REPORT, page)
    return folder / REPORT


def _figures(shown: Shown) -> tuple[str, str]:
    """Return track and heading of a pass: log, model before and after."""
    models = (("log", shown.log), ("model before", shown.before), ("identified", shown.after))
    track = track_figure([(name, readings[0], readings[1]) for name, readings in models])
    lines = [Line(name, _DEGREES * readings[2]) for name, readings in models]
    helm = shown.run.record.helm
    panels = [Panel("heading", "deg", lines)]
    if helm is not None and len(helm) == len(shown.time):
        panels.append(Panel("helm, to starboard", "deg", [Line("helm", _DEGREES * helm)]))
    return track.json(), time_figure(shown.time, [panels]).json()
