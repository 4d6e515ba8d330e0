"""Record of a manoeuvre from a log of a real trial."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Log
from seatrial.trial.logs.formats import read_log
from seatrial.trial.logs.quantities import Column
from seatrial_kits.logs.paired.common_time import WHOLE, Window

from .figures.record import Record
from .log_motion import motion

FURTHER = ("helm", "roll", "pitch", "depth", "power")
"""Quantities of a record besides heading and position."""
MOTION = ("time", "north", "east", "latitude", "longitude", "heading", *FURTHER)
"""All quantities that a record is made of."""


def read_record(
    path: Path,
    columns: Mapping[str, Column],
    format_name: str | None = None,
    window: Window = WHOLE,
) -> tuple[Record, tuple[str, ...]]:
    """Return the record in a log, at the instants of its heading, and notes for a person.

    Raises InputError as `read_log`, `motion` and `Record` do.
    """
    return record_of(read_log(path, format_name, columns.get("time")), columns, window)


def record_of(
    log: Log, columns: Mapping[str, Column], window: Window = WHOLE
) -> tuple[Record, tuple[str, ...]]:
    """Return the record in a log that is read, and notes; raises InputError as `read_record`."""
    found = motion(log, columns, FURTHER, window)
    try:
        return Record(found.time, **found.values), (*log.notes, *found.notes)
    except InputError as error:
        raise InputError(f"{log.path}: {error}") from None
