"""An RS-485 line: one pair of wires, on which one speaks at a time."""

from __future__ import annotations

from ...component import NS

BITS_PER_BYTE = 10
"""8N1: a start bit, 8 bits, a stop bit."""


def byte_time(baud: float) -> int:
    """Return the time of one byte, ns, rounded."""
    return round(NS * BITS_PER_BYTE / baud)


class HalfDuplex:
    """When one end may speak: after what it hears, and after what it says itself.

    An ideal line: nobody speaks while another does, whoever has to wait, waits; so there are no
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

    def speak(self, asked_ns: int, count: int) -> int:
        """Return when the first of ``count`` bytes begins that are ready at ``asked_ns``."""
        begin = max(asked_ns, self.free_ns) + self._turnaround_ns
        self.free_ns = begin + count * self.byte_ns
        return begin
