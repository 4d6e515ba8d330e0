"""Signals that ask a command to end before it heeds them itself: a message, and status 3."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

from .statuses import BROKEN


def heeded() -> list[int]:
    """Return the signals by which people, terminals and service managers ask for an end.

    A hang-up that is ignored stays so: that is what nohup does. None outside the main thread.
    """
    if threading.current_thread() is not threading.main_thread():
        return []
    names = ("SIGINT", "SIGTERM", "SIGQUIT", "SIGHUP")
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    ignored = getattr(signal, "SIGHUP", None), signal.SIG_IGN
    return [number for number in numbers if (number, signal.getsignal(number)) != ignored]


@contextmanager
def ending_at_once() -> Iterator[None]:
    """Let a signal end the process at once: an interrupted import leaves tracebacks and halves."""
    with _handled(_end):
        yield


@contextmanager
def interrupting() -> Iterator[None]:
    """Let every one of the signals raise KeyboardInterrupt, as Ctrl-C does."""
    with _handled(_interrupt):
        yield


@contextmanager
def _handled(handler: Callable[[int, Any], Any]) -> Iterator[None]:
    before = {number: signal.signal(number, handler) for number in heeded()}
    try:
        yield
    finally:
        for number, old in before.items():
            if signal.getsignal(number) is handler:  # else a command ignores it while it leaves
                signal.signal(number, old)


def _end(_number: int, _frame: object) -> NoReturn:
    os.write(2, b"seatrial: stopped\n")
    os._exit(BROKEN)


def _interrupt(_number: int, _frame: object) -> NoReturn:
    raise KeyboardInterrupt
