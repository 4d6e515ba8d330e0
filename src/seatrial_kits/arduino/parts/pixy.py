"""Pixy (CMUcam5): object blocks of its serial protocol, which on I2C are read as a stream."""

from __future__ import annotations

import math
import struct

from ..part import I2CStream

PIXELS = 320
_SYNC = 0xAA55
_ROW = 100
_HEIGHT = 200


class Pixy(I2CStream):
    """What a camera detects, in pixels of 320 over its field of view."""

    ports = (
        "sight_frame",
        "sight_count",
        "sight_kind",
        "sight_bearing",
        "sight_size",
        "view_width",
    )
    begins = True

    def reset(self) -> None:
        """Begin with no frame."""
        self._frame = 0

    def begun(self, left: int) -> None:
        """Begin the frame that is there now, when the one before has been read.

        A master that is slow reads older blocks, never half of two.
        """
        frame = self.inputs["sight_frame"]
        if not left and frame != self._frame:
            self._frame = frame
            self.reply(self._blocks())

    def _blocks(self) -> bytes:
        """Return a frame: one sync more than it has blocks."""
        focal = PIXELS / 2.0 / math.tan(0.5 * self.inputs["view_width"])
        kinds, bearings, sizes = (
            self.inputs[name] for name in ("sight_kind", "sight_bearing", "sight_size")
        )
        count = min(max(self.inputs["sight_count"], 0), len(kinds))
        data = struct.pack("<H", _SYNC) if count else b""
        for kind, bearing, size in list(zip(kinds, bearings, sizes, strict=True))[:count]:
            x = PIXELS / 2.0 + focal * math.tan(min(max(bearing, -1.5), 1.5))
            width = 2.0 * focal * math.tan(0.5 * min(max(size, 0.0), 3.0))
            wide = _within(width, 1, PIXELS)
            words = (_within(kind, 1, 7), _within(x, 0, PIXELS - 1), _ROW, wide, min(wide, _HEIGHT))
            data += struct.pack("<7H", _SYNC, sum(words) & 0xFFFF, *words)
        return data


def _within(value: float, least: int, most: int) -> int:
    # Half away from zero, as C's lround has it.
    return min(max(math.floor(value + 0.5), least), most)
