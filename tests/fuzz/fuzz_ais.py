"""Sentences of AIS, in one and in several parts, against pynmea2's checksums."""

from __future__ import annotations

import pynmea2

from seatrial_kits.nmea.ais.codec import Assembly, read, sentences, to_air

_PARTS, _NUMBERS = 9, 10
"""Most parts of one message, and numbers that tell messages in parts (IEC 61162-1)."""


def one(data: bytes) -> None:
    """Take lines, as they are and with right checksums; what is read can be sent again."""
    lines = data.split(b"\n")
    for some in (lines, map(_completed, lines)):
        assembly = Assembly()
        for line in some:
            _take(assembly, line)


def _take(assembly: Assembly, line: bytes) -> None:
    taken = assembly.take(line)
    assert len(assembly.waiting) <= _NUMBERS
    assert all(len(parts) <= _PARTS for parts in assembly.waiting.values())
    if taken is None:
        return
    body, star, check = line.strip()[1:].partition(b"*")
    assert star
    assert int(check[:2], 16) == pynmea2.NMEASentence.checksum(body.decode("latin-1"))
    fields, _own = taken
    again = read(*sentences(to_air(fields), "VDM"))
    assert again is None or again["msg_type"] == fields["msg_type"]


def _completed(line: bytes) -> bytes:
    body = line.strip().lstrip(b"!").partition(b"*")[0]
    check = pynmea2.NMEASentence.checksum(body.decode("latin-1"))
    return b"!" + body + f"*{check:02X}".encode()
