"""Servo packets that ArduPilot's simulated firmware sends: little-endian, 16 or 32 channels."""

from __future__ import annotations

import struct
from dataclasses import dataclass

CHANNELS = {18458: 16, 29569: 32}
"""Output channels by the magic number that a packet begins with."""
MOST_CHANNELS = 32
_HEAD = struct.Struct("<HHI")


@dataclass(frozen=True)
class Frame:
    """One packet: frames per second that the firmware expects, its number, pulses in us."""

    rate: int
    count: int
    pwm: tuple[int, ...]


def read_frame(data: bytes) -> Frame | None:
    """Return the packet in a datagram, None if it is of something else."""
    if len(data) < _HEAD.size:
        return None
    magic, rate, count = _HEAD.unpack_from(data)
    channels = CHANNELS.get(magic)
    if channels is None or len(data) != _HEAD.size + 2 * channels:
        return None
    return Frame(rate, count, struct.unpack_from(f"<{channels}H", data, _HEAD.size))
