"""Sentences between boat and base station, of the form of NMEA 0183.

    $PGLM,SERIES,NUMBER,TOTAL,NORTH,EAST,SIDE,RADIUS*hh      base station: a mark
    $PGLT,SERIES,HELD,PASSED,NORTH,EAST,HEADING,SPEED*hh     boat: where she is

A list of marks has a number, SERIES; HELD has bit n - 1 set for mark n of that list that the boat
has, PASSED is how many she has passed. NORTH, EAST and RADIUS are decimetres, counted from the
home of the boat; SIDE is on which the mark is left: p, s, or n where it is any; HEADING is in
tenths of a degree, SPEED in centimetres per second. Whole numbers: a microcontroller is fast then.
"""

from __future__ import annotations

import re
from functools import reduce
from operator import xor
from typing import NamedTuple

from seatrial.errors import InputError

LONGEST = 256
_NUMBER = re.compile(r"-?[0-9]{1,9}")
_SIDES = {"port": "p", "starboard": "s", "any": "n"}


class Mark(NamedTuple):
    """A mark of a list: whole numbers as in the sentence, the side as p, s or n."""

    series: int
    number: int
    total: int
    north: int
    east: int
    side: str
    radius: int


class Report(NamedTuple):
    """What a boat reports: whole numbers as in the sentence."""

    series: int
    held: int
    passed: int
    north: int
    east: int
    heading: int
    speed: int


def read_sides(text: str) -> list[str]:
    """Return p, s or n for each word of ``port starboard any``. Raises InputError."""
    for word in text.split():
        if word not in _SIDES:
            raise InputError(f"sides: {word!r} is none of {', '.join(_SIDES)}")
    return [_SIDES[word] for word in text.split()]


def checksum(body: str) -> str:
    """Return the exclusive or of all characters between ``$`` and ``*``, two digits."""
    return f"{reduce(xor, body.encode('latin-1'), 0):02X}"


def encode(sentence: Mark | Report) -> bytes:
    """Return the bytes of a sentence, with checksum and end of line."""
    name = "PGLM" if isinstance(sentence, Mark) else "PGLT"
    body = ",".join([name, *map(str, sentence)])
    return f"${body}*{checksum(body)}\r\n".encode()


def decode(line: str) -> Mark | Report | None:
    """Return what a line without its end says, None if it is damaged or says something else."""
    start = line.rfind("$")
    body, star, check = line[start + 1 :].strip().partition("*")
    if start < 0 or not star or check.upper() != checksum(body):
        return None
    name, *fields = body.split(",")
    kind: type[Mark] | type[Report] | None = {"PGLM": Mark, "PGLT": Report}.get(name)
    if kind is None or len(fields) != len(kind._fields):
        return None
    values = dict(zip(kind._fields, fields, strict=True))
    side = values.pop("side", "n")
    if side not in _SIDES.values() or not all(map(_NUMBER.fullmatch, values.values())):
        return None
    numbers = {key: int(value) for key, value in values.items()}
    return Mark(side=side, **numbers) if kind is Mark else Report(**numbers)
