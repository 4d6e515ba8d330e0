"""Date and time of day of a run: the key ``utc`` of a trial."""

from __future__ import annotations

import datetime
from typing import Annotated, Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from ...errors import InputError
from ...system.system import System

_NOW = "now"


def _written(value: Any) -> str:
    if value == _NOW:
        return _NOW
    try:
        instant = datetime.datetime.fromisoformat(value) if isinstance(value, str) else value
    except ValueError:
        instant = None
    if not isinstance(instant, datetime.datetime) or instant.tzinfo is None:
        raise PydanticCustomError(
            "utc", "An instant with its offset from UTC such as 2026-06-01T12:00:00Z, or 'now'"
        )
    return _text(instant)


Utc = Annotated[str, BeforeValidator(_written)]
"""Instant at the start of the run, as text in UTC, or ``now``."""


def instant_of(utc: str, in_real_time: bool, where: str) -> str:
    """Return the instant that is meant, from the clock for ``now``.

    Raises InputError for ``now`` in a run that is not in real time: no second run would be equal.
    """
    if utc != _NOW:
        return utc
    if not in_real_time:
        raise InputError(
            f"{where}: 'now' is for runs in real time only: give real_time too, or an instant "
            "such as 2026-06-01T12:00:00Z"
        )
    return _text(datetime.datetime.now(datetime.UTC))


def set_start_time(system: System, utc: str, where: str) -> None:
    """Give an instant to all components that send the time; raise InputError if there is none."""
    dated = [
        f"{name}.{port}"
        for name, part in system.parts.items()
        for port in part.instance.variables.of_role("start-time")
    ]
    if not dated:
        raise InputError(f"{where}: no component of the rig has date and time")
    for key in dated:
        system.set(key, utc, where)


def _text(instant: datetime.datetime) -> str:
    in_utc = instant.astimezone(datetime.UTC).replace(tzinfo=None)
    return f"{in_utc.isoformat()}Z"
