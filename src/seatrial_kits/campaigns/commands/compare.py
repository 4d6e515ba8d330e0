"""``seatrial compare`` of two campaigns."""

from __future__ import annotations

from pathlib import Path

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.show import console
from seatrial.cli.statuses import FAILED

from ..results.comparison import compare_campaigns
from ..results.comparison_page import write_comparison_page
from .shown import print_shown


def compare_named(folder_a: Path, folder_b: Path, page: Path | None) -> None:
    """Compare two campaigns case by case, and write a page if one is wanted.

    Raises InputError; typer.Exit if the second is worse.
    """
    comparison = compare_campaigns(folder_a, folder_b)
    answer.result = comparison.content()
    for shown in comparison.tables():
        print_shown(shown)
    for line in comparison.lines:
        console.print(escape(line), soft_wrap=True)
    if page is not None:
        answer.result["page"] = str(write_comparison_page(comparison, page))
        console.print(f"page: {page}", soft_wrap=True)
    if comparison.is_worse:
        raise typer.Exit(FAILED)
