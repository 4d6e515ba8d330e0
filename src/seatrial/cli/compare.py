"""``seatrial compare``: two runs signal by signal, two campaigns case by case, a run and a log."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from ..plugins import service
from ..trial.records.compare import compare as compare_runs
from ..trial.records.run_folder import CAMPAIGN, MANIFEST
from .answer import answer
from .options import LogColumns, LogFormat
from .show import console, print_table
from .statuses import FAILED


def compare(
    run_a: Annotated[Path, typer.Argument(help="Folder of a run, or of a campaign.")],
    run_b: Annotated[
        Path, typer.Argument(help="Folder of another one of the same kind; or, of a run, a log.")
    ],
    page: Annotated[
        Path | None,
        typer.Option("--page", metavar="FILE", help="Write a page (HTML) too, for campaigns."),
    ] = None,
    match: Annotated[
        list[str] | None,
        typer.Option(
            "--match",
            metavar="SIGNAL=CHANNEL[:UNIT],...",
            help="Signals of a run and the equal channels of a log.",
        ),
    ] = None,
    columns: LogColumns = None,
    format_name: LogFormat = None,
) -> None:
    """Compare two runs or two campaigns; status 1 if signals differ, or a verdict goes to fail.

    Runs are compared signal by signal, campaigns case by case: cases with the same settings are
    pairs. The campaigns' own criteria decide the status where both have some, and the cases'
    verdicts otherwise. A run and a log of any format: residual, lag and coherence of each signal
    that both have; status 0.
    """
    campaigns = [(folder / CAMPAIGN).is_file() for folder in (run_a, run_b)]
    is_log = not (any(campaigns) or (run_b / MANIFEST).is_file())
    if page is None and (is_log or match or columns or format_name):
        service("logs.compare_with_log")(run_a, run_b, match or [], columns or [], format_name)
        return
    if all(campaigns):
        service("campaigns.compare_named")(run_a, run_b, page)
        return
    if any(campaigns):
        one, other = (run_a, run_b) if campaigns[0] else (run_b, run_a)
        raise InputError(
            f"{one} is a campaign, and {other} has no {CAMPAIGN}: two of a kind are needed"
        )
    if page is not None:
        raise InputError(f"--page: two campaigns are needed, and {run_a} has no {CAMPAIGN}")
    comparison = compare_runs(run_a, run_b)
    answer.result = {**asdict(comparison), "worst": comparison.worst, "summary": comparison.summary}
    print_table(comparison.table())
    console.print(comparison.summary)
    if not comparison.identical:
        raise typer.Exit(FAILED)
