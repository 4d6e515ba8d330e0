"""Endpoints of others, as DDS announces them."""

from __future__ import annotations

from collections.abc import Container, Iterator
from typing import Any

from ..transport import Endpoint

_MOST = 200


class Announced:
    """Reads what all participants of a domain announce."""

    def __init__(self, participant: Any) -> None:
        from cyclonedds.builtin import (
            BuiltinDataReader,
            BuiltinTopicDcpsPublication,
            BuiltinTopicDcpsSubscription,
        )

        self._publications = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        self._subscriptions = BuiltinDataReader(participant, BuiltinTopicDcpsSubscription)

    def publishers(self, ours: Container[str]) -> Iterator[Endpoint]:
        """Yield writers that were announced since; ``ours`` are this process' participants."""
        return _taken(self._publications, ours)

    def subscribers(self, ours: Container[str]) -> Iterator[Endpoint]:
        """Yield readers that were announced since."""
        return _taken(self._subscriptions, ours)


def _taken(reader: Any, ours: Container[str]) -> Iterator[Endpoint]:
    from cyclonedds.core import Policy

    for each in reader.take(_MOST):
        if each.sample_info.valid_data:
            kind = each.type_name.replace("::dds_::", "/").replace("::", "/").removesuffix("_")
            yield Endpoint(
                each.topic_name.removeprefix("rt"),
                kind,
                each.qos[Policy.Reliability] == Policy.Reliability.BestEffort,
                each.qos[Policy.Durability] != Policy.Durability.Volatile,
                str(each.participant_key) in ours,
            )
