"""``seatrial compare``: two runs, signal by signal."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ..trial.records.compare import compare as compare_runs
from .answer import answer
from .show import console, print_table
from .statuses import FAILED


def compare(
    run_a: Annotated[Path, typer.Argument(help="Folder of a run.")],
    run_b: Annotated[Path, typer.Argument(help="Folder of another run.")],
) -> None:
    """Compare two runs signal by signal; status 1 if their signals differ."""
    comparison = compare_runs(run_a, run_b)
    answer.result = {
        **asdict(comparison),
        "worst": comparison.worst,
        "summary": comparison.summary,
    }
    print_table(comparison.table())
    console.print(comparison.summary)
    if not comparison.identical:
        raise typer.Exit(FAILED)
