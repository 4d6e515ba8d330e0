"""CSR memory map of the Pro 4: addresses, scales, access.

Source: VideoRay, PRO4_CSR_memory_map.xls, revision 3; lowest byte first, two's complement. Where
it does not mark as read only what the device itself measures or counts (power manager, internal
temperatures, humidity, errors, run time, greatest values, terms of the controllers, magnetometer,
sensor status, copy of the version), it is read only here.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from seatrial.errors import InputError, unknown

DATA_FILES = ("registers.toml",)
COMMAND_END = 0x0F
"""Where the command block ends, which is most of the traffic."""
TOP = 0xF0
"""Where the special registers begin: what is below is one memory."""
OFF = 0xFFFF
"""A target of auto depth or auto heading that is none."""

CUSTOM_COMMAND = 0xF0
CONFIG_SIZE = 0xF5
CONFIG = 0xF7
FIRMWARE_VERSION = 0xF8
NODE_ID = 0xFB
GROUP_ID = 0xFC
SERIAL_NUMBER = 0xFD
UTILITY = 0xFE
COMMIT = 0xEE


@dataclass(frozen=True)
class Register:
    """One datum of the map: value = raw number times ``scale``, in ``unit``."""

    name: str
    address: int
    size: int
    signed: bool
    scale: float
    unit: str
    writable: bool
    stored: bool
    """Whether it outlives a reboot."""
    default: int
    """Raw number of the captured vehicle."""
    description: str

    @property
    def lowest(self) -> int:
        """The lowest raw number."""
        return -(1 << (8 * self.size - 1)) if self.signed else 0

    @property
    def highest(self) -> int:
        """The highest raw number."""
        return (1 << (8 * self.size - self.signed)) - 1

    def bytes_of(self, raw: int) -> bytes:
        """Return a raw number's bytes. Raises InputError for one that does not fit."""
        if not self.lowest <= raw <= self.highest:
            raise InputError(f"{self.name}: {raw} is not from {self.lowest} to {self.highest}")
        return raw.to_bytes(self.size, "little", signed=self.signed)

    def raw_in(self, memory: bytes | bytearray) -> int:
        """Return the raw number that a memory has."""
        own = memory[self.address : self.address + self.size]
        return int.from_bytes(own, "little", signed=self.signed)

    def clipped(self, value: float) -> int:
        """Return the raw number nearest to a value that this register can hold."""
        return min(max(round(value / self.scale), self.lowest), self.highest)


def _many(
    names: str,
    address: int,
    kind: str,
    scale: float = 1.0,
    unit: str = "1",
    *,
    access: str = "r",
    default: Iterable[int] = (),
    note: str = "",
) -> list[Register]:
    """Return registers that follow each other; ``access``: r, rw, or rws for stored ones."""
    size, signed = int(kind[1:]) // 8, kind[0] == "i"
    listed = names.split()
    defaults = [*default] or [0] * len(listed)
    return [
        Register(
            name,
            address + number * size,
            size,
            signed,
            scale,
            unit,
            "w" in access,
            "s" in access,
            raw,
            note,
        )
        for number, (name, raw) in enumerate(zip(listed, defaults, strict=True))
    ]


_ROWS = tomllib.loads(Path(__file__).with_name("registers.toml").read_text("utf-8"))["registers"]
REGISTERS = tuple(register for row in _ROWS for register in _many(**row))
"""All data of the map below 0xF0, in its order. Bytes without one are plain memory."""

BY_NAME = {register.name: register for register in REGISTERS}

WRITABLE = bytes(
    all(r.writable for r in REGISTERS if r.address <= a < r.address + r.size) for a in range(TOP)
)
"""1 for each address below 0xF0 that a request may write."""
STORED = tuple(a for r in REGISTERS if r.stored for a in range(r.address, r.address + r.size))
"""Addresses that outlive a reboot."""


def factory_memory() -> bytearray:
    """Return the memory below 0xF0 of a new vehicle."""
    memory = bytearray(TOP)
    for register in REGISTERS:
        put(memory, register.name, register.default)
    return memory


def put(memory: bytearray, name: str, raw: int) -> None:
    """Set a register to a raw number. Raises InputError for one that does not fit."""
    register = BY_NAME[name]
    memory[register.address : register.address + register.size] = register.bytes_of(raw)


def value(memory: bytes | bytearray, name: str) -> float:
    """Return a register's value in its unit."""
    register = BY_NAME[name]
    return register.raw_in(memory) * register.scale


def read_settings(text: str) -> dict[str, int]:
    """Return raw numbers by register from ``NAME VALUE; NAME VALUE``, values in their units.

    Raises InputError for what is not a stored register or does not fit.
    """
    found = {}
    for entry in filter(None, map(str.strip, text.split(";"))):
        name, _, written = entry.partition(" ")
        known = [r.name for r in REGISTERS if r.stored]
        if name not in known:
            raise InputError(unknown("stored register", name, known))
        register = BY_NAME[name]
        try:
            raw = round(float(written) / register.scale)
        except (ValueError, OverflowError):
            raise InputError(f"{name}: a number is needed, found {written!r}") from None
        register.bytes_of(raw)
        found[name] = raw
    return found


GAINS: dict[str, dict[str, int]] = {
    "captured": {},
    "holding": {
        **dict(zip((f"auto_depth_{x}" for x in "pidk"), (-1000, -1, -12000, 1000), strict=True)),
        **dict(zip((f"auto_heading_{x}" for x in "pidk"), (410, 12, 6400, 100), strict=True)),
        **{f"{name}_slew_rate": 10000 for name in ("port", "starboard", "vertical")},
    },
}
"""Raw numbers by register, where they differ from the captured vehicle's.

With the capture's slew of 0.005 per loop of 0.1 s it takes 20 s to full thrust, and oscillates.
``holding`` is ours, for the vehicle videoray: the natural frequencies are 1.4 rad/s in depth and
1.1 rad/s in heading, and the slew is no limit.
"""
