"""DDS without ROS: a participant of a domain, by the package cyclonedds."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from seatrial.errors import InputError, unknown

from ..messages.definitions import INSTALL
from ..messages.hashes import announced_hash
from ..reach import confined
from ..transport import Durability, Sample
from .idl import sample_type

SPOKEN = ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp", "rmw_connextdds")
"""Middlewares of ROS 2 that are DDS."""
_ENCLAVE = b"enclave=/;"
"""By which middlewares of ROS know a participant of theirs."""


class Participant:
    """One participant, with readers and writers.

    Raises InputError for a middleware that is no DDS, and without the package cyclonedds.
    """

    of_this_process: ClassVar[set[str]] = set()
    """Identifiers of all participants that were made."""

    def __init__(self, domain: int) -> None:
        try:
            from cyclonedds.core import DDSException, Policy, Qos
            from cyclonedds.domain import DomainParticipant
        except ImportError:
            raise InputError(f"ROS 2 needs cyclonedds, which is not installed: {INSTALL}") from None
        _check_middleware()
        self.domain = domain
        try:
            with confined(cyclone=True):
                self.dds = DomainParticipant(self.domain, Qos(Policy.Userdata(_ENCLAVE)))
            self.of_this_process.add(str(self.dds.guid))
        except DDSException as error:
            raise InputError(f"the ROS domain {self.domain} cannot be joined: {error}") from None
        self.identity: bytes = self.dds.guid.bytes
        self.readers: list[bytes] = []
        self.writers: list[bytes] = []
        """Identifiers of all that it has, 16 bytes each."""

    def writer(
        self, topic: str, kind: str, durability: Durability = "volatile", prefix: str = "rt"
    ) -> DdsWriter:
        """Return a writer of messages."""
        return DdsWriter(self, topic, kind, durability, prefix)

    def reader(self, topic: str, kind: str, depth: int = 10, prefix: str = "rt") -> DdsReader:
        """Return a reliable reader that keeps the newest ``depth`` messages."""
        return DdsReader(self, topic, kind, depth, prefix)

    def arrivals(self, readers: Sequence[DdsReader]) -> Callable[[], bool]:
        """Return what says whether any of the readers has messages that were not taken yet."""
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet

        waiting = WaitSet(self.dds)
        for reader in readers:
            new = SampleState.NotRead | ViewState.Any | InstanceState.Any
            waiting.attach(ReadCondition(reader.dds, new))
        return lambda: waiting.wait(0) > 0

    def topic(self, topic: str, kind: str, prefix: str = "rt") -> Any:
        """Return the topic of DDS."""
        from cyclonedds.topic import Topic

        return Topic(self.dds, prefix + topic, sample_type(kind))

    def close(self) -> None:
        """Leave the domain, and take all topics along: others are notified at once."""
        self.dds.__del__()  # the package has no other way before the last reference is gone


class DdsWriter:
    """Writes messages of one kind to DDS: a `Writer`."""

    def __init__(
        self, participant: Participant, topic: str, kind: str, durability: Durability, prefix: str
    ) -> None:
        from cyclonedds.core import DDSException
        from cyclonedds.pub import DataWriter

        self._refused: type[Exception] = DDSException
        self._sample = sample_type(kind)
        self.name, self.kind, self.dropped = topic, kind, 0
        depth = 1 if durability == "latched" else 10
        self.dds = DataWriter(
            participant.dds,
            participant.topic(topic, kind, prefix),
            _quality(durability, depth, kind),
        )
        participant.writers.append(self.dds.guid.bytes)

    def write(self, data: bytes) -> None:
        """Write a message of the kind, as bytes (`packing`)."""
        try:
            self.dds.write(self._sample(data))
        except self._refused:
            self.dropped += 1

    @property
    def readers(self) -> int:
        """Number of readers that match."""
        return len(self.dds.get_matched_subscriptions())


class DdsReader:
    """Reads one topic of DDS: a `Reader`."""

    def __init__(
        self, participant: Participant, topic: str, kind: str, depth: int, prefix: str
    ) -> None:
        from cyclonedds.sub import DataReader

        self.dds = DataReader(
            participant.dds,
            participant.topic(topic, kind, prefix),
            _quality("volatile", depth, kind),
        )
        participant.readers.append(self.dds.guid.bytes)

    def take(self, most: int) -> list[Sample]:
        """Return messages that have come since, each with its publisher."""
        return [
            Sample(each.message, each.sample_info.publication_handle)
            for each in self.dds.take(most)
            if each.sample_info.valid_data
        ]

    @property
    def publishers(self) -> int:
        """Number of publishers that match."""
        return len(self.dds.get_matched_publications())


def _quality(durability: Durability, depth: int, kind: str) -> Any:
    from cyclonedds.core import Policy, Qos

    kept = {"volatile": Policy.Durability.Volatile, "latched": Policy.Durability.TransientLocal}
    hashed = announced_hash(kind)
    return Qos(
        *([Policy.Userdata(f"typehash={hashed};".encode())] if hashed else []),
        Policy.Reliability.Reliable(max_blocking_time=0),
        kept[durability],
        Policy.History.KeepLast(depth),
        # Plain CDR: nodes of Humble know no other.
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )


def _check_middleware() -> None:
    named = os.environ.get("RMW_IMPLEMENTATION", "")
    if named and named not in SPOKEN:
        raise InputError(
            f"RMW_IMPLEMENTATION: {unknown('middleware', named, SPOKEN)}: without an rclpy that "
            "this Python can import the link speaks DDS"
        )
