"""``seatrial report``: the report of a run made again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..trial.campaigns.results.further_page import write_further_page
from ..trial.campaigns.results.page import has_table, write_table_page
from ..trial.reports.campaign_report import CAMPAIGN, write_campaign_report
from ..trial.reports.playing import play
from ..trial.reports.report import write_report
from .answer import answer
from .show import console


def report(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run or campaign.")],
) -> None:
    """Write the report of a run again."""
    is_campaign = (folder / CAMPAIGN).is_file()
    if has_table(folder):
        page = write_table_page(folder)
    else:
        page = write_campaign_report(folder) if is_campaign else write_report(folder, play=play)
    answer.result = {"report": str(page)}
    console.print(f"report: {page}", soft_wrap=True)
    if is_campaign and (further := write_further_page(folder)) is not None:
        answer.result["page"] = str(further.path)
        console.print(f"page: {further.path}", soft_wrap=True)
