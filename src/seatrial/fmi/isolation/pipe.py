"""Protocol of the pipes to the process of an isolated component: frames, and values in them.

A frame is a header (length of the payload, code, number) and its payload. Nothing here can make
its reader run code: values are packed by types that both sides know, the rest is JSON.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from operator import index
from typing import Any

CALL, WRITE, READ, STEP = 1, 2, 3, 4
"""Requests: a call in JSON; values to a writer, which nothing answers; a reader; a step."""
RESULT, FAILURE, MESSAGE = 5, 6, 7
"""Answers: a result; an error in JSON; a log message, whose number is its level."""

MOST_BYTES = 1 << 16
"""What one read from a pipe takes."""
LARGEST = 1 << 30
"""Bytes of a payload."""
INTERVAL = struct.Struct("<dd")
"""Begin and length of a step, s."""
ENDED = struct.Struct("<d")
"""First in the answer of a step: when the component asked to end the simulation, s; or NaN."""

Frame = tuple[int, int, bytes]
"""Code, number and payload."""

_CODES: dict[type, str] = {float: "d", bool: "?"}
_HEADER = struct.Struct("<IHI")


def frame(code: int, number: int = 0, payload: bytes = b"") -> bytes:
    """Return a frame's bytes."""
    return _HEADER.pack(len(payload), code, number) + payload


class Frames:
    """Takes bytes as they arrive, and gives whole frames."""

    def __init__(self) -> None:
        self._data = b""

    def feed(self, data: bytes) -> None:
        """Add bytes."""
        self._data += data

    def take(self) -> Frame | None:
        """Return the next frame, None until the rest of it has arrived.

        Raises ValueError for what is no frame.
        """
        data = self._data
        if len(data) < _HEADER.size:
            return None
        length, code, number = _HEADER.unpack_from(data)
        if not CALL <= code <= MESSAGE:
            raise ValueError(f"a frame has no code {code}")
        if length > LARGEST:
            raise ValueError(f"a frame of {length} bytes")
        end = _HEADER.size + length
        if len(data) < end:
            return None
        self._data = data[end:]
        return code, number, data[_HEADER.size : end]


class Codec:
    """Packs values of known types: real numbers bit by bit, Booleans, and the rest by length."""

    def __init__(self, kinds: Sequence[type]) -> None:
        self._kinds = kinds
        self._fixed = struct.Struct("<" + "".join(_CODES.get(k, "I") for k in kinds))
        self._loose = [i for i, kind in enumerate(kinds) if kind not in _CODES]

    def pack(self, values: Sequence[Any]) -> bytes:
        """Return ``values`` as bytes."""
        if not self._loose:
            return self._fixed.pack(*values)
        fixed = list(values)
        texts = [_packed(values[i], self._kinds[i]) for i in self._loose]
        for i, text in zip(self._loose, texts, strict=True):
            fixed[i] = len(text)
        return self._fixed.pack(*fixed) + b"".join(texts)

    def unpack(self, data: bytes) -> list[Any]:
        """Return the values in ``data``. Raises ValueError or struct.error if they do not fit."""
        values = list(self._fixed.unpack_from(data))
        place = self._fixed.size
        for i in self._loose:
            end = place + values[i]
            values[i] = _unpacked(data[place:end], self._kinds[i])
            place = end
        if place != len(data):
            raise ValueError(f"{len(data)} bytes for values that take {place}")
        return values


def _packed(value: Any, kind: type) -> bytes:
    if kind is bytes:
        data: bytes = value
        return data
    # Integers are text too: FMI has them up to 2^64 - 1 and down to -2^63.
    text: str = str(index(value)) if kind is int else value
    return text.encode("utf-8", "surrogatepass")


def _unpacked(data: bytes, kind: type) -> Any:
    if kind is bytes:
        return data
    return kind(data.decode("utf-8", "surrogatepass"))
