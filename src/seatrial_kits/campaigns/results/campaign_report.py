"""The report of a campaign: cases against criteria, and the deck with every landing point."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import quantity_text
from seatrial.trial.records import run_schema
from seatrial.trial.records.run_folder import (
    CAMPAIGN,
    Run,
    load_run,
    read_manifest,
)
from seatrial.trial.records.run_schema import checked_json
from seatrial.trial.reports.decks import Pad, deck, pads
from seatrial.trial.reports.plotly_js import plotly_js
from seatrial.trial.reports.plots import deck_figure
from seatrial.trial.reports.report import REPORT, Play, Played, render, write_report

from .polar import PolarPoint, polar_figure, polar_point

LIBRARY, VIEWER = "plotly.js", "viewer.js"
"""Plotly's JavaScript, beside a campaign's page: once for all of its pages."""


@dataclass(frozen=True)
class Case:
    """One row of the table."""

    name: str
    link: str | None
    """Relative address of the run's own report, if it is there."""
    status: str
    passed: bool | None
    settings: dict[str, Any]
    verdicts: dict[str, dict[str, Any]]
    """By name of the criterion."""
    pads: list[Pad]
    polar: PolarPoint | None
    phase: str
    note: str


def write_case_report(folder: Path, play: Play | None = None) -> Path:
    """Write the report of a run in the folder of its campaign, and return its path.

    Raises InputError.
    """
    share_library(folder.parent)
    shared = None if play is None else partial(_share_viewer, folder.parent, play)
    return write_report(folder, f"../{LIBRARY}", shared, f"../{VIEWER}")


def _share_viewer(folder: Path, play: Play, run: Run) -> Played | None:
    """Return a run to be played, whose viewer stands beside all cases' folders."""
    played = play(run)
    if played is not None and not (folder / VIEWER).is_file():
        write_whole(folder / VIEWER, played.viewer)
    return played


def share_library(folder: Path) -> None:
    """Put Plotly's JavaScript beside a campaign's page, once."""
    if not (folder / LIBRARY).is_file():
        write_whole(folder / LIBRARY, f'window.packedPlotly = "{plotly_js()}";\n')


def write_campaign_report(folder: Path | str) -> Path:
    """Write ``report.html`` into a campaign folder and return its path.

    Raises InputError if the folder has no ``campaign.json``, or not one that can be read.
    """
    folder = Path(folder)
    if not (folder / CAMPAIGN).is_file():
        raise InputError(f"{folder} is not a campaign folder: it has no {CAMPAIGN}")
    campaign = checked_json(folder / CAMPAIGN, run_schema.CAMPAIGN)
    cases = [_case(folder, entry) for entry in campaign["cases"]]
    title = campaign.get("title") or campaign["name"]
    share_library(folder)
    page = render(
        "campaign.html.j2",
        library=LIBRARY,
        title=title,
        cases=cases,
        links={case.name: case.link for case in cases if case.link},
        settings=list(dict.fromkeys(key for case in cases for key in case.settings)),
        criteria=_criteria(cases),
        deck=_deck(cases),
        polar=_polar(cases),
        worst_text=_worst_text,
    )
    path = folder / REPORT
    write_whole(path, page)
    return path


def _case(folder: Path, entry: dict[str, Any]) -> Case:
    run = folder / entry["folder"]
    try:
        manifest = read_manifest(run)
        note, found, evaluated = "", pads(manifest), bool(manifest["criteria"])
        trial = str(manifest["trial"].get("title") or manifest["trial"]["name"])
    except InputError:
        note, found, evaluated, trial = f"no readable run in {entry['folder']}", [], True, ""
    verdicts = {verdict["name"]: verdict for verdict in entry["verdicts"]}
    has_report = (run / REPORT).is_file()
    return Case(
        name=entry["name"],
        link=quote(f"{entry['folder']}/{REPORT}") if has_report else None,
        status=entry["status"],
        passed=entry["passed"] if evaluated or not entry["passed"] else None,
        settings=entry["set"],
        verdicts=verdicts,
        pads=found,
        polar=_polar_point(run, entry),
        phase=next((pad.phase for pad in found if pad.phase), trial),
        note=note,
    )


def _criteria(cases: list[Case]) -> dict[str, list[str]]:
    """Return all criteria by name, each with what it checks: trials may differ in that."""
    criteria: dict[str, list[str]] = {}
    for case in cases:
        for name, verdict in case.verdicts.items():
            checks = criteria.setdefault(name, [])
            if verdict["check"] not in checks:
                checks.append(verdict["check"])
    return criteria


def _deck(cases: list[Case]) -> str | None:
    """Return the decks, one for each phase, or None if no case has a landing point."""
    phases = list(dict.fromkeys(case.phase for case in cases if case.pads))
    if not phases:
        return None
    return deck_figure([deck(phase, _landings(cases, phase)) for phase in phases]).json()


def _landings(cases: list[Case], phase: str) -> Iterator[tuple[str, Pad, bool | None]]:
    for case in cases:
        for pad in case.pads:
            if case.phase == phase:
                yield case.name, pad, case.passed


def _polar(cases: list[Case]) -> str | None:
    """Return a polar diagram of the runs, or None if they say too little of one."""
    figure = polar_figure([case.polar for case in cases if case.polar])
    return None if figure is None else figure.json()


def _polar_point(run: Path, entry: dict[str, Any]) -> PolarPoint | None:
    """Return a case's point of the polar diagram; cases alike but for the wind are a series."""
    others = {k: v for k, v in entry["set"].items() if not k.endswith(".mean_direction")}
    series = ", ".join(
        [entry.get("trial", ""), *(f"{key} {value}" for key, value in others.items())]
    )
    try:
        return polar_point(load_run(run), entry["name"], series)
    except InputError:
        return None


def _worst_text(verdict: dict[str, Any]) -> str:
    """Return a verdict's worst value with its unit, or a dash if there is none."""
    worst = verdict.get("worst")
    return "–" if worst is None else quantity_text(worst, verdict.get("unit") or "1", 3)
