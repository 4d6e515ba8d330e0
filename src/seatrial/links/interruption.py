"""Notice of signals that ask the process to end, for a component that waits within its step."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

_Handler = Callable[[int, FrameType | None], Any]
_entered: list[Interruption] = []
_before: dict[int, _Handler] = {}


class Interruption:
    """Notices, while it is entered, a signal that requests the process to end.

    The handler that there is still runs; what that ends by an exception of its own is not noticed.
    Several may be entered, and be left in any order; entering anew finds a handler that was set
    since. Only a Python program's main thread can notice.
    """

    def __init__(self) -> None:
        self.requested = False

    def take(self) -> bool:
        """Return whether there was such a signal, once: a process that goes on may wait again."""
        requested, self.requested = self.requested, False
        return requested

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            _install()
            _entered.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        if self in _entered:
            _entered.remove(self)
            if not _entered:
                _restore()


def _install() -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        handler = signal.getsignal(number)
        if callable(handler) and handler is not _note:
            _before[number] = handler
            signal.signal(number, _note)


def _restore() -> None:
    for number, handler in _before.items():
        if signal.getsignal(number) is _note:
            signal.signal(number, handler)
    _before.clear()


def _note(number: int, frame: FrameType | None) -> None:
    _before[number](number, frame)
    for each in _entered:
        each.requested = True
