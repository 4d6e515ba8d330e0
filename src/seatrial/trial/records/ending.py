"""Ends of runs, each in the word that its manifest has as status."""

from __future__ import annotations

from collections.abc import Sequence

_ENDED_BY = "ended by "


def ended_by(components: Sequence[str]) -> str:
    """Return the status of a run that components have ended, each an FMU that asked for it."""
    return _ENDED_BY + ", ".join(components)


def is_whole(status: str) -> bool:
    """Say if a run came to an end of its own: its stop time, or where a component ended it."""
    return status == "complete" or status.startswith(_ENDED_BY)
