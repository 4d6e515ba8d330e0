"""SD card at the SPI. SD Association, Physical Layer Simplified Specification 6.00, chapter 7."""

from __future__ import annotations

import struct
from pathlib import Path

from seatrial.errors import InputError

from ..part import SpiPart

_IDLE, _ILLEGAL, _OUT_OF_RANGE = 0x01, 0x04, 0x40
_TOKEN, _MANY_TOKEN, _STOP_TOKEN, _ACCEPTED = 0xFE, 0xFC, 0xFD, 0x05
_FILL = b"\xff"
_CRC = b"\xff\xff"
_OCR = b"\xc0\xff\x80\x00"
_CID = b"\x00STSIMSD\x10\x00\x00\x00\x01\x01\x5a\x01"


class SdCard(SpiPart):
    """A high-capacity card, addressed by sectors: the image ``card``, or an empty FAT16 of 32 MiB.

    What it holds at the end goes to ``card_after``. Checks of commands and data are not examined.
    """

    ports = ("card", "card_after")

    def reset(self) -> None:
        """Begin before the card is initialised."""
        self._sectors: dict[int, bytes] = {}
        self._count, self._loaded = SECTORS, False
        self._idle, self._application = True, False
        self._command = bytearray()
        self._writing = self._reading = -1
        self._many, self._data = False, False

    def measure(self) -> None:
        """Read the image, once. Raises InputError for one that cannot be read."""
        if self._loaded:
            return
        self._loaded = True
        if not self.inputs["card"]:
            self._sectors = empty_volume()
            return
        try:
            image = Path(self.inputs["card"]).expanduser().read_bytes()
        except OSError as error:
            raise InputError(f"card: {self.inputs['card']}: {error.strerror}") from None
        self._count = -(-len(image) // SECTOR)
        for number in range(self._count):
            data = image[number * SECTOR : (number + 1) * SECTOR]
            if any(data):
                self._sectors[number] = data.ljust(SECTOR, b"\0")

    def end(self) -> None:
        """Write the image."""
        if not self._loaded or not self.inputs["card_after"]:
            return
        empty = bytes(SECTOR)
        image = b"".join(self._sectors.get(number, empty) for number in range(self._count))
        try:
            Path(self.inputs["card_after"]).expanduser().write_bytes(image)
        except OSError as error:
            raise InputError(f"card_after: {self.inputs['card_after']}: {error.strerror}") from None

    # ------------------------------------------------------------------ bytes

    def selected(self) -> None:
        """Begin anew with the next byte."""
        self._command.clear()

    def exchange(self, sent: bytes) -> bytes:
        """Take in commands and data; return what answers them."""
        if self._data:
            return self._store(sent)
        answer = b""
        for byte in sent:
            if self._writing >= 0 and not self._command and byte in (_TOKEN, _MANY_TOKEN):
                self._data = True
                return _FILL * (SECTOR + len(_CRC))
            if self._writing >= 0 and not self._command and byte == _STOP_TOKEN:
                self._writing = -1
                return b"\x00" + _FILL
            if self._command or byte & 0xC0 == 0x40:
                self._command.append(byte)
            if len(self._command) == 6:
                answer += _FILL + self._answered(*struct.unpack(">BIB", bytes(self._command)))
                self._command.clear()
        if not answer and self._many and self._reading >= 0 and not self._command:
            answer = self._block()
        return answer or _FILL

    def _store(self, sent: bytes) -> bytes:
        self._data = False
        self._sectors[self._writing] = sent[:SECTOR].ljust(SECTOR, _FILL)
        self._writing = self._writing + 1 if self._many else -1
        return bytes([_ACCEPTED, 0x00]) + _FILL

    def _block(self) -> bytes:
        data = self._sectors.get(self._reading, bytes(SECTOR))
        self._reading += 1
        return _FILL + bytes([_TOKEN]) + data + _CRC

    # ------------------------------------------------------------------ commands

    def _answered(self, first: int, argument: int, _: int) -> bytes:
        number, application, self._application = first & 0x3F, self._application, False
        status = bytes([_IDLE if self._idle else 0])
        if application:
            if number == 41:
                ready, self._idle = not self._idle, False
                return b"\x00" if ready else bytes([_IDLE])
            return status  # ACMD23 and others change nothing
        if number == 0:
            self._idle, self._writing, self._reading = True, -1, -1
            return bytes([_IDLE])
        if number == 8:
            return status + struct.pack(">I", argument & 0xFFF)
        if number == 58:
            return status + _OCR
        if number == 55:
            self._application = True
            return status
        return self._transferring(number, argument, status)

    def _transferring(self, number: int, argument: int, status: bytes) -> bytes:
        if number in (17, 18, 24, 25) and argument >= self._count:
            return bytes([_OUT_OF_RANGE])
        if number in (17, 18):
            self._many, self._reading = number == 18, argument
            return status + self._block()
        if number in (24, 25):
            self._many, self._writing = number == 25, argument
            return status
        if number in (9, 10):
            register = _CID if number == 10 else self._csd()
            return status + _FILL + bytes([_TOKEN]) + register + _CRC
        if number == 12:
            self._many, self._reading = False, -1
            return _FILL + b"\x00"
        if number == 13:
            return status + b"\x00"
        return status if number in (16, 32, 33, 38, 59) else bytes([status[0] | _ILLEGAL])

    def _csd(self) -> bytes:
        """Return the register of card-specific data, version 2: its size in units of 512 KiB."""
        size = max(self._count // 1024 - 1, 0)
        return (
            b"\x40\x0e\x00\x32\x5b\x59\x00" + size.to_bytes(3, "big") + b"\x7f\x80\x0a\x40\x00\x01"
        )


SECTOR = 512
SECTORS = 65536
_PER_CLUSTER, _FATS, _FAT_SECTORS, _ROOT_ENTRIES, _RESERVED = 4, 2, 64, 512, 1
_MEDIA = 0xF8


def empty_volume() -> dict[int, bytes]:
    """Return the sectors that are not zero, by number: 32 MiB, clusters of 2 KiB."""
    boot = struct.pack(
        "<3s8sHBHBHHBHHHII",
        b"\xeb\x3c\x90",
        b"MSDOS5.0",
        SECTOR,
        _PER_CLUSTER,
        _RESERVED,
        _FATS,
        _ROOT_ENTRIES,
        0,  # sectors, in the field of 32 bits
        _MEDIA,
        _FAT_SECTORS,
        63,
        255,
        0,
        SECTORS,
    ) + struct.pack("<BBBI11s8s", 0x80, 0, 0x29, 1, b"SEATRIAL   ", b"FAT16   ")
    sectors = {0: boot.ljust(SECTOR - 2, b"\0") + b"\x55\xaa"}
    begin = struct.pack("<HH", 0xFF00 | _MEDIA, 0xFFFF).ljust(SECTOR, b"\0")
    for fat in range(_FATS):
        sectors[_RESERVED + fat * _FAT_SECTORS] = begin
    return sectors
