"""Times as people and instruments write them: ISO 8601, and times of day past midnight."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, time

import numpy as np

from .channels import Array

DAY = 86400.0
_EARLIEST = 1e8


def of_day(moment: time) -> float:
    """Return the seconds since midnight of a time of day."""
    return moment.hour * 3600.0 + moment.minute * 60.0 + moment.second + moment.microsecond / 1e6


def date_of(unix: float) -> datetime | None:
    """Return the date and time of a UNIX time; None before 1973: a clock that was not set."""
    try:
        return datetime.fromtimestamp(unix, UTC) if unix > _EARLIEST else None
    except (OverflowError, ValueError):
        return None


def past_midnight(seconds: Sequence[float] | Array) -> Array:
    """Return seconds since midnight (n,) that go on over midnights: a step back by half a day."""
    of_each = np.asarray(seconds, np.float64)
    days = np.concatenate(([0], np.cumsum(np.diff(of_each) < -DAY / 2)))
    return np.asarray(of_each + DAY * days)


def parsed_time(text: str) -> datetime | time | None:
    """Return the date and time, or the time of day, of a text by ISO 8601; None for any other.

    A date without a zone is taken for UTC.
    """
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        try:
            return time.fromisoformat(text) if ":" in text else None
        except ValueError:
            return None
    return found if found.tzinfo else found.replace(tzinfo=UTC)
