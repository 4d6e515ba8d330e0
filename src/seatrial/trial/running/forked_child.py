"""The child of a `Forked`: signals, the end of its parent, and what it prints and logs."""

from __future__ import annotations

import ctypes
import io
import logging
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from ...fmi.isolation.orphan import end_with
from .call_trace import LOADS, STARTS, STEPS, CallTrace
from .link import Link

ASKING = [
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
    if hasattr(signal, name)
]
"""Signals by which people, terminals and service managers ask for an end."""
ORDER = signal.SIGTERM
"""Signal by which the parent's orders are noticed in a call that waits."""
_IN_ORDER_S = 10.0
"""Wall time to end in order once the parent was killed."""
_PR_SET_PDEATHSIG = 1


class Child:
    """What a child knows of its parent: orders to stop, in the trace, and whether it lives.

    A stop that is more urgent than 1 raises KeyboardInterrupt, once, where a component may hang.
    A signal to this process asks for a stop too, unless the parent ignores it. Those of a terminal
    reach the parent as well, which passes on its orders with a signal of its own: it says before
    how many there are, so that they are not counted twice. One comes when the parent is killed.
    ``alarm`` gets the number of each signal at once.
    """

    def __init__(self, link: Link, trace: CallTrace, parent: int, alarm: int) -> None:
        self.link, self.call_trace = link, trace
        self.loads = True
        """Whether components are being loaded, which may take any time; they start behind it."""
        self._parent, self._own = parent, os.getpid()
        self._may_hang = self._interrupted = False
        self._orders = self._requests = 0
        self._heeded = [each for each in ASKING if signal.getsignal(each) != signal.SIG_IGN]
        for number in ASKING:
            # Not SIG_IGN: a program that a component starts would ignore them too.
            signal.signal(number, self._heed)
            signal.siginterrupt(number, False)
        signal.set_wakeup_fd(alarm, warn_on_full_buffer=False)
        if sys.platform == "linux":
            ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, ORDER)
        if os.getppid() != parent:  # it ended before the line above
            os._exit(1)
        end_with(parent, _IN_ORDER_S)

    def asked(self) -> int:
        """Return how urgently a stop is requested; called once a step, between all calls."""
        if os.getpid() != self._own:
            os._exit(0)  # a copy of this process that a component made by fork, and that returned
        return self.call_trace.between_calls()

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """Let an urgent stop end what is done inside."""
        self._may_hang = True
        self.call_trace.phase = LOADS if self.loads else STARTS
        try:
            self._interrupt()
            yield
        finally:
            self._may_hang = False
            self.call_trace.phase = 0

    def begun(self) -> None:
        """Note that steps follow, with their own limit of time."""
        self.call_trace.phase = STEPS

    def _heed(self, number: int, _frame: object) -> None:
        trace = self.call_trace
        if os.getppid() != self._parent:
            trace.asked = 2
        elif number == ORDER and self._orders < trace.orders:
            self._orders = trace.orders
        elif number in self._heeded:
            self._requests += 1
            trace.asked = max(trace.asked, min(self._requests, 2))
        self._interrupt()

    def _interrupt(self) -> None:
        if self.call_trace.asked > 1 and self._may_hang and not self._interrupted:
            self._interrupted = True
            raise KeyboardInterrupt


def forward_output(link: Link) -> None:
    """Send what is printed and logged as frames: the parent's streams may be anything."""
    sys.stdout = _stream(link, "stdout", 1)
    sys.stderr = _stream(link, "stderr", 2)
    _forward_logs(link)


def flush_c_streams() -> None:
    """Write what C code has printed."""
    with suppress(OSError):
        ctypes.CDLL(None).fflush(None)


class _Raw(io.RawIOBase):
    def __init__(self, link: Link, name: str, descriptor: int) -> None:
        self._link, self._name, self._descriptor = link, name, descriptor

    def writable(self) -> bool:
        return True

    def fileno(self) -> int:
        return self._descriptor

    def isatty(self) -> bool:
        return os.isatty(self._descriptor)

    def write(self, data: Any) -> int:
        self._link.send("print", self._name, bytes(data).decode("utf-8", "backslashreplace"))
        return len(data)


def _stream(link: Link, name: str, descriptor: int) -> io.TextIOWrapper:
    raw: Any = _Raw(link, name, descriptor)
    return io.TextIOWrapper(raw, "utf-8", "backslashreplace", write_through=True)


class _Forwarder(logging.Handler):
    def __init__(self, link: Link) -> None:
        super().__init__()
        self._link = link

    def emit(self, record: logging.LogRecord) -> None:
        self._link.send("log", record.name, record.levelno, record.getMessage())


def _forward_logs(link: Link) -> None:
    """Let the parent handle the records of seatrial's loggers; levels are its own already."""
    for name, logger in logging.Logger.manager.loggerDict.items():
        if name.startswith("seatrial.") and isinstance(logger, logging.Logger):
            logger.handlers, logger.propagate = [], True
    top = logging.getLogger("seatrial")
    top.handlers, top.propagate = [_Forwarder(link)], False
