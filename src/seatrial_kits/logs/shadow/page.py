"""The page of a shadow: figures, and of each signal the run, the log and the residual."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import person_scale
from seatrial.trial.logs.channels import Array
from seatrial.trial.records.run_folder import MANIFEST, Run, load_run
from seatrial.trial.reports.plots import MAX_POINTS, Line, Panel, time_figure, track_figure
from seatrial.trial.reports.report import render
from seatrial.trial.running.output import write_json

from ..paired.pairing import motion_signals, run_trace
from ..paired.residuals import HEADINGS, Residual, resampling_notes, residual_of
from .preparing import COMPONENT, Prepared

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


DATA = "shadow.json"


def compared(folder: Path, made: Prepared) -> tuple[Run, list[Residual], list[str]]:
    """Return a run, how its signals differ from the log's, and notes on those that are not there.

    Compared are the pairs that were named, and if there are none, the motion of the run's craft
    with that of the log. Raises InputError for a signal that was named and is not recorded, and for
    units that do not fit.
    """
    run, notes = load_run(folder), []
    found = []
    for written, name in made.traces.compared.items():
        found.append(residual_of(run_trace(run, _named(run, written)), made.played(name)))
    if not made.traces.compared:
        numbers = [n for n, values in run.signals.items() if not isinstance(values, list)]
        own = [name for name in numbers if not name.startswith(f"{COMPONENT}.")]
        signals = motion_signals(own)
        for what, name in made.traces.motion.items():
            if what in signals:
                found.append(residual_of(run_trace(run, signals[what][0]), made.played(name)))
        if not found:
            notes.append(
                "nothing is compared: the run has no motion of a craft that the log has, too; "
                "--compare SIGNAL=CHANNEL names pairs"
            )
    return run, found, notes


def _named(run: Run, written: str) -> str:
    """Return the recorded signal of a name: a path, or what a rig inside shows."""
    if written in run.signals:
        return written
    ends = [name for name in run.signals if name.endswith(f".{written.partition('.')[2]}")
            and name.startswith(f"{written.partition('.')[0]}.")]  # fmt: skip
    if len(ends) != 1:
        raise InputError(f"--compare: {unknown('signal', written, run.signals)}")
    return ends[0]


def describe(folder: Path, made: Prepared, format_name: str) -> None:
    """Write into the manifest of a run which quantities its log serves, and which orders it gave.

    Commands that read logs take them from there.
    """
    path = folder / MANIFEST
    content = json.loads(path.read_text("utf-8"))
    traces = made.traces
    content["log"] = {
        "format": format_name,
        "serves": {what: f"{COMPONENT}.{name}" for what, name in traces.motion.items()},
        "orders": {port: f"{COMPONENT}.{name}" for port, name in traces.feeds.items()},
        "begin": made.window[0],
        "notes": list(made.notes),
    }
    write_json(path, content)


def write_data(folder: Path, residuals: list[Residual], notes: list[str]) -> Mapping[str, Any]:
    """Write the figures of a comparison, and return them."""
    content = {"signals": [each.figures() for each in residuals], "notes": notes}
    write_json(folder / DATA, content)
    return content
