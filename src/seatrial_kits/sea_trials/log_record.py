"""Record of a manoeuvre from a log of a real trial."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.logs.common_time import WHOLE, Window
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.motion import motion
from seatrial.trial.logs.quantities import Column

from .figures.record import Record

FURTHER = ("helm", "roll", "pitch", "depth", "power")
"""Quantities of a record besides heading and position."""


def read_record(
    path: Path,
    columns: Mapping[str, Column],
    format_name: str | None = None,
    window: Window = WHOLE,
) -> tuple[Record, tuple[str, ...]]:
    """Return the record in a log, at the instants of its heading, and notes for a person.

    Raises InputError as `read_log`, `motion` and `Record` do.
    """
    log = read_log(path, format_name, columns.get("time"))
    found = motion(log, columns, FURTHER, window)
    try:
        return Record(found.time, **found.values), (*log.notes, *found.notes)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
