"""How far a log has been read: its files report their place to the one who waits."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

_BLOCK = 1 << 18
"""Bytes that are read at once, and after which the place is reported."""
_told: ContextVar[Callable[[float], None]] = ContextVar("told", default=lambda _: None)


@contextmanager
def told(progress: Callable[[float], None]) -> Iterator[None]:
    """Call ``progress`` with the share of a log that has been read, 0 to 1, inside the block."""
    before = _told.set(progress)
    try:
        yield
    finally:
        _told.reset(before)


def tell(share: float) -> None:
    """Report the share of a log that has been read."""
    _told.get()(share)


class _Told(io.FileIO):
    """A file that reports its place as it is read."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._size = max(path.stat().st_size, 1)

    def readinto(self, buffer: Any, /) -> int:
        """Read as `io.FileIO` does."""
        count = super().readinto(buffer)
        tell(min(self.tell() / self._size, 1.0))
        return count


def open_bytes(path: Path) -> io.BufferedReader:
    """Open a file of a log for reading. Raises OSError."""
    return io.BufferedReader(_Told(path), _BLOCK)


def open_text(path: Path, encoding: str, newline: str | None = None) -> io.TextIOWrapper:
    """Open a text of a log for reading, as ``open`` does. Raises OSError."""
    return io.TextIOWrapper(open_bytes(path), encoding, newline=newline)
