"""A pseudo-terminal: a serial port with this program in the place of a device. POSIX only."""

from __future__ import annotations

import os
import tty
from collections.abc import Sequence

from ..mavlink.endpoint import LARGEST_DATAGRAM, Channel, Endpoint

LONGEST_QUEUE = 1 << 16
"""Bytes kept for somebody who does not read; what comes beyond is lost."""


class _End(Channel):
    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._queue = bytearray()

    def send(self, data: bytes) -> None:
        if len(self._queue) + len(data) <= LONGEST_QUEUE:
            self._queue += data
            self.flush()

    def flush(self) -> None:
        """Write what the terminal takes now."""
        try:
            while self._queue:
                del self._queue[: os.write(self._descriptor, self._queue)]
        except BlockingIOError:
            pass


class PseudoTerminal(Endpoint):
    """One end of a new pseudo-terminal; ``url`` is the device that others open."""

    def __init__(self) -> None:
        self._own, self._other = os.openpty()  # the other stays open: whoever has it may go
        tty.setraw(self._other)
        os.set_blocking(self._own, False)
        self.url = os.ttyname(self._other)
        self._peers = [_End(self._own)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer, whether anybody has opened the device or not."""
        return self._peers

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived."""
        self._peers[0].flush()
        try:
            data = os.read(self._own, LARGEST_DATAGRAM)
        except BlockingIOError:
            return []
        return [(self._peers[0], data)] if data else []

    def close(self) -> None:
        """Close both ends."""
        os.close(self._own)
        os.close(self._other)
