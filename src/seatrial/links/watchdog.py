"""Watchdog of a component that waits: it says for whom, and since when."""

from __future__ import annotations

import datetime
import logging
import time

from ..errors import SimulationError
from .safe_state import waits

_SAYS_S = 0.5
"""Wall time between two notes that the component waits, and does not hang."""
FIRST_S, EVERY_S = 5.0, 30.0
"""Wall time of silence before the first message, and between others."""

_LOGGER = logging.getLogger("seatrial.waiting")


class Waiting:
    """Notes, now and then, that a component waits for somebody outside and does not hang."""

    def __init__(self) -> None:
        self._said = 0.0

    def note(self) -> None:
        """Note it, if the last note is some time ago."""
        now = time.monotonic()
        if now >= self._said:
            self._said = now + _SAYS_S
            waits()


class Watchdog:
    """Messages of the component ``name`` that waits for ``whom``, for ``limit`` of wall time, s.

    A limit of 0 is none.
    """

    def __init__(self, name: str, whom: str, limit: float = 0.0) -> None:
        self._name, self._whom, self._limit = name, whom, limit
        self._since: float | None = None
        self._next, self._waiting = 0.0, Waiting()

    def say(self, message: str) -> None:
        """Say something at once."""
        _LOGGER.warning("%s: %s", self._name, message)

    def waiting(self) -> None:
        """Note that nothing has come yet, and say so where it takes long.

        Raises SimulationError at the limit.
        """
        now = time.monotonic()
        if self._since is None:
            self._since, self._next = now, now + FIRST_S
        if 0.0 < self._limit <= now - self._since:
            raise SimulationError(
                f"{self._name}: nothing came from {self._whom}, within {self._limit:g} s of wall "
                "time: start it, or give a longer wait_limit (0 s: without end)"
            )
        self._waiting.note()
        if now >= self._next:
            self._next = now + EVERY_S
            since = datetime.datetime.now() - datetime.timedelta(seconds=now - self._since)
            self.say(
                f"waiting for {self._whom}, since {since:%H:%M:%S} ({now - self._since:.0f} s)"
            )

    def received(self) -> None:
        """Note that it has come."""
        self._since = None
