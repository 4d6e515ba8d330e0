"""A page that a kit writes of all runs of a campaign, as the campaign's file names it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ...plugins import Registry
from ..records import run_schema
from ..records.run_schema import checked_json
from .campaign_report import CAMPAIGN

PAGES = Registry("seatrial.pages", "page of campaigns", {})
"""Functions of kits that write a page into a campaign's folder, and return it: `Written`."""


class Written(NamedTuple):
    """A page, and what does not hold by it."""

    path: Path
    failed: list[str]


def write_further_page(folder: Path) -> Written | None:
    """Write the page that a campaign's folder names, if it names one. Raises InputError."""
    name = checked_json(folder / CAMPAIGN, run_schema.CAMPAIGN).get("page")
    if name is None:
        return None
    written: Written = PAGES.load(name)(folder)
    return written
