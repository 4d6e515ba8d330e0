"""A board's EEPROM as a file: its bytes from address 0 on."""

from __future__ import annotations

from pathlib import Path

from seatrial.errors import InputError

from .mcus import Mcu

ERASED = 0xFF


def read_eeprom(file: str, mcu: Mcu) -> bytearray:
    """Return the whole EEPROM of ``mcu``: a file's bytes, then erased ones.

    Raises InputError for a file that cannot be read or is larger.
    """
    try:
        given = Path(file).expanduser().read_bytes() if file else b""
    except OSError as error:
        raise InputError(f"eeprom: {file}: cannot be read: {error.strerror}") from None
    if len(given) > mcu.eeprom:
        raise InputError(
            f"eeprom: {file} has {len(given)} bytes, the EEPROM of the {mcu.board} {mcu.eeprom}: "
            "plain bytes are needed (avr-objcopy -I ihex -O binary turns a .eep into them)"
        )
    return bytearray(given.ljust(mcu.eeprom, bytes([ERASED])))


def write_eeprom(file: str, data: bytearray) -> None:
    """Write an EEPROM to a file. Raises InputError if that cannot be."""
    try:
        Path(file).expanduser().write_bytes(data)
    except OSError as error:
        raise InputError(f"eeprom_after: {file}: cannot be written: {error.strerror}") from None
