"""A serial line of a component, from the other end."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..api.written import as_duration
from ..links.text import Inbox, encode
from ..model.readable import number
from ..system.rig import duration_ns

if TYPE_CHECKING:
    from ..api.simulation import Simulation

_SHOWN = 120
"""Bytes that a message shows."""


class Line:
    """Bytes to an input and from an output of a component, in `seatrial.links.text`."""

    def __init__(self, bench: Simulation, rx: str, tx: str) -> None:
        self.said = b""
        """All bytes that have arrived."""
        self._bench, self._rx, self._tx = bench, rx, tx
        self._inbox: dict[str, Any] = {}
        self._sequence, self._waiting = 0, list[tuple[int, bytes]]()
        self._read = 0
        self.listeners: list[Callable[[int, bytes], None]] = []
        """Called with each chunk: its time, ns, and its bytes."""
        self._take()
        bench.observe(self._take)

    def send(self, data: bytes | str) -> None:
        """Send bytes, or text as UTF-8, now. Raises InputError if something else feeds the line."""
        data = data.encode() if isinstance(data, str) else data
        self._waiting.append((round(self._bench.time * 1e9), data))
        self._bench.set(self._rx, encode(self._sequence + 1, self._waiting))

    def expect(self, wanted: bytes | str, within: float | str = "1 s") -> bytes:
        """Step until the line says ``wanted``; return all that it said up to and with that.

        Begins behind what the last call found. Raises AssertionError, with what the line said, if
        that does not come ``within`` a simulated time from now, s or text.
        """
        __tracebackhide__ = True
        data = wanted.encode() if isinstance(wanted, str) else wanted
        begun = self._bench.time
        end_ns = round(begun * 1e9) + duration_ns(str(as_duration(within)), "within")
        while (found := self.said.find(data, self._read)) < 0:
            if round(self._bench.time * 1e9) >= end_ns:
                raise AssertionError(self._missed(data, begun))
            self._bench.step()
        said = self.said[self._read : found + len(data)]
        self._read = found + len(data)
        return said

    def _take(self, _simulation: object = None) -> None:
        if self._waiting and _simulation is not None:  # they have been read in the step
            self._sequence, self._waiting = self._sequence + 1, []
        for time_ns, data in Inbox(self._inbox).take(self._bench.get(self._tx)):
            self.said += data
            for listener in self.listeners:
                listener(time_ns, data)

    def _missed(self, wanted: bytes, begun: float) -> str:
        said = self.said[self._read :]
        shown = f"{said[-_SHOWN:]!r}" if said else "nothing"
        return (
            f"{self._tx} did not say {wanted!r} from {number(begun, 6)} s to "
            f"{number(self._bench.time, 6)} s; it said {shown}"
        )
