"""Texts that ports say: in a stream of bytes, or as their value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress

import numpy as np

from ...errors import InputError
from ...links.text import decode
from .expressions import BoolArray


def said_at(column: Sequence[str], text: str) -> BoolArray:
    """Return at which rows a port says ``text``.

    A port that carries bytes (`links.text`) says it where the last byte of it leaves: the bytes
    are one stream, however they were cut into chunks. Any other port says it as long as its
    value contains it. Text is compared as UTF-8.
    """
    if not is_stream(column):
        return np.array([text in value for value in column], dtype=bool)
    wanted = text.encode()
    said = np.zeros(len(column), dtype=bool)
    before = b""
    for row, data in received(column):
        stream = before + data
        said[row] = wanted in stream
        before = stream[-(len(wanted) - 1) :] if len(wanted) > 1 else b""
    return said


def is_stream(column: Sequence[str]) -> bool:
    """Return whether a column is what a port of bytes holds: numbered chunks, at least one."""
    values = set(column) - {""}
    found = False
    for value in values:
        try:
            found |= bool(decode(value)[1])
        except InputError:
            return False
    return found


def received(column: Sequence[str]) -> Iterator[tuple[int, bytes]]:
    """Yield the rows at which bytes arrive, and those bytes."""
    sequence = 0
    for row, value in enumerate(column):
        if row and value is column[row - 1]:
            continue
        number, chunks = decode(value)
        if number > sequence:
            sequence = number
            yield row, b"".join(data for _, data in chunks)


def last_said(column: Sequence[str], length: int = 80) -> str:
    """Return the end of what a port has said, for a person; control characters as escapes."""
    said = b"".join(data for _, data in received(column)) if is_stream(column) else b""
    with suppress(IndexError):
        said = said or column[-1].encode()
    tail = said[-length:].decode(errors="replace")
    return re.sub(r"[\x00-\x1f\x7f]", lambda found: repr(found.group())[1:-1], tail)
