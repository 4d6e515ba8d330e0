"""Runs in three dimensions in their reports; what shows them is imported when one is written."""

from __future__ import annotations

from ..trials.report import Played
from ..trials.run_folder import Run


def play(run: Run) -> Played | None:
    """Return a recording of a run for its report; see `live.stage.played`."""
    from ..live.stage import played

    return played(run)
