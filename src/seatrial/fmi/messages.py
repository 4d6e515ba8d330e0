"""Messages of FMU instances: a status, and messages that explain an error or go to the log."""

from __future__ import annotations

import ctypes
import itertools
import logging
from collections.abc import Callable
from typing import Any

from fmpy import fmi1, fmi2
from fmpy.logging import addLoggerProxy

# Equal in all versions of FMI.
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
ACCEPTED = (OK, WARNING)
"""With any other status, one that FMI does not have included, a call has failed."""

_WORDS = ("ok", "warning", "discard", "error", "fatal", "pending")
_MOST_KEPT = 50

said = ctypes.c_int32()
"""Set by every message that is kept: what calls FMUs from C sees there that one came."""


def word(status: int) -> str:
    """Return FMI's name of a status, or the number of one that FMI does not have."""
    if 0 <= status < len(_WORDS):
        return _WORDS[status]
    return f"status {status}, which FMI does not have"


class Messages:
    """The messages of one instance since somebody last asked; ``shown`` makes them readable."""

    def __init__(self, name: str, shown: Callable[[str], str] = str) -> None:
        self.name, self._shown = name, shown
        self._logger = logging.getLogger(f"seatrial.fmu.{name}")
        self.kept: list[tuple[int, str]] = []
        """Status and text; the same list for ever, so that callers see at once if it is empty."""
        self._lost = 0

    def __bool__(self) -> bool:
        return bool(self.kept)

    def keep(self, status: int, message: bytes | None) -> None:
        """Keep a message with its fmi2Status or fmi3Status; only count them after many."""
        said.value = 1
        if len(self.kept) < _MOST_KEPT:
            self.kept.append((status, (message or b"").decode("utf-8", "replace")))
        else:
            self._lost += 1

    def warn(self, text: str) -> None:
        """Keep a warning of ours."""
        self.keep(WARNING, text.encode())

    def has_error(self) -> bool:
        """Say if one of them has the status of an error."""
        return any(status >= ERROR for status, _ in self.kept)

    def said(self) -> str:
        """Return all of them as the end of an error message, and forget them."""
        texts = [self._shown(text.strip()) for _, text in self.kept]
        if self._lost:
            texts.append(f"({self._lost} more messages)")
        self._forget()
        return ": " + "\n".join(texts) if texts else ", without a message"

    def _forget(self) -> None:
        self.kept.clear()
        self._lost = 0

    def forward(self) -> None:
        """Pass all of them to the logger ``seatrial.fmu.NAME``, and forget them."""
        for status, text in self.kept:
            level = (
                logging.ERROR if status >= ERROR else logging.WARNING if status else logging.INFO
            )
            self._logger.log(level, "%s", self._shown(text))
        if self._lost:
            self._logger.warning("%d more messages", self._lost)
        self._forget()


_numbers = itertools.count(1)
_listening: dict[int, Callable[[int, bytes | None], None]] = {}
"""Who takes the messages of which FMI 2 instance, by its component environment."""


def listening_callbacks(messages: Messages) -> fmi2.fmi2CallbackFunctions:
    """Return FMI 2 callbacks that keep in ``messages`` what the instance says."""
    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = _logger_proxy()
    callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
    callbacks.componentEnvironment = next(_numbers)
    _listening[callbacks.componentEnvironment] = messages.keep
    return callbacks


def stop_listening(callbacks: fmi2.fmi2CallbackFunctions) -> None:
    """Forget an instance that is gone."""
    _listening.pop(callbacks.componentEnvironment, None)


_listening_by_name: dict[bytes, Callable[[int, bytes | None], None]] = {}
"""The same of FMI 1.0, which has no environment: the last instance of each name."""


def listening_callbacks1(messages: Messages) -> fmi1.fmi1CallbackFunctions:
    """Return FMI 1.0 callbacks that keep in ``messages`` what the instance of that name says."""
    callbacks = fmi1.fmi1CallbackFunctions()
    callbacks.logger = _logger_proxy()
    callbacks.allocateMemory = fmi1.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi1.defaultCallbacks.freeMemory
    _listening_by_name[messages.name.encode()] = messages.keep
    return callbacks


def stop_listening1(messages: Messages) -> None:
    """Forget an instance of FMI 1.0 that is gone."""
    name = messages.name.encode()
    if _listening_by_name.get(name) == messages.keep:
        del _listening_by_name[name]


def _dispatch(
    environment: int | None, instance: bytes, status: int, category: bytes, message: bytes
) -> None:
    listener = _listening.get(environment or 0) or _listening_by_name.get(instance or b"")
    if listener is None:  # an instance of somebody else in this process
        fmi2.printLogMessage(environment, instance, status, category, message)
    else:
        listener(status, message)


_template = fmi2.fmi2CallbackFunctions()
_dispatcher = fmi2.fmi2CallbackLoggerTYPE(_dispatch)


def _logger_proxy() -> Any:
    """Return FMPy's native logger, which formats printf arguments and calls `_dispatch`.

    The proxy knows one Python function for the whole process: so it must be one that lives
    for ever, and is registered again in case somebody else did meanwhile.
    """
    _template.logger = _dispatcher
    addLoggerProxy(ctypes.byref(_template))
    return _template.logger
