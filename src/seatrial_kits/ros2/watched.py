"""Commands on one topic: what is taken, from whom, and for how long it is valid."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from .messages.definitions import type_store
from .messages.message import is_finite, stamp_ns
from .transport import Transport

DEPTH = 10
"""Messages taken in one step: of a flood, the newest."""
_FOREIGN_NS = 60_000_000_000
"""Stamps farther away are not of simulated time."""


class Watched:
    """The reader of one topic; ``say`` is notified once of what is refused, ``refused`` counts it.

    A publisher owns the topic for as long as its commands are valid: what another one sends
    then is refused. So is what is not finite, and a stamp that is older than ``timeout``, s. A
    stamp of another clock is reported, and the time of arrival taken.
    """

    def __init__(
        self,
        transport: Transport,
        name: str,
        kind: str,
        timeout: float,
        say: Callable[[str], None],
    ) -> None:
        self.name, self.kind, self.timeout = name, kind, timeout
        self.reader = transport.reader(name, kind, DEPTH)
        self.refused = self.late = 0
        self._reported: set[str] = set()
        self._say = say
        self._owner, self._owned_at = 0, -1e9
        self._queue: deque[Any] = deque(maxlen=DEPTH)
        self.message: Any = None
        self.at = -1e9
        """Simulated time at which it came, s."""

    def is_valid(self, now: float) -> bool:
        """Return whether the last command is younger than its time-out, s."""
        return self.message is not None and now - self.at <= self.timeout

    @property
    def is_stamped(self) -> bool:
        """Return whether its messages have a header."""
        return any(name == "header" for name, _ in type_store().fielddefs[self.kind][1])

    @property
    def publishers(self) -> int:
        """Number of publishers that match."""
        return self.reader.publishers

    def take_newest(self, now: float, now_ns: int) -> None:
        """Take in what has arrived; the newest is the command, unless its stamp is too old."""
        self._take_in(now)
        if self._queue and self._is_of_now(self._queue[-1], now_ns):
            self.message, self.at = self._queue[-1], now
        self._queue.clear()

    def take_one(self, now: float) -> bool:
        """Take exactly one command, in their order; return whether there is one."""
        self._take_in(now)
        if not self._queue:
            return False
        self.message, self.at = self._queue.popleft(), now
        return True

    def take_stamped(self, now: float, now_ns: int) -> bool:
        """Take the command with this stamp, and drop older ones; return whether there is one."""
        self._take_in(now)
        while self._queue:
            found = self._queue.popleft()
            if stamp_ns(found.header) == now_ns:
                self.message, self.at = found, now
                return True
        return False

    def _is_of_now(self, message: Any, now_ns: int) -> bool:
        """Return whether a command is not too old to be used; without a stamp none is."""
        stamp = stamp_ns(message.header) if hasattr(message, "header") else 0
        age = now_ns - stamp
        if stamp and abs(age) > _FOREIGN_NS:
            self._tell("stamps are not of simulated time: set use_sim_time of the node")
        elif stamp and age > self.timeout * 1e9:
            self.late += 1
            self._tell(f"commands older than {self.timeout:g} s are dropped")
            return False
        return True

    def _take_in(self, now: float) -> None:
        for message, publisher in self.reader.take(DEPTH):
            if message is None:
                self._refuse("messages that cannot be read are refused")
            elif not is_finite(message):
                self._refuse("numbers that are not finite are refused")
            elif publisher != self._owner and now - self._owned_at <= self.timeout:
                self._refuse("a second publisher is refused: two command the same")
            else:
                if not publisher and self.publishers > 1:
                    self._tell("it has several publishers, whom rclpy does not tell apart")
                self._owner, self._owned_at = publisher, now
                self._queue.append(message)

    def _refuse(self, why: str) -> None:
        self.refused += 1
        self._tell(why)

    def _tell(self, what: str) -> None:
        if what not in self._reported:
            self._reported.add(what)
            self._say(f"{self.name}: {what}")
