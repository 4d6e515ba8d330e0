"""NMEA 0183 sentences to bytes and back: pynmeagps, and what it leaves to do.

Fields, their order and the checksums are pynmeagps's, and so are the fields' names.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import reduce
from operator import xor
from typing import Any

from pynmeagps import NMEAMessage, NMEAReader
from pynmeagps.exceptions import NMEAMessageError, NMEAParseError, NMEAStreamError, NMEATypeError
from pynmeagps.nmeatypes_core import GET
from pynmeagps.nmeatypes_get import NMEA_PAYLOADS_GET

from .readings import Readings

_HEMISPHERES = ("NS", "EW")
_REFUSALS = (
    NMEAMessageError,
    NMEAParseError,
    NMEAStreamError,
    NMEATypeError,
    # It lets these through for some malformed sentences.
    ArithmeticError,
    AttributeError,
    LookupError,
    TypeError,
    ValueError,
)


def encode(talker: str, formatter: str, fields: Mapping[str, Any]) -> bytes:
    """Return a sentence: ``$``, talker, formatter, fields, checksum, carriage return, line feed.

    ``fields`` are all fields of the formatter, but for the hemispheres: text as it is to be sent,
    "" for an empty one, None for one at the end that is not sent; lat and lon are numbers,
    degrees, north and east positive, or "".
    """
    given = {name: _whole_minutes(value) for name, value in fields.items() if value is not None}
    message = NMEAMessage(talker, formatter, GET, **given)
    placeless = fields.get("lat") == ""
    if placeless:  # it has a word for each hemisphere too
        written = zip(NMEA_PAYLOADS_GET[formatter], message.payload, strict=False)
        payload = ["" if name in _HEMISPHERES else text for name, text in written]
        message = NMEAMessage(talker, formatter, GET, payload=payload)
    not_sent = len(fields) - len(given)
    if not_sent:
        payload = message.payload[: len(message.payload) - not_sent]
        message = NMEAMessage(talker, formatter, GET, payload=payload)
    return bytes(message.serialize())


def decode(line: bytes) -> Any:
    """Return a sentence with its fields as attributes: numbers, text, "" for an empty one.

    Returns None for what is no sentence, has no checksum or a wrong one, characters that are not
    ASCII or not printable, or numbers that are not finite. Fields of a formatter that is not known
    have no names.
    """
    if not (line.isascii() and line.decode("ascii").isprintable() and _has_checksum(line)):
        return None
    try:
        message = NMEAReader.parse(line)
    except _REFUSALS:
        return None
    if message is None:
        return None
    numbers = (value for value in vars(message).values() if isinstance(value, float))
    return message if all(map(math.isfinite, numbers)) else None


def _has_checksum(line: bytes) -> bool:
    """Return whether a line is a sentence with the right checksum: pynmeagps passes some over."""
    body, _, check = line[1:].partition(b"*")
    found = f"{reduce(xor, body, 0):02X}".encode()
    return line[:1] in (b"$", b"!") and check[:2].upper() == found


def _whole_minutes(value: Any) -> Any:
    """Return degrees rounded as they are written: else there are minutes such as 60.00000."""
    return round(value * 60.0, 5) / 60.0 if isinstance(value, float) else value


Fields = dict[str, Any]

KNOT = 1852.0 / 3600.0
"""m/s."""
FOOT = 0.3048
FATHOM = 6.0 * FOOT
CELSIUS = 273.15
MILE = 1852.0


def bearing(direction: float | None) -> str:
    """Return a direction in degrees, 0.00 to 359.99."""
    return "" if direction is None else f"{round(math.degrees(direction), 2) % 360.0:.2f}"


def number(value: float | None, decimals: int, unit: float = 1.0) -> str:
    """Return a value in a unit with some decimals, "" for none."""
    # Adding 0 takes the sign off what was rounded to minus zero.
    return "" if value is None else f"{round(value / unit, decimals) + 0.0:.{decimals}f}"


def time(of: Readings) -> str:
    """Return the time of day, UTC."""
    return f"{of.time:%H%M%S}.{of.time.microsecond // 10_000:02}"


def place(of: Readings) -> Fields:
    """Return latitude and longitude, degrees."""
    if of.position is None:
        return {"lat": "", "lon": ""}
    return {"lat": of.position[0], "lon": of.position[1]}


def variation(of: Readings, name: str, side: str) -> Fields:
    """Return the magnetic variation and its side."""
    degrees = round(math.degrees(of.variation), 1)
    return {name: f"{abs(degrees):.1f}", side: "W" if degrees < 0.0 else "E"}


def status(reading: object) -> str:
    """Return A for a reading that is valid, V for one that is not."""
    return "V" if reading is None else "A"


def mode(reading: object) -> str:
    """Return mode A for a reading that is valid, N for one that is not."""
    return "N" if reading is None else "A"
