"""Bytes in String ports: the codec between components that exchange serial bytes or frames.

FMI 2 has no binary type, so bytes cross as text, each chunk with the simulated time at which it
was sent, in whole nanoseconds. A port holds its last value for ever: a sequence number before
the chunks tells a reader new from old. The text is

    SEQUENCE;TIME:BASE64;TIME:BASE64;...

with decimal numbers and standard base64, for example ``3;1500000000:JEhFSERULA==``. The empty
text is a port nothing was ever sent through (sequence 0). Chunks are opaque: serial bytes as
they are, or one bus operation each.

Both ends must step equally: a reader that sees every value misses no number.

FMI 3.0 has a binary type: there the same is packed, see `packed`.
"""

from __future__ import annotations

import binascii
import re
import struct
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

from ..errors import InputError, SimulationError

Chunk = tuple[int, bytes]
"""Simulated time, ns, and bytes."""

_NUMBER = re.compile(r"0|[1-9][0-9]{0,19}")
_HEAD = struct.Struct("<Q")
_CHUNK = struct.Struct("<QI")
_PART = re.compile(rf"({_NUMBER.pattern}):([A-Za-z0-9+/=]*)")


def encode(sequence: int, chunks: Iterable[Chunk]) -> str:
    """Return the text for ``chunks``, (time in ns, bytes) each, under number ``sequence``.

    Raises InputError for a negative sequence or time.
    """
    if sequence < 0:
        raise InputError(f"a sequence number cannot be negative: {sequence}")
    return ";".join([str(sequence), *(chunk(time_ns, data) for time_ns, data in chunks)])


def chunk(time_ns: int, data: bytes) -> str:
    """Return one chunk's part of a text. Raises InputError for a negative time."""
    if time_ns < 0:
        raise InputError(f"the time of a chunk cannot be negative: {time_ns} ns")
    return f"{time_ns}:{binascii.b2a_base64(data, newline=False).decode()}"


def decode(text: str) -> tuple[int, list[Chunk]]:
    """Return the sequence number and chunks of a port's text; (0, []) for the empty text.

    Raises InputError, showing where, if the text is not what `encode` writes.
    """
    if not text:
        return 0, []
    head, *parts = text.split(";")
    if not _NUMBER.fullmatch(head):
        raise _refused(text)
    return int(head), [_chunk(part) for part in parts]


def packed(text: str) -> bytes:
    """Return what a Binary of FMI 3.0 has for a port's text; nothing for the empty text.

    Least byte first: the sequence number (8 bytes), then of each chunk its time in ns (8), its
    length (4) and its bytes. Raises InputError as `decode`.
    """
    if not text:
        return b""
    sequence, chunks = decode(text)
    return _HEAD.pack(sequence) + b"".join(
        _CHUNK.pack(time_ns, len(data)) + data for time_ns, data in chunks
    )


def unpacked(content: bytes) -> str:
    """Return the text of what `packed` made. Raises InputError for anything else."""
    if not content:
        return ""
    try:
        (sequence,), place, chunks = _HEAD.unpack_from(content), _HEAD.size, []
        while place < len(content):
            time_ns, size = _CHUNK.unpack_from(content, place)
            place += _CHUNK.size + size
            chunks.append((time_ns, content[place - size : place]))
    except struct.error as error:
        raise InputError(f"{len(content)} bytes are no chunks: {error}") from None
    if place != len(content):
        raise InputError(f"{len(content)} bytes are no chunks: the last one has more")
    return encode(sequence, chunks)


@lru_cache(4096)  # what a bus sends is read by many
def _chunk(part: str) -> Chunk:
    match = _PART.fullmatch(part)
    if match is None:
        raise _refused(part)
    try:
        return int(match[1]), binascii.a2b_base64(match[2], strict_mode=True)
    except binascii.Error as error:
        raise InputError(f"{_shown(match[2])} in a bytes text is not base64: {error}") from None


def _refused(text: str) -> InputError:
    return InputError(
        f"{_shown(text)} is not a bytes text such as '3;1500000000:SGVsbG8=' "
        "(SEQUENCE;TIME in ns:BASE64;...)"
    )


class Outbox:
    """The sending end of a String port: numbers what is sent.

    ``memory`` is a dict that belongs to the component's state, empty at the start; the box is
    only a view of it and need not be kept.
    """

    def __init__(self, memory: dict[str, Any]) -> None:
        self._memory = memory
        memory.setdefault("sequence", 0)
        memory.setdefault("waiting", [])
        memory.setdefault("text", "")

    @property
    def text(self) -> str:
        """Text of the port: as of the last `flush`."""
        text: str = self._memory["text"]
        return text

    def put(self, time_ns: int, data: bytes) -> None:
        """Add bytes sent at simulated time ``time_ns`` (ns, not negative) to what waits."""
        # As text already: bytes are not plain data of a component's state.
        self.put_chunk(chunk(time_ns, data))

    def put_chunk(self, written: str) -> None:
        """Add what `chunk` returned: it may go to several boxes."""
        self._memory["waiting"].append(written)

    def flush(self) -> str:
        """Publish what waits under a new number, once at the end of a step; return `text`.

        With nothing waiting the port keeps what it holds.
        """
        memory = self._memory
        if memory["waiting"]:
            memory["sequence"] += 1
            memory["text"] = ";".join([str(memory["sequence"]), *memory["waiting"]])
            memory["waiting"] = []
        return self.text


class Inbox:
    """The receiving end of a String port: gives each text's chunks once.

    ``memory`` is a dict that belongs to the component's state, empty at the start.
    """

    def __init__(self, memory: dict[str, Any]) -> None:
        self._memory = memory
        memory.setdefault("sequence", 0)

    def take(self, text: str) -> list[Chunk]:
        """Return the chunks of a port's text that are new, [] if it is the text before.

        Raises InputError if the text is malformed, SimulationError if a number was missed or
        numbers run backwards: sender and reader do not step equally, or one was rolled back
        without the other.
        """
        last = self._memory["sequence"]
        if text.partition(";")[0] == str(last):
            return []  # most steps bring nothing: decode nothing
        sequence, chunks = decode(text)
        if sequence == last:
            return []
        if sequence != last + 1:
            raise SimulationError(
                f"bytes were lost: text number {sequence} came after number {last}; both ends of "
                "a bytes connection must step equally"
            )
        self._memory["sequence"] = sequence
        return chunks


def _shown(text: str) -> str:
    return repr(text if len(text) <= 60 else f"{text[:57]}...")
