"""``seatrial compare``: two runs signal by signal, two campaigns case by case, a run and a log."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..errors import InputError
from ..plugins import service
from ..trial.records.compare import compare as compare_runs
from ..trial.records.run_folder import CAMPAIGN, MANIFEST
from .answer import answer
from .options import LogColumns, LogFormat
from .show import console, print_notes, print_table
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
        _compare_with_log(run_a, run_b, match or [], columns or [], format_name)
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


def _compare_with_log(
    folder: Path, path: Path, match: list[str], columns: list[str], format_name: str | None
) -> None:
    from ..trial.logs.formats import read_log
    from ..trial.logs.pairing import compared_signals, pairs, read_matches
    from ..trial.logs.quantities import read_columns
    from ..trial.logs.residuals import HEADINGS, resampling_notes, residual_of
    from ..trial.logs.steady_clock import steady
    from ..trial.records.run_folder import load_run, read_manifest
    from .reading import reading
    from .show import text_table

    matches, named = read_matches(match, "--match"), read_columns(columns) if columns else {}
    described = read_manifest(folder)["signals"].items()
    numbers = [name for name, each in described if each.get("type") not in ("String", "Binary")]
    with reading(path):
        log = steady(read_log(path, format_name, named.pop("time", None)))
    run = load_run(folder, compared_signals(numbers, log, matches))
    found, notes = pairs(run, log, matches, named)
    residuals = [residual_of(signal, channel) for signal, channel in found]
    residuals.sort(key=lambda each: 1.0 if each.fit is None else each.fit)
    notes = [*run.notes, *log.notes, *notes]
    print_notes(notes)
    print_table(text_table(HEADINGS, [each.cells() for each in residuals]))
    for line in resampling_notes(residuals):
        console.print(escape(line), soft_wrap=True)
    answer.result = {"notes": notes, "signals": [each.figures() for each in residuals]}
