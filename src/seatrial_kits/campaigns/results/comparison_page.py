"""The page of two campaigns compared: the tables of the comparison, and robustness by pairs."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path

import numpy as np

from seatrial.files.whole_file import write_whole
from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import FAILED, PASSED, UNEVALUATED, layout
from seatrial.trial.reports.report import render

from .campaign_report import LIBRARY, share_library
from .comparison import CampaignComparison

_MOST_POINTS = 2000
_MOST_FIGURES = 12


def write_comparison_page(comparison: CampaignComparison, path: Path) -> Path:
    """Write the page of a comparison, and return its path; Plotly's JavaScript stands beside it."""
    share_library(path.parent)
    page = render(
        "comparison.html.j2",
        library=LIBRARY,
        title=" / ".join(comparison.names),
        titles=[outcomes.title for outcomes in comparison.outcomes],
        comparison=comparison,
        tables=comparison.tables(),
        links=_links(comparison, path.parent),
        figures=[
            _figure(comparison, criterion).json()
            for criterion in list(dict.fromkeys(w.criterion for w in comparison.worst))[
                :_MOST_FIGURES
            ]
        ],
    )
    write_whole(path, page)
    return path


def _links(comparison: CampaignComparison, base: Path) -> list[tuple[str, list[str | None]]]:
    """Return the cases with a report in either campaign: the names, and the two addresses."""
    shown = {(each.case_a, each.case_b): each.name for each in comparison.changed}
    shown.update({(each.case_a, each.case_b): each.case for each in comparison.worst})
    links = []
    for numbers, name in shown.items():
        addresses = [
            _address(outcomes.folder, outcomes.links.get(str(number)), base)
            for number, outcomes in zip(numbers, comparison.outcomes, strict=True)
        ]
        if any(addresses):
            links.append((name, addresses))
    return links


def _address(folder: Path, page: str | None, base: Path) -> str | None:
    if page is None:
        return None
    return f"{Path(os.path.relpath(folder.resolve(), base.resolve())).as_posix()}/{page}"


def _figure(comparison: CampaignComparison, criterion: str) -> Figure:
    """Return the robustness of a criterion in both campaigns, a point for each pair."""
    column = f"robustness of {criterion}"
    found = [p for p in comparison.pairs.found if all(column in case.values for case in p)]
    found = found[:: -(-len(found) // _MOST_POINTS)]
    values = np.array([[case.values[column] for case in pair] for pair in found])
    colours = [_colour(*(case.criteria.get(criterion) for case in pair)) for pair in found]
    ends = [float(values.min()), float(values.max())]
    figure = Figure()
    figure.trace(
        "scatter", x=ends, y=ends, mode="lines", line={"color": UNEVALUATED, "width": 1},
        hoverinfo="skip",
    )  # fmt: skip
    figure.trace(
        "scatter",
        x=values[:, 0],
        y=values[:, 1],
        mode="markers",
        marker={"color": colours, "size": 6},
        text=[escape(comparison.pairs.name(one)) for one, _ in found],
        hovertemplate="%{text}<br>%{x:.4g} → %{y:.4g}",
    )
    a, b = (escape(name) for name in comparison.names)
    figure.lay_out(height=320, showlegend=False, **layout(hovermode="closest"))
    figure.x_axis(title={"text": f"robustness of {escape(criterion)} in {a}"})
    figure.y_axis(title={"text": f"in {b}"})
    return figure


def _colour(a: bool | None, b: bool | None) -> str:
    """Return green where a pair was repaired, red where it was broken, grey for no change."""
    return UNEVALUATED if a == b else PASSED if b else FAILED
