"""Endpoints of other nodes that cannot be matched: another type, or a quality that is not offered.

DDS says nothing of them to anybody. Of each the link says once what it is, and what would match.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

from .definitions import dds_name
from .participant import Participant

_EVERY_S = 0.5
"""Wall time between two looks."""
_MOST = 200


class Mismatches:
    """Looks at all endpoints of the domain; ``say`` is told of those that do not fit.

    ``read`` and ``written`` are the topics of the link, by name, with their types; those in
    ``latched`` are kept for late readers.
    """

    def __init__(self, participant: Participant, say: Callable[[str], None]) -> None:
        from cyclonedds.builtin import (
            BuiltinDataReader,
            BuiltinTopicDcpsPublication,
            BuiltinTopicDcpsSubscription,
        )

        self._tell, self._next = say, 0.0
        self._publishers = BuiltinDataReader(participant.dds, BuiltinTopicDcpsPublication)
        self._subscribers = BuiltinDataReader(participant.dds, BuiltinTopicDcpsSubscription)
        self._said: set[str] = set()

    def look(
        self, read: Mapping[str, str], written: Mapping[str, str], latched: frozenset[str]
    ) -> None:
        """Look, some times a second."""
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _EVERY_S
        for reader, ours in ((self._publishers, read), (self._subscribers, written)):
            for endpoint in reader.read(_MOST):
                if not endpoint.sample_info.valid_data:
                    continue
                name = endpoint.topic_name.removeprefix("rt")
                if name in ours:
                    self._compare(name, ours[name], endpoint, ours is read, name in latched)

    def _compare(self, name: str, kind: str, endpoint: Any, publishes: bool, latched: bool) -> None:
        from cyclonedds.core import Policy

        who = "a publisher" if publishes else "a subscriber"
        if endpoint.type_name != dds_name(kind):
            found = endpoint.type_name.replace("::dds_::", "/").replace("::", "/")
            self._say(
                f"{name}: {who} has the type {found.removesuffix('_')}, {kind} is needed: they do "
                "not match"
            )
            return
        reliability, durability = endpoint.qos[Policy.Reliability], endpoint.qos[Policy.Durability]
        if publishes and reliability == Policy.Reliability.BestEffort:
            self._say(f"{name}: {who} is best effort, reliable is needed: they do not match")
        if not publishes and not latched and durability != Policy.Durability.Volatile:
            self._say(
                f"{name}: {who} asks for transient local, which this topic is not: make it "
                "volatile, or they do not match"
            )

    def _say(self, what: str) -> None:
        if what not in self._said:
            self._said.add(what)
            self._tell(what)
