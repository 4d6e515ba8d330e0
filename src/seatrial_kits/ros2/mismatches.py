"""Endpoints of other nodes that do not fit: another type, a quality that is not offered, a clock.

DDS says nothing of them to anybody. Of each the link says once what it is, and what would match.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from .dds.definitions import dds_name
from .dds.participant import Participant
from .topics import PUBLISHED

_EVERY_S = 0.5
"""Wall time between two looks."""
_MOST = 200
_CLOCK = PUBLISHED["clock"].name


class Endpoint(NamedTuple):
    """A reader or writer of somebody, as it was announced."""

    topic: str
    kind: str
    """The type's name in DDS."""
    reliability: Any
    durability: Any
    is_ours: bool
    """Whether this process has it."""


class Mismatches:
    """Looks at all endpoints of the domain; ``say`` is notified of those that do not fit."""

    def __init__(self, participant: Participant, say: Callable[[str], None]) -> None:
        from cyclonedds.builtin import (
            BuiltinDataReader,
            BuiltinTopicDcpsPublication,
            BuiltinTopicDcpsSubscription,
        )

        self._tell, self._next = say, 0.0
        topics = BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
        self._announced = [BuiltinDataReader(participant.dds, topic) for topic in topics]
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
        for reader, known in zip(self._announced, self._known, strict=True):
            known |= set(_taken(reader))
        for endpoint in self._known[0]:
            if endpoint.topic in read:
                self._compare(endpoint, "a publisher", read[endpoint.topic])
            if endpoint.topic == _CLOCK and not endpoint.is_ours and _CLOCK in written:
                self._say(f"{_CLOCK}: another program publishes it too: nodes see two clocks")
        for endpoint in self._known[1]:
            if endpoint.topic in written:
                kept = endpoint.topic in latched
                self._compare(endpoint, "a subscriber", written[endpoint.topic], latched=kept)

    def _compare(self, endpoint: Endpoint, who: str, kind: str, *, latched: bool = True) -> None:
        from cyclonedds.core import Policy

        name = endpoint.topic
        if endpoint.kind != dds_name(kind):
            found = endpoint.kind.replace("::dds_::", "/").replace("::", "/")
            self._say(
                f"{name}: {who} has the type {found.removesuffix('_')}, {kind} is needed: they do "
                "not match"
            )
        elif who == "a publisher" and endpoint.reliability == Policy.Reliability.BestEffort:
            self._say(f"{name}: {who} is best effort, reliable is needed: they do not match")
        elif not latched and endpoint.durability != Policy.Durability.Volatile:
            self._say(
                f"{name}: {who} asks for transient local, which this topic is not: make it "
                "volatile, or they do not match"
            )

    def _say(self, what: str) -> None:
        if what not in self._said:
            self._said.add(what)
            self._tell(what)


def _taken(reader: Any) -> Iterator[Endpoint]:
    from cyclonedds.core import Policy

    for each in reader.take(_MOST):
        if each.sample_info.valid_data:
            quality = each.qos[Policy.Reliability], each.qos[Policy.Durability]
            ours = str(each.participant_key) in Participant.of_this_process
            yield Endpoint(each.topic_name.removeprefix("rt"), each.type_name, *quality, ours)
