"""Bytes of a MAVLink peer, against pymavlink's own parser."""

from __future__ import annotations

from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.codec import Codec

_MOST_BYTES = 1 << 14


def one(data: bytes) -> None:
    """Decode in pieces, as a link does, and all at once, as the reference does."""
    codec, found = Codec(1, 1), []
    size = 1 + (data[0] if data else 0)
    for begin in range(0, len(data), size):
        found += [bytes(m.get_msgbuf()) for m in codec.decode(data[begin : begin + size])]
    assert len(codec._mav.buf) <= len(data) + _MOST_BYTES
    reference = mavlink.MAVLink(None)
    reference.robust_parsing = True
    parsed = reference.parse_buffer(data) or []
    known = [m for m in parsed if not m.get_type().startswith(("BAD_DATA", "UNKNOWN"))]
    assert found == [bytes(m.get_msgbuf()) for m in known]
