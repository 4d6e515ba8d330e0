"""Frames on a CAN bus as the bytes of a fuzzer say."""

from __future__ import annotations

from seatrial.links.can.frame import Frame


def frames_of(data: bytes) -> list[Frame]:
    """Return extended frames of up to 8 bytes: four bytes of identifier, one of length, data."""
    found, place = [], 0
    while len(data) - place >= 5:
        identifier = int.from_bytes(data[place : place + 4], "big") & 0x1FFFFFFF
        length = data[place + 4] % 9
        found.append(Frame(identifier, data[place + 5 : place + 5 + length], extended=True))
        place += 5 + length
    return found
