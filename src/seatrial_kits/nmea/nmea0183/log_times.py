"""Times before sentences, and in them."""

from __future__ import annotations

import math
import re
from datetime import datetime

from seatrial.trial.logs.clock_times import of_day, parsed_time, past_midnight

__all__ = ["past_midnight", "stamp", "time_of_day"]

_TAG_TIME = re.compile(r"\\(?:[^\\*]*,)?c:(\d+)")
"""UNIX time of a TAG block (NMEA 0183 4.0, section 7)."""
_MILLISECONDS = 1e11
"""A UNIX time above is in ms."""
_PLACES = {"RMC": 1, "GGA": 1, "GNS": 1, "ZDA": 1, "GLL": 5}
"""Field with the time of day, by formatter."""
_OF_DAY = re.compile(r"(\d\d)(\d\d)(\d\d(?:\.\d*)?)")


def stamp(prefix: str) -> float | None:
    """Return the time before a sentence: s since 1970, or since midnight; None if there is none."""
    tag = _TAG_TIME.search(prefix)
    text = tag[1] if tag else prefix.strip(" \t,;:|[]()<>")
    if not text:
        return None
    try:
        number = float(text)
    except ValueError:
        moment = parsed_time(text)
        if isinstance(moment, datetime):
            return moment.timestamp()
        return None if moment is None else of_day(moment)
    if not math.isfinite(number):
        return None
    return number / 1e3 if number > _MILLISECONDS else number


def time_of_day(sentence: str) -> float | None:
    """Return the time in a sentence, s since midnight; None of one without."""
    place = _PLACES.get(sentence[3:6])
    fields = sentence.partition("*")[0].split(",")
    if place is None or place >= len(fields):
        return None
    found = _OF_DAY.fullmatch(fields[place])
    return (
        None if found is None else int(found[1]) * 3600.0 + int(found[2]) * 60.0 + float(found[3])
    )
