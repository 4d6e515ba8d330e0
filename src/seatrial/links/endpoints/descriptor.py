"""Channel at a file descriptor: a serial line, a terminal."""

from __future__ import annotations

import os

from .endpoint import Channel


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
