"""Validation of parameters given as texts and numbers."""

from __future__ import annotations

import datetime
import re

from ..errors import InputError
from ..model.component import Parameter

_VERSION = re.compile(r"\d{1,3}\.\d{1,3}\.\d{1,3}(-(dev|alpha|beta|rc))?")
_EPOCH = datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
_NAME = re.compile(r"[!-~]{1,10}")


def whole_number(name: str, value: float) -> int:
    """Return a parameter that must be a whole number as one; raise InputError."""
    if value % 1.0:
        raise InputError(f"{name} is {value!r}, a whole number is needed")
    return round(value)


def serial_number(text: str) -> int:
    """Return the serial number that ``uid`` writes out; raise InputError."""
    if not text.isdecimal() or not 0 <= int(text) < 1 << 64:
        raise InputError(f"uid is {text!r}, a whole number from 0 to 2^64 - 1 is needed")
    return int(text)


def version(text: str) -> str:
    """Return ``firmware_version`` if it is one; raise InputError."""
    if not _VERSION.fullmatch(text):
        raise InputError(
            f"firmware_version is {text!r}, something like '4.5.0' or '4.5.0-dev' is needed"
        )
    return text


def start_us(date: str) -> int:
    """Return the Unix time of a day's midnight UTC, or of an instant, us; raise InputError."""
    try:
        if "T" in date:
            start = datetime.datetime.fromisoformat(date)
        else:
            midnight = datetime.time(tzinfo=datetime.UTC)
            start = datetime.datetime.combine(datetime.date.fromisoformat(date), midnight)
    except ValueError:
        start = datetime.datetime.min
    if start.tzinfo is None:
        raise InputError(
            f"date is {date!r}, a day like '2026-02-05' is needed, or an instant like "
            "'2026-02-05T12:00:00Z'"
        )
    return (start - _EPOCH) // datetime.timedelta(microseconds=1)


def start_date(day: str = "2026-01-01") -> Parameter:
    """Return the parameter ``date`` of a component."""
    meaning = "UTC at the start of the run: a day, for its midnight, or an instant"
    return Parameter(day, "1", meaning, check=start_us, role="start-time")


def value_names(text: str, most: int) -> list[str]:
    """Return the names of ``names``, at most ``most``; raise InputError."""
    names = text.split()
    if len(names) > most:
        raise InputError(f"names has {len(names)} names, at most {most} are allowed")
    for name in names:
        if not _NAME.fullmatch(name):
            raise InputError(f"names: {name!r} is not a name of 1 to 10 ASCII characters")
    return names
