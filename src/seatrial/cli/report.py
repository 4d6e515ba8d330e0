"""``seatrial report``: the report of a run made again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..plugins import service
from ..trial.records.run_folder import CAMPAIGN
from ..trial.reports.playing import play
from ..trial.reports.report import write_report
from .answer import answer
from .show import console


def report(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run or campaign.")],
) -> None:
    """Write the report of a run again."""
    further = None
    if (folder / CAMPAIGN).is_file():
        page, further = service("campaigns.written_again")(folder)
    else:
        page = write_report(folder, play=play)
    answer.result = {"report": str(page)}
    console.print(f"report: {page}", soft_wrap=True)
    if further is not None:
        answer.result["page"] = str(further)
        console.print(f"page: {further}", soft_wrap=True)
