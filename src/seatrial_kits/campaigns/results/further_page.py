"""A page that a kit writes of all runs of a campaign, as the campaign's file names it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from seatrial.trial.records import run_schema
from seatrial.trial.records.run_schema import checked_json

from ..campaign import INDEX, PAGES


class Written(NamedTuple):
    """A page, and what does not hold by it."""

    path: Path
    failed: list[str]


def write_further_page(folder: Path) -> Written | None:
    """Write the page that a campaign's folder names, if it names one. Raises InputError."""
    name = checked_json(folder / INDEX, run_schema.CAMPAIGN).get("page")
    if name is None:
        return None
    return Written(*PAGES.load(name)(folder))
