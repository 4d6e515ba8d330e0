"""The page of a campaign's table: how often what failed, and over which settings."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole
from seatrial.trial.records import run_schema
from seatrial.trial.records.run_schema import checked_json
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import COLOURS, layout
from seatrial.trial.reports.report import REPORT, render

from ..campaign import INDEX
from ..stopping_rule import failure_interval
from ..table import RESULTS, read_rows, units_of
from .campaign_report import LIBRARY, share_library
from .finding import ANSWER, Finding, read_answer
from .maps import campaign_map, map_figure, said_of
from .outcomes import links_of
from .overview import Overview

SHOWN = 500
"""Failed cases that the page lists; the table has all."""
_BINS = 20
_FEWEST = 4
"""Values of a number that make a figure."""
_MOST_FIGURES = 12


@dataclass
class _Criterion:
    name: str
    evaluated: int = 0
    failed: int = 0
    least: float | None = None
    """Robustness."""
    at: int = 0
    """Case of that."""

    def add(self, row: dict[str, Any]) -> None:
        passed, robustness = row[self.name], row[f"robustness of {self.name}"]
        self.evaluated += passed is not None
        self.failed += passed is False
        if robustness is not None and (self.least is None or robustness < self.least):
            self.least, self.at = robustness, row["case"]


@dataclass
class _Found:
    """What the page needs of all rows."""

    count: int = 0
    cases: list[int] = field(default_factory=list)
    failed: list[bool] = field(default_factory=list)
    shown: list[dict[str, Any]] = field(default_factory=list)
    values: dict[str, list[float]] = field(default_factory=dict)


def has_table(folder: Path) -> bool:
    """Say if a campaign's folder has a table."""
    return (folder / RESULTS).is_file()


def write_table_page(folder: Path) -> Path:
    """Write ``report.html`` of a campaign with a table, and return its path. Raises InputError."""
    path = folder / RESULTS
    if not path.is_file():
        raise InputError(f"{folder}: it has no {RESULTS}")
    index = checked_json(folder / INDEX, run_schema.CAMPAIGN)
    units = units_of(path)
    names = list(units)
    settings = names[2 : names.index("status") - 1]  # the run's own seed is the last
    prefix = "robustness of "
    criteria = [_Criterion(n.removeprefix(prefix)) for n in names if n.startswith(prefix)]
    found = _Found(values={key: [] for key in settings})
    overview = Overview(names, units)
    for row in read_rows(path):
        found.count += 1
        overview.add(row)
        found.cases.append(row["case"])
        found.failed.append(not row["passed"])
        for criterion in criteria:
            criterion.add(row)
        for key, values in found.values.items():
            value = row[key]
            values.append(float(value) if isinstance(value, (int, float)) else np.nan)
        if not row["passed"] and len(found.shown) < SHOWN:
            found.shown.append(row)
    answer = read_answer(folder) if (folder / ANSWER).is_file() else None
    share_library(folder)
    failed = sum(found.failed)
    shown_map = None if answer else campaign_map(path, index.get("map"), units)
    page = render(
        "table.html.j2",
        library=LIBRARY,
        title=index.get("title") or index["name"],
        count=found.count,
        planned=index.get("count", found.count),
        failed=failed,
        interval=failure_interval(failed, found.count) if found.count else (0.0, 1.0),
        accepted=index.get("criteria", []),
        criteria=criteria,
        settings=settings,
        units=units,
        shown=found.shown,
        links=links_of(folder, index["cases"]),
        rerun=_rerun(folder, index, is_answer=answer is not None),
        map=None if shown_map is None else map_figure(shown_map).json(),
        said_of_map=None if shown_map is None else said_of(shown_map),
        figures=_figures(found, units) if failed and not answer else [],
        overview=None if answer else overview,
        engine=index.get("engine", ""),
        file=index.get("file", ""),
        answer=answer,
        drawings=_drawings(folder, answer) if answer else [],
    )
    target = folder / REPORT
    write_whole(target, page)
    return target


def _rerun(folder: Path, index: dict[str, Any], *, is_answer: bool) -> str:
    """Return the command that runs a case again, but for its number; empty if it is not known."""
    if "file" not in index:
        return ""
    words = ["seatrial", "campaign", "rerun", index["file"], "--engine", index["engine"]]
    return shlex.join([*words, "--asked" if is_answer else "--of", folder.name, "--case"]) + " "


def _drawings(folder: Path, answer: Finding) -> list[Markup]:
    """Return the drawings of an answer as elements of the page. Raises InputError."""
    drawings = []
    for name in answer.figures:
        path = folder / Path(name).name
        try:
            text = path.read_text("utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path} cannot be read: {error}") from None
        drawings.append(Markup(text[max(text.find("<svg"), 0) :]))
    return drawings


def _figures(found: _Found, units: dict[str, str]) -> list[str]:
    """Return the share of failed cases over each setting that has numbers enough."""
    figures: list[str] = []
    failed, cases = np.array(found.failed, float), np.array(found.cases)
    for key, column in found.values.items():
        values = np.array(column)
        known = np.isfinite(values)
        if len(np.unique(values[known])) >= _FEWEST and len(figures) < _MOST_FIGURES:
            unit = units[key]
            title = f"{key}, {unit}" if unit else key
            figures.append(_share(title, values[known], failed[known], cases[known]).json())
    return figures


def _share(title: str, values: np.ndarray, failed: np.ndarray, cases: np.ndarray) -> Figure:
    distinct = np.unique(values)
    if len(distinct) <= _BINS:
        places, of = distinct, np.searchsorted(distinct, values)
        width = float(np.diff(distinct).min()) * 0.8
    else:
        edges = np.linspace(values.min(), values.max(), _BINS + 1)
        places = (edges[:-1] + edges[1:]) / 2.0
        of = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, _BINS - 1)
        width = float(edges[1] - edges[0])
    counts = np.bincount(of, minlength=len(places))
    shares = np.bincount(of, failed, minlength=len(places)) / np.maximum(counts, 1)
    led_to = [0] * len(places)
    for at in np.lexsort((-cases, failed)):  # the last one stays: the first that failed
        led_to[of[at]] = int(cases[at])
    figure = Figure()
    figure.trace(
        "bar",
        x=places,
        y=100.0 * shares,
        width=width,
        marker={"color": COLOURS[1]},
        customdata=counts,
        meta={"cases": led_to},
        hovertemplate="%{y:.3g} % of %{customdata} cases failed at %{x:.4g}",
    )
    figure.lay_out(height=240, showlegend=False, **layout(hovermode="closest"))
    figure.x_axis(title={"text": escape(title)})
    figure.y_axis(title={"text": "failed, %"}, rangemode="tozero")
    return figure
