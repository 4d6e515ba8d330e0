"""The page of a shadow: figures, and of each signal the run, the log and the residual."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from seatrial.model.readable import person_scale
from seatrial.trial.logs.channels import Array
from seatrial.trial.logs.residuals import HEADINGS, Residual, resampling_notes
from seatrial.trial.records.run_folder import Run
from seatrial.trial.reports.plots import MAX_POINTS, Line, Panel, time_figure, track_figure
from seatrial.trial.reports.report import render
from seatrial.whole_file import write_whole

PAGE = "shadow.html"


def write_page(run: Run, residuals: Sequence[Residual], notes: Sequence[str]) -> Path:
    """Write the page into the run's folder, and return its path."""
    page = render(
        "shadow.html.j2",
        title=run.manifest["trial"].get("title") or run.name,
        headings=HEADINGS,
        rows=[each.cells() for each in residuals],
        resampled=resampling_notes(residuals),
        notes=notes,
        verdicts=run.verdicts,
        track=_track(residuals),
        figures=[(each.signal, _over_time(each)) for each in residuals],
    )
    write_whole(run.folder / PAGE, page)
    return run.folder / PAGE


def _over_time(each: Residual) -> str:
    factor, unit = person_scale(each.unit)
    rows = slice(None, None, max(-(-len(each.time) // MAX_POINTS), 1))
    # The log beside the run, whatever whole turns an angle of it is away.
    log = each.run - each.residual
    both = [Line("run", factor * each.run[rows]), Line("log", factor * log[rows])]
    own = [Line("run - log", factor * each.residual[rows])]
    panels = [Panel(each.signal, unit, both), Panel("residual", unit, own)]
    return time_figure(each.time[rows], [panels]).json()


def _track(residuals: Sequence[Residual]) -> str | None:
    """Return the track of run and log, where north and east are compared at the same times."""
    places = (".position.x", ".position.y", ".eta.x", ".eta.y")
    found = {each.signal[-1]: each for each in residuals if each.signal.endswith(places)}
    if {"x", "y"} - found.keys() or not np.array_equal(found["x"].time, found["y"].time):
        return None
    tracks: list[tuple[str, Array, Array]] = [
        ("run", found["x"].run, found["y"].run),
        ("log", found["x"].log, found["y"].log),
    ]
    return track_figure(tracks).json()
