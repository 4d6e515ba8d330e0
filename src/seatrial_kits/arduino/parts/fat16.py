"""An empty FAT16 volume without a partition table. Microsoft, FAT: General Overview 1.03."""

from __future__ import annotations

import struct

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
