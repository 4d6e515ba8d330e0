"""Frames of a telemetry log: 8 bytes with the time of the recorder, us since 1970, before each."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

_STAMP = 8
_V1, _V2 = 0xFE, 0xFD
_OVERHEAD = {_V1: 8, _V2: 12}
_SIGNATURE = 13
_OLDEST_US, _LATEST_US = 0, 4_102_444_800_000_000
"""1970 to 2100."""


class Frame(NamedTuple):
    """A message, when it was recorded, its number in the file, and its sender."""

    stamp_us: int
    number: int
    message: Any
    sender: str
    """System and component, ``1.1``."""


def tlog_frames(data: bytes, skipped: Counter[str]) -> Iterator[Frame]:
    """Yield the frames with good checksums; of what is none, find the next stamp and frame."""
    from pymavlink.dialects.v20 import all as mavlink

    parser = mavlink.MAVLink(None)
    place, number, lost = 0, 0, False
    while place + _STAMP < len(data):
        length = _length(data, place + _STAMP)
        end = place + _STAMP + length
        if length and end > len(data):
            skipped["record at the end is cut"] += not lost
            return
        stamp = int.from_bytes(data[place : place + _STAMP], "big")
        message = None
        if length and _OLDEST_US <= stamp <= _LATEST_US:
            with contextlib.suppress(mavlink.MAVError, ValueError, LookupError, TypeError):
                message = parser.decode(bytearray(data[place + _STAMP : end]))
        if message is None:
            if not lost:
                skipped["places without a readable frame are skipped"] += 1
            lost, place = True, place + 1
            continue
        lost, place, number = False, end, number + 1
        if message.get_type().startswith("UNKNOWN"):
            skipped["messages of an unknown kind are skipped"] += 1
        else:
            sender = f"{message.get_srcSystem()}.{message.get_srcComponent()}"
            yield Frame(stamp, number, message, sender)


def _length(data: bytes, place: int) -> int:
    """Return the length of the frame that begins at a place, 0 if none does."""
    magic = data[place]
    if magic not in _OVERHEAD or place + 2 >= len(data):
        return 0
    signed = magic == _V2 and data[place + 2] & 1
    return int(data[place + 1]) + _OVERHEAD[magic] + (_SIGNATURE if signed else 0)


def begins_as_tlog(head: bytes) -> bool:
    """Return whether the first bytes of a file are a time stamp and the header of a frame."""
    stamp = int.from_bytes(head[:_STAMP], "big")
    return len(head) > _STAMP and _length(head, _STAMP) > 0 and 0 < stamp <= _LATEST_US
