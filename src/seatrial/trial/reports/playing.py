"""Runs in three dimensions in their reports, where the kit ``live`` is there to show them."""

from __future__ import annotations

from typing import cast

from ...plugins import offered
from ..records.run_folder import Run
from .report import Played


def play(run: Run) -> Played | None:
    """Return a recording of a run for its report; None without anything to see, or to show it."""
    played = offered("live.played")
    return None if played is None else cast("Played | None", played(run))
