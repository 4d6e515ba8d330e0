"""Text logs of NMEA 0183 sentences, with or without a time before each."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, time
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.logs.channels import Array, Log, Samples, counted
from seatrial.trial.logs.clock_times import date_of, of_day, parsed_time, past_midnight
from seatrial.trial.logs.reading_progress import open_text

from .codec import decode
from .log_fields import KINDS, SENTENCE, is_valid, values_of

__all__ = ["past_midnight", "stamp", "time_of_day"]

_TAG_TIME = re.compile(r"\\(?:[^\\*]*,)?c:(\d+)")
"""UNIX time of a TAG block (NMEA 0183 4.0, section 7)."""
_MILLISECONDS = 1e11
"""A UNIX time above is in ms."""
_BYTE_ORDER_MARK = "\xef\xbb\xbf"
"""At the beginning of a text in UTF-8 that Windows has written, as Latin-1."""
_PLACES = {"RMC": 1, "GGA": 1, "GNS": 1, "ZDA": 1, "GLL": 5}
"""Field with the time of day, by formatter."""
_OF_DAY = re.compile(r"(\d\d)(\d\d)(\d\d(?:\.\d*)?)")


def stamp(prefix: str) -> float | None:
    """Return the time before a sentence: s since 1970, or since midnight; None if there is none."""
    prefix = prefix.removeprefix(_BYTE_ORDER_MARK)
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


@dataclass(frozen=True)
class _Line:
    number: int
    stamp: float | None
    """Time that stands before the sentence, s since 1970 or since midnight."""
    message: Any


def read(path: Path) -> Log:
    """Return the log of a talker or a network: channels ``FORMATTER.FIELD``.

    Where a time stands before every sentence (UNIX time, ISO 8601, a time of day, a TAG block), the
    time of the sentence is that. Else it is the time in the sentences with a position or a date;
    the n sentences of one formatter that follow such a time are spread evenly to the next, the
    first of them at that time. Midnight is passed.

    The first talker of a formatter keeps plain names; others have their two letters before theirs.
    Sentences that are marked invalid, positions without a fix among them, are left out.

    Raises InputError for a file without a sentence, or without a time.
    """
    skipped: Counter[str] = Counter()
    others: Counter[str] = Counter()
    lines = _lines(path, skipped, others)
    unread = counted(others, "sentences that are not read")
    if not lines:
        there = "".join(f"; {note}" for note in unread)
        raise InputError(
            f"{path}: no sentence with a good checksum that a channel has was found: no NMEA 0183 "
            f"log{there}"
        )
    stamps = {line.stamp for line in lines}
    if None not in stamps and (len(stamps) > 1 or len(lines) == 1):
        times = past_midnight([line.stamp or 0.0 for line in lines])
        start = date_of(times[0])
    else:
        times, start = _by_epochs(path, lines)
    samples, begun = Samples(), float(np.nanmin(times))
    for line, moment in zip(lines, times, strict=True):
        if not is_valid(line.message):
            skipped[f"sentences {line.message.msgID} are marked invalid and left out"] += 1
        elif np.isnan(moment):
            skipped["sentences before the first time are left out"] += 1
        else:
            for name, (unit, value) in values_of(line.message).items():
                since = float(moment) - begun
                samples.add(name, unit, since, value, line.number, line.message.talker)
    notes = (*(f"{count} {what}" for what, count in skipped.items()), *unread)
    return Log(path, samples.channels(), start=start, notes=notes, row="line")


def _lines(path: Path, skipped: Counter[str], others: Counter[str]) -> list[_Line]:
    """Return the sentences that are read; count those of other formatters, and other lines."""
    found = []
    with open_text(path, "latin-1") as file:
        for number, line in enumerate(file, 1):
            sentence = SENTENCE.search(line)
            if sentence is not None and sentence.group()[3:6] not in KINDS:
                others[sentence.group()[3:6]] += 1
                continue
            message = None if sentence is None else decode(sentence.group().encode("latin-1"))
            if sentence is None or message is None:
                skipped["lines without a sentence of good checksum are skipped"] += bool(
                    line.strip()
                )
            else:
                found.append(_Line(number, stamp(line[: sentence.start()]), message))
    return found


# ---------------------------------------------------------------------- times in sentences


def _by_epochs(path: Path, lines: Sequence[_Line]) -> tuple[Array, datetime | None]:
    """Return the time of each sentence by those that have one, NaN before the first; the date."""
    own = [(place, of_day(line.message.time)) for place, line in enumerate(lines)
           if isinstance(getattr(line.message, "time", None), time)]  # fmt: skip
    if not own:
        raise InputError(
            f"{path}: no sentence has a time (RMC, GGA, ZDA), and none stands before each"
        )
    seconds = np.maximum.accumulate(past_midnight([second for _, second in own]))
    first = np.concatenate(([0], np.flatnonzero(np.diff(seconds) > 0.0) + 1))
    starts = np.array([own[k][0] for k in first])
    epochs = seconds[first]
    times = np.full(len(lines), np.nan)
    usual = float(np.median(np.diff(epochs))) if len(epochs) > 1 else 1.0
    ends = np.append(starts[1:], len(lines))
    for start, end, epoch, following in zip(
        starts, ends, epochs, np.append(epochs[1:], epochs[-1] + usual), strict=True
    ):
        _spread(lines[start:end], times[start:end], epoch, following - epoch)
    for place, second in zip((place for place, _ in own), seconds, strict=True):
        times[place] = second
    return times, _start(lines, times, float(epochs[0]))


def _spread(lines: Sequence[_Line], times: Array, epoch: float, length: float) -> None:
    """Set the times of the sentences of an epoch: those of each kind evenly over its length."""
    kinds = [(line.message.talker, line.message.msgID) for line in lines]
    number, done = Counter(kinds), Counter[tuple[str, str]]()
    for place, kind in enumerate(kinds):
        times[place] = epoch + length * done[kind] / number[kind]
        done[kind] += 1


def _start(lines: Sequence[_Line], times: Array, first: float) -> datetime | None:
    """Return the date and time of the first epoch, by the first sentence that has a date."""
    for line, moment in zip(lines, times, strict=True):
        day = _day(vars(line.message))
        if day is not None and np.isfinite(moment):
            midnight = datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp()
            return date_of(midnight + moment % 86400.0 - (moment - first))
    return None


def _day(fields: Mapping[str, Any]) -> date | None:
    if isinstance(found := fields.get("date"), date):
        return found
    try:
        return date(fields["year"], fields["month"], fields["day"])
    except (KeyError, TypeError, ValueError):
        return None
