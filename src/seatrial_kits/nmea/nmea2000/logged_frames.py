"""Frames of a CAN bus from logs: candump's text, and Vector's .blf, which python-can reads."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import can

from seatrial.errors import InputError
from seatrial_kits.can.frame import Frame

LINE = re.compile(
    r"\s*\((?P<time>\d+\.\d+)\)\s+\S+\s+(?:[TR]X?\s+[-B]*\s*)?(?P<id>[0-9A-Fa-f]{3}(?:[0-9A-Fa-f]{5})?)"
    r"(?:#(?P<data>(?:[0-9A-Fa-f]{2}){0,8})|\s+\[\d\]\s+(?P<bytes>(?:[0-9A-Fa-f]{2}(?:\s+|$)){0,8}))"
)
"""As ``candump -L`` and ``candump -ta`` write a frame."""
VECTOR = b"LOGG"


def logged_frames(path: Path, skipped: Counter[str]) -> Iterator[tuple[int, float, Frame]]:
    """Yield line or number, time in s, and frame, of those with 29 bits of identifier.

    Lines that are no frame are counted in ``skipped``. Raises InputError for a .blf that cannot be
    read.
    """
    with path.open("rb") as file:
        is_vector = file.read(len(VECTOR)) == VECTOR
    return _blf(path) if is_vector else _candump(path, skipped)


def _candump(path: Path, skipped: Counter[str]) -> Iterator[tuple[int, float, Frame]]:
    with path.open(encoding="latin-1") as file:
        for row, line in enumerate(file, 1):
            found = LINE.match(line)
            if found is not None and len(found["id"]) == 8:
                data = found["data"] if found["data"] is not None else found["bytes"]
                identifier = int(found["id"], 16)
                if identifier < 1 << 29:
                    yield (
                        row,
                        float(found["time"]),
                        Frame(identifier, bytes.fromhex(data), extended=True),
                    )
            elif found is None and line.strip():
                skipped["lines that are no frame are skipped"] += 1


def _blf(path: Path) -> Iterator[tuple[int, float, Frame]]:
    try:
        with can.BLFReader(str(path)) as reader:
            for row, entry in enumerate(reader, 1):
                if entry.is_extended_id and not (entry.is_remote_frame or entry.is_error_frame):
                    data = bytes(entry.data)
                    yield row, entry.timestamp, Frame(entry.arbitration_id, data, extended=True)
    except Exception as error:  # whatever python-can makes of bytes that are no log
        raise InputError(f"{path}: no log of Vector: {error}") from None
