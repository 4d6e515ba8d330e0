"""Device specific replies of the Pro 4, 1 to 5.

Source: VideoRay, pro4_specific_response.h and "PRO4 application layer"; on the line a real vehicle
answers 1, an acknowledgement, with the four of 2. Reply 5 ends, other than the document's names
say, with humidity and water temperature: so the captured ones fit the memory read beside them.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from .registers import BY_NAME, value

ACKNOWLEDGE = 1
ATTITUDE = 2
ATTITUDE_TEMPERATURE = 3
ATTITUDE_HEALTH = 4
NAVIGATION = 5
"""What VideoRay's own topside requests."""

_ATTITUDE = ("heading", "pitch", "roll", "pressure")
_TEMPERATURE = ("water_temperature",)
_HUMIDITY = ("humidity",)
_ROTATION = ("yaw_acceleration", "pitch_acceleration", "roll_acceleration")
_LINEAR = ("surge_acceleration", "sway_acceleration", "heave_acceleration")
_MAGNETOMETER = ("magnetometer_x", "magnetometer_y", "magnetometer_z")

FIELDS: dict[int, tuple[str, ...]] = {
    ACKNOWLEDGE: _ATTITUDE,
    ATTITUDE: _ATTITUDE,
    ATTITUDE_TEMPERATURE: _ATTITUDE + _TEMPERATURE,
    ATTITUDE_HEALTH: _ATTITUDE + _TEMPERATURE + _HUMIDITY,
    NAVIGATION: (
        *_ATTITUDE,
        *_ROTATION,
        *_LINEAR,
        *_MAGNETOMETER,
        "attitude_status",
        *_HUMIDITY,
        *_TEMPERATURE,
        "total_power",
    ),
}
"""Registers of each reply, in its order: of 2 bytes each, but for the power at the end."""


@dataclass(frozen=True)
class Reading:
    """Content of a reply, or of a read of the whole memory: values by register, in its unit."""

    values: dict[str, float]


def payload(number: int, memory: bytes | bytearray) -> bytes | None:
    """Return a reply's bytes after the type of device; None for a number that has none."""
    if number not in FIELDS:
        return None
    registers = [BY_NAME[name] for name in FIELDS[number]]
    return b"".join(bytes(memory[r.address : r.address + r.size]) for r in registers)


def read(number: int, data: bytes) -> Reading | None:
    """Return the content of a reply's bytes after the type of device; None if they are none.

    Pressure is taken for signed here, as the reply has it.
    """
    names = FIELDS.get(number)
    if names is None:
        return None
    form = "<" + "".join("B" if name == "total_power" else "h" for name in names)
    if len(data) != struct.calcsize(form):
        return None
    raw = struct.unpack(form, data)
    return Reading({name: n * BY_NAME[name].scale for name, n in zip(names, raw, strict=True)})


def read_memory(address: int, data: bytes) -> Reading:
    """Return the registers that lie whole within a piece of memory read from ``address``."""
    memory = bytes(address) + data
    whole = [
        name
        for name, r in BY_NAME.items()
        if address <= r.address and r.address + r.size <= len(memory)
    ]
    return Reading({name: value(memory, name) for name in whole})
