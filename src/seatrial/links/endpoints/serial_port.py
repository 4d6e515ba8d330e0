"""Serial ports."""

from __future__ import annotations

import serial

from ...errors import InputError
from .descriptor import DescriptorEndpoint

LONGEST_QUEUE = 1 << 14
"""Bytes kept for a line that is too slow; frames beyond are lost."""


class SerialEndpoint(DescriptorEndpoint):
    """A serial port with one peer, 8 bits, no parity, one stop bit. POSIX only.

    Raises InputError for a device that cannot be opened.
    """

    def __init__(self, url: str, device: str, baud: int) -> None:
        try:
            self._serial = serial.Serial(device, baud, timeout=0, write_timeout=0, exclusive=True)
        except (OSError, ValueError) as error:
            raise InputError(f"cannot open the link {url!r}: {error}") from None
        self.url = url
        super().__init__(self._serial.fileno(), LONGEST_QUEUE)

    def close(self) -> None:
        """Close the port."""
        self._serial.close()
