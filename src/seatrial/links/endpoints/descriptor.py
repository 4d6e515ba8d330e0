"""Channel at a file descriptor: a serial line, a terminal."""

from __future__ import annotations

import os
from collections.abc import Sequence

from .budget import Budget
from .endpoint import Channel, Endpoint


class DescriptorChannel(Channel):
    """Writes to a descriptor that does not block, and keeps at most ``longest`` bytes for it."""

    def __init__(self, descriptor: int, longest: int) -> None:
        self._descriptor, self._longest = descriptor, longest
        self._queue = bytearray()

    def send(self, data: bytes) -> None:
        """Send one frame; it is lost if it does not fit any more."""
        if len(self._queue) + len(data) <= self._longest:
            self._queue += data
            self.flush()

    def target(self) -> tuple[int, None]:
        """Return the descriptor."""
        return self._descriptor, None

    def flush(self) -> None:
        """Write what the line takes now."""
        try:
            while self._queue:
                # pyserial's write repeats itself for ever on a line that takes nothing.
                del self._queue[: os.write(self._descriptor, self._queue)]
        except BlockingIOError:
            pass
        except OSError:
            self._queue.clear()  # unplugged


class DescriptorEndpoint(Endpoint):
    """One peer at a descriptor. What one poll does not take in waits in the system's queue."""

    def __init__(self, descriptor: int, longest: int) -> None:
        self._descriptor, self.budget = descriptor, Budget()
        self._peers = [DescriptorChannel(descriptor, longest)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer, whether it is there or not."""
        return self._peers

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived."""
        peer = self._peers[0]
        peer.flush()
        self.budget.renew(self._peers)
        most = self.budget.left(peer)
        if not most:
            return []
        try:
            data = os.read(self._descriptor, most)
        except OSError:  # nothing there, or unplugged
            return []
        self.budget.take(peer, len(data))
        if len(data) == most:
            self.budget.exceed()
        return [(peer, data)] if data else []
