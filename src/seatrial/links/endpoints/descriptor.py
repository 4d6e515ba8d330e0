"""Channel at a file descriptor: a serial line, a terminal."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Sequence

import serial

from ...errors import InputError
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

    def __init__(self) -> None:
        self.budget = Budget()

    def connect(self, descriptor: int, longest: int) -> None:
        """Let the peer be the one at a descriptor."""
        self._descriptor = descriptor
        self._peers = [DescriptorChannel(descriptor, longest)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer, whether it is there or not."""
        return self._peers

    def has_gone(self) -> bool:
        """Return whether the other end is gone: unplugged, or closed."""
        waiting = select.poll()
        waiting.register(self._descriptor, 0)
        return bool(waiting.poll(0))

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


LONGEST_QUEUE = 1 << 14
"""Bytes kept for a line that is too slow; frames beyond are lost."""
RETRY_S = 1.0
"""Wall time between two attempts to open a port that was unplugged."""


class SerialEndpoint(DescriptorEndpoint):
    """A serial port with one peer, 8 bits, no parity, one stop bit. POSIX only.

    A port that is unplugged is lost: it has no peer, and is opened again when ``device`` is there
    again. The number of a pseudo-terminal names nothing for long: ``/dev/pts/N`` stays lost.

    Raises InputError for a device that cannot be opened.
    """

    def __init__(self, url: str, device: str, baud: int) -> None:
        super().__init__()
        self.url, self._device, self._baud = url, device, baud
        try:
            self._open()
        except (OSError, ValueError) as error:
            raise InputError(f"cannot open the link {url!r}: {error}") from None

    def channels(self) -> Sequence[Channel]:
        """Return the peer, unless the port is unplugged."""
        return [] if self.is_lost else super().channels()

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived; notice that the port is unplugged, or there again."""
        if self.is_lost:
            self._reopen()
        elif self.has_gone():
            self.is_lost, self._tried = True, time.monotonic()
            self._serial.close()
        return [] if self.is_lost else super().poll()

    def close(self) -> None:
        """Close the port."""
        self._serial.close()

    # ------------------------------------------------------------------ inside

    def _open(self) -> None:
        self._serial = serial.Serial(
            self._device, self._baud, timeout=0, write_timeout=0, exclusive=True
        )
        self.connect(self._serial.fileno(), LONGEST_QUEUE)

    def _reopen(self) -> None:
        now = time.monotonic()
        if now < self._tried + RETRY_S or self._device.startswith("/dev/pts/"):
            return
        self._tried = now
        try:
            self._open()
        except (OSError, ValueError):
            return
        self.is_lost = False
        self.reconnections += 1
