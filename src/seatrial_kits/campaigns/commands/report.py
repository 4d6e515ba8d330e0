"""``seatrial report`` of a campaign."""

from __future__ import annotations

from pathlib import Path

from ..results.campaign_report import write_campaign_report
from ..results.further_page import write_further_page
from ..results.page import has_table, write_table_page


def written_again(folder: Path) -> tuple[Path, Path | None]:
    """Write the page of a campaign again, and a further page, if a kit has one; return both.

    Raises InputError.
    """
    page = write_table_page(folder) if has_table(folder) else write_campaign_report(folder)
    further = write_further_page(folder)
    return page, None if further is None else further.path
