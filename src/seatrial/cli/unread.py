"""Standard streams that nobody reads any more, as after ``| head``: no command ends for that."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from .statuses import BROKEN


@contextmanager
def dropping_unread() -> Iterator[None]:
    """Let what is printed to a reader that is gone be dropped; a status says what else came of it.

    Typer would end with status 1, which is a verdict, Python with 120. What cannot be written for
    another reason, as to a full disk, is lost: where nothing else is wrong, that is.
    """
    before: tuple[Any, Any] = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = [stream and _Stream(stream) for stream in before]
    status: object = 0
    try:
        yield
    except SystemExit as end:
        status = end.code
        raise
    finally:
        sys.stdout, sys.stderr = before
        lost = write(sys.stdout)
        write(sys.stderr)
        if lost and not status:
            say_lost(lost)
            raise SystemExit(BROKEN)


def write(stream: Any, text: str = "") -> str:
    """Write a text and what is buffered; return why not, other than that nobody reads it."""
    try:
        if stream is not None:
            stream.write(text)
            stream.flush()
    except OSError as error:
        _lead_nowhere(stream)
        return "" if isinstance(error, BrokenPipeError) else str(error.strerror)
    return ""


def say_lost(why: str) -> None:
    """Tell that stdout could not be written."""
    write(sys.stderr, f"seatrial: cannot write to stdout: {why}\n")


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


def _lead_nowhere(stream: Any) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
