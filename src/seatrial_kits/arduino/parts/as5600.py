"""AS5600: angle of a magnet, contactless. ams DS000365."""

from __future__ import annotations

import math
from typing import ClassVar

from ..part import I2CRegisters, Register

_TURN = 4096
_MAGNET = 0x20
_ROUND = {0x0D: 0x0C, 0x0F: 0x0E, 0x1C: 0x1B}
"""Registers of two bytes whose pointer comes round."""


class As5600(I2CRegisters):
    """An ``angle``, rad, in 4096 counts a turn; ANGLE has the range that is programmed."""

    ports = ("angle",)
    registers: ClassVar = {
        "ZMCO": Register(0x00, access="r"),
        "ZPOS": Register(0x01, form="u16be", access="acts"),
        "MPOS": Register(0x03, form="u16be", access="acts"),
        "MANG": Register(0x05, form="u16be", access="acts"),
        "CONF": Register(0x07, form="u16be"),
        "STATUS": Register(0x0B, _MAGNET, access="r"),
        "RAW_ANGLE": Register(0x0C, form="u16be", access="r"),
        "ANGLE": Register(0x0E, form="u16be", access="r"),
        "AGC": Register(0x1A, 0x80, access="r"),
        "MAGNITUDE": Register(0x1B, 0x0800, "u16be", access="r"),
    }

    def advanced(self, pointer: int) -> int:
        """Return the next pointer."""
        return _ROUND.get(pointer, pointer + 1)

    def written(self, name: str, value: int) -> bool:
        """Scale by the range that is set now."""
        self.measure()
        return True

    def measure(self) -> None:
        """Fill both registers of the angle."""
        raw = round(self.inputs["angle"] / math.tau * _TURN) % _TURN
        self.put("RAW_ANGLE", raw)
        begin = self.get("ZPOS") % _TURN
        span = self.get("MANG") % _TURN or (self.get("MPOS") - begin) % _TURN or _TURN
        since = (raw - begin) % _TURN
        if since >= span:  # beyond the range: its nearer end
            since = span - 1 if since - span < _TURN - since else 0
        self.put("ANGLE", since * _TURN // span)
