"""Recorded streams: what a serial port received and sent, with the times.

    # seatrial stream 1
    0.100000000 > FAAF010100005500
    0.101050000 < FDDF010100092B01...

Simulated time in seconds at which the first byte begins; ``>`` for what goes to the device, ``<``
for what comes from it; bytes as hexadecimal numbers. Empty lines and those with # are comments.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple, TextIO

from seatrial.errors import InputError, SimulationError

HEAD = "# seatrial stream 1\n"
TO_DEVICE, FROM_DEVICE = ">", "<"
_LINE = re.compile(r"(\d{1,9})\.(\d{9}) ([<>]) ((?:[0-9A-Fa-f]{2})+)")
_NS = 1_000_000_000


class Piece(NamedTuple):
    """Bytes that went one way at a time, ns."""

    time_ns: int
    direction: str
    data: bytes


class StreamLog:
    """Writes a stream; what is written before it is opened is not kept.

    Times of one direction only grow: a step that is repeated after a rollback is written once.
    Raises SimulationError for a file that is there already or cannot be written.
    """

    def __init__(self) -> None:
        self._file: TextIO | None = None
        self._last = {TO_DEVICE: -1, FROM_DEVICE: -1}

    def open(self, folder: str, name: str) -> None:
        """Begin ``NAME.stream`` in a folder, once; an empty text is none."""
        if not folder or self._file is not None:
            return
        path = Path(folder, f"{name}.stream")
        try:
            # Line by line: whole up to the last piece if the process is killed.
            self._file = path.open("x", encoding="ascii", newline="\n", buffering=1)
            self._file.write(HEAD)
        except OSError as error:
            raise SimulationError(f"cannot write the stream {path}: {error.strerror}") from None

    def write(self, time_ns: int, direction: str, data: bytes) -> None:
        """Write a piece."""
        if self._file is None or time_ns <= self._last[direction]:
            return
        self._last[direction] = time_ns
        seconds, rest = divmod(time_ns, _NS)
        try:
            self._file.write(f"{seconds}.{rest:09} {direction} {data.hex().upper()}\n")
        except OSError as error:
            raise SimulationError(f"cannot write a stream: {error.strerror}") from None

    def close(self) -> None:
        """Close the file; a new one may be opened."""
        if self._file is not None:
            self._file.close()
        self._file = None


def read_stream(path: Path) -> Iterator[Piece]:
    """Yield the pieces of a recorded stream.

    Raises InputError, with file and line, for what is no stream.
    """
    try:
        with path.open(encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                if not line.strip() or line.startswith("#"):
                    continue
                match = _LINE.fullmatch(line.strip())
                if match is None:
                    raise InputError(
                        f"{path}:{number}: {line.strip()[:60]!r} is not a line such as "
                        "'0.100000000 > FAAF010100005500'"
                    )
                time_ns = int(match[1]) * _NS + int(match[2])
                yield Piece(time_ns, match[3], bytes.fromhex(match[4]))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: this is no recorded stream, but binary data") from None
