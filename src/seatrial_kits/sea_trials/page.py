"""One page, and one JSON file, of all sea trials of a vehicle."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError
from seatrial.model.readable import number
from seatrial.trial.records.run_folder import MANIFEST, Run, load_run
from seatrial.trial.reports.report import render
from seatrial.whole_file import write_whole

from .drawing import drawings, rows_of, track
from .evaluation import Done, approach_speed_of, criteria_name, figures_of
from .figures.criteria import Verdict, imo
from .figures.result import Figures
from .run_record import done_in

PAGE, DATA = "sea-trials.html", "sea-trials.json"


@dataclass(frozen=True)
class Evaluated:
    """A run with its figures, or with the reason why it has none."""

    run: Run
    done: Done | None
    found: Figures | None
    error: str
    verdicts: list[Verdict]

    @property
    def name(self) -> str:
        """The trial, and the side of its first order."""
        side = next(
            (str(entry["parameters"]["side"]["value"])
             for entry in self.run.manifest["components"].values() if entry["fmu"] == "manoeuvre"),
            "",
        )  # fmt: skip
        return f"{self.run.name}, {side}" if side else self.run.name


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


def evaluated(folder: Path, criteria: str | None) -> Evaluated:
    """Return a run with its figures; ``criteria`` is None or imo."""
    run = load_run(folder)
    try:
        done = done_in(run)
        found = figures_of(done)
    except InputError as error:
        return Evaluated(run, None, None, str(error), [])
    verdicts: list[Verdict] = []
    if criteria is not None and done.length is not None:
        speed = approach_speed_of(done, found)
        verdicts = imo({criteria_name(done): found}, done.length, speed)
    return Evaluated(run, done, found, "", verdicts)


def write_pages(trials: Sequence[Evaluated], folder: Path) -> Path:
    """Write ``sea-trials.html`` and ``sea-trials.json`` into a folder, return the page's path.

    Raises InputError for runs of different vehicles.
    """
    vehicles = {str(trial.run.manifest["choices"].get("vehicle", "")) for trial in trials}
    if len(vehicles) != 1:
        raise InputError(
            f"runs of one vehicle are needed for a page, found {', '.join(sorted(vehicles))}"
        )
    (vehicle,) = vehicles
    dones = [trial.done for trial in trials if trial.done is not None]
    circles = [done for done in dones if done.kind == "turning-circle"]
    length = next((done.length for done in dones if done.length is not None), None)
    page = render(
        "sea_trials.html.j2",
        title=f"Sea trials of {vehicle}" if vehicle else "Sea trials",
        length=None if length is None else f"{number(length)} m",
        criteria=[_criterion(trial, verdict) for trial in trials for verdict in trial.verdicts],
        tracks=track(circles).json() if len(circles) > 1 else None,
        trials=[_shown(trial) for trial in trials],
    )
    write_whole(folder / DATA, json.dumps([_data(trial) for trial in trials], indent=2) + "\n")
    write_whole(folder / PAGE, page)
    return folder / PAGE


def _shown(trial: Evaluated) -> dict[str, Any]:
    if trial.done is None or trial.found is None:
        return {"name": trial.name, "error": trial.error, "rows": [], "drawings": []}
    drawn = [figure.json() for title, figure in drawings(trial.done, trial.found)
             if not title.endswith(": figures")]  # fmt: skip
    rows = rows_of(trial.found, trial.done.length)
    return {"name": trial.name, "error": "", "rows": rows, "drawings": drawn}


def _criterion(trial: Evaluated, verdict: Verdict) -> dict[str, Any]:
    return {
        "trial": trial.name,
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
        "folder": str(trial.run.folder.name),
        **found,
        "error": trial.error or None,
        "criteria": verdicts,
    }
