"""Schedule of sentences: talkers and periods."""

from __future__ import annotations

import re
from typing import NamedTuple

from seatrial.errors import InputError, unknown
from seatrial.model.component import NS

from .sentences import SENTENCES

_ENTRY = re.compile(r"(?P<talker>[A-Z]{2})(?P<name>[A-Z]{3}(?:-[A-Z])?)\s+(?P<period>\d*\.?\d+)")


class Periodic(NamedTuple):
    """A sentence that is sent every so often."""

    talker: str
    name: str
    """A key of `SENTENCES`."""
    period_ns: int


def schedule(written: str) -> list[Periodic]:
    """Return the schedule of ``TALKER+SENTENCE PERIOD; ...``, periods in s.

    Raises InputError for a text of another form, a sentence that is not known (near misses), one
    that is named twice, and a period of 0.
    """
    found: list[Periodic] = []
    for text in filter(None, (part.strip() for part in written.split(";"))):
        match = _ENTRY.fullmatch(text)
        if match is None:
            raise InputError(
                f"{text!r} is not TALKER+SENTENCE PERIOD, such as 'GPRMC 1' or 'WIMWV-R 0.5'"
            )
        talker, name = match["talker"], match["name"]
        if name not in SENTENCES:
            raise InputError(unknown("sentence", name, SENTENCES))
        period_ns = round(float(match["period"]) * NS)
        if period_ns < 1:
            raise InputError(f"{text!r}: the period is above 0")
        if any((talker, name) == other[:2] for other in found):
            raise InputError(f"{talker}{name} is named twice")
        found.append(Periodic(talker, name, period_ns))
    return found
