"""Text logs of NMEA 0183, by which they are recognised; nothing of the codec is imported."""

from __future__ import annotations

from functools import reduce
from operator import xor
from pathlib import Path

from seatrial.trial.logs.channels import Log
from seatrial.trial.logs.formats import Format
from seatrial.trial.logs.quantities import Column

from .log_fields import DEFAULTS, SENTENCE

_LOOKED_AT = 50
"""Lines, of which one has to have a sentence."""


def _read(path: Path, _: Column | None) -> Log:
    from .log_reader import read

    return read(path)


def _recognises(path: Path, head: bytes) -> bool:
    lines = head.decode("latin-1").splitlines()[:_LOOKED_AT]
    found = filter(None, map(SENTENCE.search, lines))
    return any(reduce(xor, each[1].encode("latin-1"), 0) == int(each[2], 16) for each in found)


NMEA0183 = Format("NMEA 0183 log", _recognises, _read, defaults=DEFAULTS)
