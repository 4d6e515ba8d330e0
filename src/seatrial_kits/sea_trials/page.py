"""One page, one JSON file and one table of all sea trials of a vehicle."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number
from seatrial.trial.records import run_schema
from seatrial.trial.records.run_folder import CAMPAIGN, MANIFEST, Run, load_run
from seatrial.trial.reports.report import render

from .curves import drawn_together, spiral_figure
from .drawing import rows_of
from .evaluation import Done, figures_of, verdicts_of
from .figures.criteria import Verdict
from .figures.result import Figures
from .run_record import done_in

PAGE, DATA, TABLE = "sea-trials.html", "sea-trials.json", "sea-trials.csv"
_COLUMNS = ("trial", "side", "figure", "value", "unit", "lengths", "missing")


@dataclass(frozen=True)
class Evaluated:
    """A run with its figures, or with the reason why it has none."""

    run: Run
    done: Done | None
    found: Figures | None
    error: str
    verdicts: list[Verdict]

    @property
    def side(self) -> str:
        """The side of the first order, empty if it is not known."""
        return "" if self.done is None else self.done.side


def run_folders(places: Sequence[Path]) -> list[Path]:
    """Return the run folders among folders, and in folders of campaigns.

    Raises InputError for a folder that is neither.
    """
    folders: list[Path] = []
    for place in places:
        inner = sorted(path.parent for path in place.glob(f"*/{MANIFEST}"))
        if (place / MANIFEST).is_file():
            folders.append(place)
        elif inner:
            folders += inner
        else:
            raise InputError(f"{place}: neither a run folder nor one with run folders")
    return folders


def evaluated(folder: Path, criteria: str | None = None) -> Evaluated:
    """Return a run with its figures; ``criteria``, imo, replaces those of the vehicle."""
    run = load_run(folder)
    try:
        done = done_in(run)
        if criteria is not None:
            done = replace(done, criteria=criteria)
        found = figures_of(done)
    except InputError as error:
        return Evaluated(run, None, None, str(error), [])
    return Evaluated(run, done, found, "", verdicts_of(done, found))


def campaign_page(folder: Path) -> tuple[Path, list[str]]:
    """Write the page of a campaign's folder, and return its path and what does not hold by it.

    See `write_pages`. Raises InputError.
    """
    left_out = run_schema.checked_json(folder / CAMPAIGN, run_schema.CAMPAIGN).get("left_out", {})
    trials = [evaluated(each) for each in run_folders([folder])]
    path = write_pages(trials, folder, left_out)
    return path, [what for trial in trials for what in failed(trial)]


def failed(trial: Evaluated) -> list[str]:
    """Return the criteria that a run does not hold."""
    side = f", {trial.side}" if trial.side else ""
    return [f"{verdict.ability}{side}" for verdict in trial.verdicts if not verdict.passed]


def write_pages(
    trials: Sequence[Evaluated], folder: Path, left_out: Mapping[str, str] | None = None
) -> Path:
    """Write page, JSON file and table into a folder, and return the page's path.

    ``left_out`` has trials that do not apply, and why. Raises InputError for runs of different
    vehicles.
    """
    vehicles = {str(trial.run.manifest["choices"].get("vehicle", "")) for trial in trials}
    if len(vehicles) != 1:
        raise InputError(
            f"runs of one vehicle are needed for a page, found {', '.join(sorted(vehicles))}"
        )
    (vehicle,) = vehicles
    length = next((t.done.length for t in trials if t.done and t.done.length is not None), None)
    names = dict.fromkeys(trial.run.name for trial in trials)
    page = render(
        "sea_trials.html.j2",
        title=f"Sea trials of {vehicle}" if vehicle else "Sea trials",
        length=None if length is None else f"{number(length)} m",
        criteria=[_criterion(trial, verdict) for trial in trials for verdict in trial.verdicts],
        trials=[_section(name, [t for t in trials if t.run.name == name]) for name in names],
        spirals=_spirals(trials),
        left_out=left_out or {},
    )
    write_whole(folder / DATA, json.dumps([_data(trial) for trial in trials], indent=2) + "\n")
    write_whole(folder / TABLE, _table(trials))
    write_whole(folder / PAGE, page)
    return folder / PAGE


def _section(name: str, runs: Sequence[Evaluated]) -> dict[str, Any]:
    """Return a manoeuvre to both sides: rows with a cell for each, and what is drawn."""
    whole = [
        (run.done, run.found) for run in runs if run.done is not None and run.found is not None
    ]
    cells = [{row[0]: row[1:] for row in rows_of(found, done.length)} for done, found in whole]
    rows = dict.fromkeys(name for column in cells for name in column)
    return {
        "name": name,
        "title": runs[0].run.manifest["trial"].get("title", ""),
        "errors": [f"{run.side} {run.error}".strip() for run in runs if run.error],
        "sides": [done.side if len(whole) > 1 else "" for done, _ in whole],
        "rows": [(row, [column.get(row, ("", "")) for column in cells]) for row in rows],
        "notes": list(dict.fromkeys(note for _, found in whole for note in found.notes)),
        "drawings": [(t, f.json()) for t, f in drawn_together(whole)] if whole else [],
    }


def _spirals(trials: Sequence[Evaluated]) -> str | None:
    """Return direct and reverse spiral in one drawing, if there are both."""
    spirals = [t.done for t in trials if t.done and t.done.kind in ("spiral", "reverse-spiral")]
    return spiral_figure(spirals).json() if len(spirals) > 1 else None


def _criterion(trial: Evaluated, verdict: Verdict) -> dict[str, Any]:
    return {
        "trial": trial.run.name,
        "side": trial.side,
        "ability": verdict.ability,
        "value": number(verdict.value),
        "limit": number(verdict.limit),
        "margin": number(verdict.margin),
        "unit": verdict.unit,
        "passed": verdict.passed,
    }


def _data(trial: Evaluated) -> dict[str, Any]:
    verdicts = [{**asdict(each), "margin": each.margin, "passed": each.passed}
                for each in trial.verdicts]  # fmt: skip
    found = {} if trial.found is None else trial.found.as_dict()
    return {
        "trial": trial.run.name,
        "side": trial.side,
        "folder": str(trial.run.folder.name),
        "length": None if trial.done is None else trial.done.length,
        **found,
        "error": trial.error or None,
        "criteria": verdicts,
    }


def _table(trials: Sequence[Evaluated]) -> str:
    """Return a row for each figure, in SI, as CSV."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(_COLUMNS)
    for trial in trials:
        begin = (trial.run.name, trial.side)
        if trial.found is None or trial.done is None:
            rows.writerow((*begin, "", "", "", "", trial.error))
            continue
        lengths = trial.found.in_lengths(trial.done.length) if trial.done.length else {}
        for name, figure in trial.found.found.items():
            rows.writerow((*begin, name, figure.value, figure.unit, lengths.get(name, ""), ""))
        for name, why in trial.found.missing.items():
            rows.writerow((*begin, name, "", "", "", why))
    return text.getvalue()
