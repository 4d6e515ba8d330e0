"""Serial ports."""

from __future__ import annotations

from collections.abc import Sequence

import serial

from ...errors import InputError
from .descriptor import DescriptorChannel
from .endpoint import LARGEST_DATAGRAM, Channel, Endpoint

LONGEST_QUEUE = 1 << 14
"""Bytes kept for a line that is too slow; frames beyond are lost."""


class SerialEndpoint(Endpoint):
    """A serial port with one peer, 8 bits, no parity, one stop bit. POSIX only.

    Raises InputError for a device that cannot be opened.
    """

    def __init__(self, url: str, device: str, baud: int) -> None:
        try:
            self._serial = serial.Serial(device, baud, timeout=0, write_timeout=0, exclusive=True)
        except (OSError, ValueError) as error:
            raise InputError(f"cannot open the link {url!r}: {error}") from None
        self.url = url
        self._peers = [DescriptorChannel(self._serial.fileno(), LONGEST_QUEUE)]

    def channels(self) -> Sequence[Channel]:
        """Return the one peer."""
        return self._peers

    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived."""
        self._peers[0].flush()
        try:
            data = self._serial.read(LARGEST_DATAGRAM)
        except (OSError, serial.SerialException):
            return []
        return [(self._peers[0], data)] if data else []

    def close(self) -> None:
        """Close the port."""
        self._serial.close()
