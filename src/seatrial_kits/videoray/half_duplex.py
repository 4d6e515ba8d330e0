"""Half-duplex RS-485 line: one sender at a time."""

from __future__ import annotations

from seatrial.model.component import NS

BITS_PER_BYTE = 10
"""8N1: a start bit, 8 bits, a stop bit."""


def byte_time(baud: float) -> int:
    """Return the time of one byte, ns, rounded."""
    return round(NS * BITS_PER_BYTE / baud)


class HalfDuplex:
    """Times at which one end may send: after what it receives, and after what it sends itself.

    An ideal line: only one end sends at a time, the other waits; so there are no
    collisions. ``turnaround_ns`` is the pause before an answer, in which drivers change over.
    """

    def __init__(self, baud: float, turnaround_ns: int) -> None:
        self.byte_ns = byte_time(baud)
        self._turnaround_ns = turnaround_ns
        self.free_ns = 0
        """Time from which on the line is free."""

    def received(self, begin_ns: int, count: int) -> int:
        """Take note of bytes that begin to arrive; return when their last one ends."""
        end = begin_ns + count * self.byte_ns
        self.free_ns = max(self.free_ns, end)
        return end

    def transmit(self, requested_ns: int, count: int) -> int:
        """Return when the first of ``count`` bytes begins that are ready at ``requested_ns``."""
        begin = max(requested_ns, self.free_ns) + self._turnaround_ns
        self.free_ns = begin + count * self.byte_ns
        return begin
