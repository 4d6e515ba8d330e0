"""Half-duplex RS-485 line: one sender at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from seatrial.model.component import NS, Component, Logging

from .parser import Parser
from .stream_file import StreamLog

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


class LineEnd(Logging, Component):
    """A component at a line: it records its stream, and has a parser in its state.

    Subclasses make ``_parser``, ``_line`` and what else they are of in `_build`, and give the state
    of the latter by `_saved` and `_restore`.
    """

    discrete = True
    transient = Component.transient | {"_parser", "_line", "_log"}
    _parser: Parser
    _line: HalfDuplex

    def __init__(self, name: str = "component") -> None:
        super().__init__(name)
        self._log = StreamLog()

    def start(self, t: float) -> None:
        """Start with nothing received, waiting or sent."""
        self._log.close()
        self._log = StreamLog()
        self._build()
        self._waiting: list[list[Any]] = []
        self._rx: dict[str, Any] = {}
        self._tx: dict[str, Any] = {}

    def close(self) -> None:
        """End the record of the stream."""
        self._log.close()

    def get_state(self) -> dict[str, Any]:
        """Return a copy of the whole state, that of the line's end included, as plain data."""
        line = {"parser": self._parser.saved(), "free_ns": self._line.free_ns}
        return {**super().get_state(), "parts": {**self._saved(), **line}}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state({name: value for name, value in state.items() if name != "parts"})
        self._build()
        self._restore(state["parts"])
        self._parser.restore(state["parts"]["parser"])
        self._line.free_ns = state["parts"]["free_ns"]

    def _build(self) -> None:
        raise NotImplementedError

    def _saved(self) -> dict[str, Any]:
        raise NotImplementedError

    def _restore(self, parts: Mapping[str, Any]) -> None:
        raise NotImplementedError
