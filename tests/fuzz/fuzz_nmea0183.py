"""Bytes on an NMEA 0183 line, against pynmea2: sentences, and orders of a steering autopilot."""

from __future__ import annotations

import math

import pynmea2

from seatrial_kits.nmea.nmea0183.codec import decode
from seatrial_kits.nmea.nmea0183.component import Lines
from seatrial_kits.nmea.nmea0183.orders import read_order
from seatrial_kits.nmea.nmea0183.quantities import READERS, quantities_of

_LONGEST = 1024


def one(data: bytes) -> None:
    """Split, decode and read orders; what is taken has a checksum that the reference finds right."""
    lines, size = Lines(), 1 + (data[0] if data else 0)
    whole: list[bytes] = []
    for begin in range(0, len(data), size):
        whole += lines.take(data[begin : begin + size])
        assert len(lines.waiting) <= _LONGEST
    for line in [*whole, *map(_completed, whole)]:
        message = decode(line)
        if message is None:
            continue
        body, star, check = line[1:].partition(b"*")
        assert star
        assert int(check[:2], 16) == pynmea2.NMEASentence.checksum(body.decode())
        order = read_order(message, 0.1)
        numbers = [] if order is None else [v for v in vars(order).values() if type(v) is float]
        assert all(map(math.isfinite, numbers))
        quantities = quantities_of(message) if message.msgID in READERS else {}
        assert all(math.isfinite(v) for values in quantities.values() for v in values or ())


def _completed(line: bytes) -> bytes:
    """Return a line as a sentence whose checksum is right, so that its fields are read."""
    body = line.lstrip(b"$!").partition(b"*")[0].decode("ascii", "replace")
    return f"${body}*{pynmea2.NMEASentence.checksum(body):02X}".encode()
