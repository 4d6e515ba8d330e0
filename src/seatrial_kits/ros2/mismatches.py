"""Endpoints of other nodes that do not fit: another type, a quality that is not offered, a clock.

DDS says nothing of them to anybody. Of each the link says once what it is, and what would match.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from .topics import CLOCK
from .transport import Endpoint, Transport

_EVERY_S = 0.5
"""Wall time between two looks."""


class Mismatches:
    """Looks at all endpoints of the domain; ``say`` is notified of those that do not fit."""

    def __init__(self, transport: Transport, say: Callable[[str], None]) -> None:
        self._transport, self._tell, self._next = transport, say, 0.0
        self._known: tuple[set[Endpoint], set[Endpoint]] = (set(), set())
        """Publishers, and subscribers."""
        self._said: set[str] = set()

    def look(
        self, read: Mapping[str, str], written: Mapping[str, str], latched: frozenset[str]
    ) -> None:
        """Look, some times a second, at what was announced since, and at topics that came since.

        ``read`` and ``written`` are the topics of the link, by name, with their types; those in
        ``latched`` are kept for late readers.
        """
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _EVERY_S
        announced = self._transport.endpoints(read, written)
        for found, known in zip(announced, self._known, strict=True):
            known |= set(found)
        for endpoint in self._known[0]:
            if endpoint.topic in read:
                self._compare(endpoint, "a publisher", read[endpoint.topic])
            if endpoint.topic == CLOCK and not endpoint.is_ours and CLOCK in written:
                self._say(f"{CLOCK}: another program publishes it too: nodes see two clocks")
        for endpoint in self._known[1]:
            if endpoint.topic in written:
                kept = endpoint.topic in latched
                self._compare(endpoint, "a subscriber", written[endpoint.topic], latched=kept)

    def _compare(self, endpoint: Endpoint, who: str, kind: str, *, latched: bool = True) -> None:
        name = endpoint.topic
        if endpoint.kind != kind:
            self._say(
                f"{name}: {who} has the type {endpoint.kind}, {kind} is needed: they do not match"
            )
        elif who == "a publisher" and endpoint.is_best_effort:
            self._say(f"{name}: {who} is best effort, reliable is needed: they do not match")
        elif not latched and endpoint.is_latched:
            self._say(
                f"{name}: {who} asks for transient local, which this topic is not: make it "
                "volatile, or they do not match"
            )

    def _say(self, what: str) -> None:
        if what not in self._said:
            self._said.add(what)
            self._tell(what)
