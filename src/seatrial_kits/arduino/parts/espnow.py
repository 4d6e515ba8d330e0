"""ESP-NOW of an ESP32: its frames on ports of the rig. Espressif's ESP-IDF programming guide."""

from __future__ import annotations

from ..part import UartPart

CHANNEL = 2
"""Of messages: see ``machine/machine.h``."""


class EspNow(UartPart):
    """Frames are ``tx`` and ``rx`` of the line of its place, ``uart3``, a chunk of bytes each.

    A frame is 6 bytes of destination, 6 of source, and up to 250 of data. Who is connected receives
    all: addresses are not compared, and each frame counts as acknowledged.
    """

    def reset(self) -> None:
        """Take the line of its place."""
        self.line = self.places[0]

    def sent(self, time: float, frame: bytes) -> None:
        """Take a frame of the board."""
        self.packets.append((time, frame))

    def arrived(self, time: float, data: bytes) -> None:
        """Give the board a frame."""
        self._records.put_message(CHANNEL, data)
