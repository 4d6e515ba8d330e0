"""Segments of a TCP connection between a modem and a base station, as chunks of a String port.

A segment is one letter, the number of the connection (2 bytes, big endian) and, with some, bytes:
O opens (``HOST:PORT``), A accepts, R refuses, D brings data, K acknowledges how many have arrived
in all (4 bytes), C closes. TCP itself (sequence numbers, windows, retransmission) is not modelled:
a segment arrives once and in order, or not at all.
"""

from __future__ import annotations

from typing import NamedTuple

from seatrial.errors import InputError

OPEN, ACCEPT, REFUSE, DATA, ACKNOWLEDGE, CLOSE = "OARDKC"
_KINDS = "OARDKC"
HEADERS = 40
"""Bytes of an IP and a TCP header, which every segment has on the air."""


class Segment(NamedTuple):
    """One segment: its kind, the number of its connection, its bytes."""

    kind: str
    connection: int
    data: bytes = b""


def encode(segment: Segment) -> bytes:
    """Return a segment's bytes."""
    return segment.kind.encode() + (segment.connection % 65536).to_bytes(2) + segment.data


def decode(chunk: bytes) -> Segment:
    """Return a chunk as a segment. Raises InputError for one that is none."""
    kind = chunk[:1].decode("latin-1")
    if len(chunk) < 3 or kind not in _KINDS:
        raise InputError(
            f"{chunk[:20]!r} is no segment: one of {', '.join(_KINDS)}, two bytes, data"
        )
    return Segment(kind, int.from_bytes(chunk[1:3]), chunk[3:])
