"""A running bus terminal of FMI-LS-BUS: operations on their way to the FMU and from it."""

from __future__ import annotations

import copy
import struct
from collections.abc import Iterator
from typing import Any

from ...errors import InputError, SimulationError
from ...links.text import Chunk, Inbox, Outbox
from .lsbus import BusTerminal

_HEADER = struct.Struct("<II")
"""Of an operation: code and whole length."""


class BusPort:
    """A running terminal: operations that wait for the FMU, and those that it has sent."""

    def __init__(self, terminal: BusTerminal) -> None:
        self.terminal = terminal
        self._in: dict[str, Any] = {}
        self._out: dict[str, Any] = {}
        self._waiting: list[Chunk] = []

    @property
    def next_ns(self) -> int | None:
        """Instant at which the FMU gets the next operation; None if none waits."""
        return self._waiting[0][0] if self._waiting else None

    def is_due(self, now_ns: int) -> bool:
        """Say if the FMU gets operations now."""
        return bool(self._waiting) and self._waiting[0][0] <= now_ns

    def take(self, text: str, now_ns: int, later_ns: int | None) -> None:
        """Take in what is new in a text. What is of the past comes now.

        ``later_ns`` is when what is of the future comes; None: at its own time. Raises
        SimulationError for a text that no bus has written, or one that was missed.
        """
        try:
            chunks = Inbox(self._in).take(text)
        except InputError as error:
            raise SimulationError(str(error)) from None
        for when_ns, data in chunks:
            if when_ns <= now_ns:
                self._waiting.append((now_ns, data))
            else:
                self._waiting.append((when_ns if later_ns is None else later_ns, data))

    def due(self, now_ns: int) -> bytes:
        """Return operations that the FMU gets now, as many as it takes at once."""
        data = b""
        while self.is_due(now_ns):
            more = self._waiting[0][1]
            if data and self.terminal.largest and len(data) + len(more) > self.terminal.largest:
                break
            data += more
            del self._waiting[0]
        return data

    def send(self, now_ns: int, data: bytes) -> None:
        """Keep operations that the FMU sends."""
        outbox = Outbox(self._out)
        for operation in _operations(data):
            outbox.put(now_ns, operation)

    def flush(self) -> str:
        """Return the text of what was sent until now."""
        return Outbox(self._out).flush()

    def memory(self) -> Any:
        """Return a copy of all that `recall` takes back."""
        return copy.deepcopy((self._in, self._out, self._waiting))

    def recall(self, memory: Any) -> None:
        """Take back what `memory` returned."""
        self._in, self._out, self._waiting = copy.deepcopy(memory)


def _operations(data: bytes) -> Iterator[bytes]:
    """Yield operations one by one: one that is damaged takes no other with it."""
    while data:
        length = _HEADER.unpack_from(data)[1] if len(data) >= _HEADER.size else len(data)
        if not _HEADER.size <= length <= len(data):
            length = len(data)
        yield data[:length]
        data = data[length:]
