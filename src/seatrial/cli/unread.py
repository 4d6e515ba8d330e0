"""Standard streams that nobody reads any more, as after ``| head``: no command ends for that."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def dropping_unread() -> Iterator[None]:
    """Let what is printed to a reader that is gone be dropped; a status says what else came of it.

    Typer would end with status 1, which is a verdict, Python with 120.
    """
    before: tuple[Any, Any] = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = [stream and _Stream(stream) for stream in before]
    try:
        yield
    finally:
        for stream in before:
            _flush(stream)
        sys.stdout, sys.stderr = before


class _Stream:
    """A text stream that leads nowhere from the moment on at which its reader is gone."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text, or drop it."""
        try:
            self._stream.write(text)
        except BrokenPipeError:
            _lead_nowhere(self._stream)
        return len(text)

    def flush(self) -> None:
        """Write what is buffered, or drop it."""
        try:
            self._stream.flush()
        except BrokenPipeError:
            _lead_nowhere(self._stream)


def _flush(stream: Any) -> None:
    try:
        if stream is not None:
            stream.flush()
    except OSError:  # a full disk too: Python would have a status of its own for it
        _lead_nowhere(stream)


def _lead_nowhere(stream: Any) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
