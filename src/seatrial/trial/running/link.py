"""One end of a socket between two processes that trust each other; frames are lines of JSON."""

from __future__ import annotations

import json
import socket
from contextlib import suppress
from typing import Any

_MOST_BYTES = 1 << 16

Frame = list[Any]
"""What crosses in one piece: a kind and its arguments."""


class Link:
    """Sends and receives frames through one end of a socket."""

    def __init__(self, end: socket.socket) -> None:
        self._end, self._unread = end, b""

    def fileno(self) -> int:
        """Return the descriptor to wait at."""
        return self._end.fileno()

    def send(self, *frame: Any) -> None:
        """Send a frame; nothing happens if the other process is gone."""
        with suppress(ConnectionError):
            self._end.sendall(json.dumps(frame).encode() + b"\n")

    def receive(self) -> list[Frame] | None:
        """Wait for more, and return the frames that are whole; None at the end."""
        try:
            data = self._end.recv(_MOST_BYTES)
        except ConnectionError:
            return None
        *lines, self._unread = (self._unread + data).split(b"\n")
        return [json.loads(line) for line in lines] if data else None

    def close(self) -> None:
        """Close this end."""
        self._end.close()
