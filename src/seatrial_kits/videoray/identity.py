"""Identity of a Pro 4: serial number, firmware, boards; and its configuration data.

Source: VideoRay, PRO4_Hardware_Config.txt and VideoRay_Bootloader_Technical_info.txt.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from seatrial.errors import InputError

PRO4_ROV = 1
"""Type of device."""
SERIAL_LENGTH = 16
BOARD_LENGTH = 32
BOARDS = (
    "cpu",
    "power",
    "pressure",
    "camera_io",
    "camera",
    "lights",
    "horizontal_thruster",
    "vertical_thruster",
)
"""What the configuration names the revision of, in its order."""

_BOOTLOADER = struct.Struct("<HH16s8s4s")
_VALID = bytes.fromhex("600df00d")
"""Marks the firmware as valid."""
CONFIG_LENGTH = _BOOTLOADER.size + 4 + BOARD_LENGTH * len(BOARDS)


@dataclass(frozen=True)
class Identity:
    """Content of the configuration registers."""

    serial_number: str
    boards: tuple[str, ...]
    """One revision for each of `BOARDS`."""
    firmware: tuple[int, int, int]

    @property
    def unique_id(self) -> bytes:
        """The serial number as its register has it, 16 bytes."""
        return self.serial_number.encode().ljust(SERIAL_LENGTH, b"\0")

    @property
    def config(self) -> bytes:
        """The configuration data: of the bootloader, 32 bytes, and of the hardware, 260."""
        boot = _BOOTLOADER.pack(1, PRO4_ROV, self.unique_id, b"", _VALID)
        names = [name.encode().ljust(BOARD_LENGTH, b"\0") for name in self.boards]
        return boot + struct.pack("<I", 1) + b"".join(names)


def make_identity(serial_number: str, boards: str, firmware: str) -> Identity:
    """Return an identity from texts: boards separated by spaces, a version such as 2.6.6.

    Raises InputError for a text that is too long or not ASCII, too few boards, no version.
    """
    _fits("serial_number", serial_number, SERIAL_LENGTH)
    names = boards.split()
    if len(names) != len(BOARDS):
        raise InputError(f"boards: {len(BOARDS)} names are needed ({', '.join(BOARDS)})")
    for name in names:
        _fits("boards", name, BOARD_LENGTH)
    parts = firmware.split(".")
    if len(parts) != 3 or not all(p.isascii() and p.isdigit() and int(p) < 256 for p in parts):
        raise InputError(f"firmware: a version such as 2.6.6 is needed, found {firmware!r}")
    major, minor, patch = map(int, parts)
    return Identity(serial_number, tuple(names), (major, minor, patch))


def read_config(data: bytes) -> tuple[str, dict[str, str]]:
    """Return serial number and boards from configuration data; raises InputError if it is none."""
    if len(data) < CONFIG_LENGTH:
        raise InputError(f"configuration data has {len(data)} bytes, {CONFIG_LENGTH} are needed")
    serial = _text(_BOOTLOADER.unpack_from(data)[2])
    first = _BOOTLOADER.size + 4
    places = range(first, CONFIG_LENGTH, BOARD_LENGTH)
    names = [_text(data[place : place + BOARD_LENGTH]) for place in places]
    return serial, dict(zip(BOARDS, names, strict=True))


def _text(data: bytes) -> str:
    return data.split(b"\0")[0].decode("ascii", "replace")


def _fits(key: str, text: str, longest: int) -> None:
    if not text.isascii() or not text.isprintable() or len(text) > longest:
        raise InputError(f"{key}: {text!r} is not up to {longest} ASCII characters")
