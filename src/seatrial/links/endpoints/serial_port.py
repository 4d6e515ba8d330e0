"""Serial ports."""

from __future__ import annotations

import time
from collections.abc import Sequence

import serial

from ...errors import InputError
from .descriptor import DescriptorEndpoint
from .endpoint import Channel

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
