"""Participant of a DDS domain: on the loopback interface alone unless other hosts are allowed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar, Literal

from seatrial.errors import InputError, unknown
from seatrial.links.hardware import network_allowed

from .confinement import confined_sockets
from .definitions import INSTALL
from .idl import sample_type

HIGHEST_DOMAIN = 232
"""Domains above have no ports of their own."""
SPOKEN = ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp", "rmw_fastrtps_dynamic_cpp", "rmw_connextdds")
"""Middlewares of ROS 2 that are DDS."""
LOOPBACK = (
    '<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery>"
    "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>60</MaxAutoParticipantIndex>"
    '<Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
)
"""What nodes must have in CYCLONEDDS_URI too, to be found without multicast."""
_URI = "CYCLONEDDS_URI"
_ENCLAVE = b"enclave=/;"
"""By which middlewares of ROS know a participant of theirs."""
_spoken_in: set[int] = set()
"""Processes in which a participant was made: this one, and one that it was forked from."""

Durability = Literal["volatile", "latched"]


class Participant:
    """One participant; its topics by their names in ROS, ``/otter/imu/data``.

    ``domain`` below 0 is that of ROS_DOMAIN_ID, else 0. Raises InputError for a domain that
    cannot be, a middleware that is no DDS, and without the package cyclonedds.
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
        _check_process()
        self.domain = domain if domain >= 0 else _environment_domain()
        try:
            with _configured(), confined_sockets(reaches_others()):
                self.dds = DomainParticipant(self.domain, Qos(Policy.Userdata(_ENCLAVE)))
            self.of_this_process.add(str(self.dds.guid))
        except DDSException as error:
            raise InputError(f"the ROS domain {self.domain} cannot be joined: {error}") from None
        self.identity: bytes = self.dds.guid.bytes
        self.readers: list[bytes] = []
        self.writers: list[bytes] = []
        """Identifiers of all that it has, 16 bytes each."""

    def writer(self, topic: str, kind: str, durability: Durability = "volatile") -> Writer:
        """Return a writer of messages; see `Writer`."""
        return Writer(self, topic, kind, durability)

    def reader(self, topic: str, kind: str, depth: int = 10, prefix: str = "rt") -> Any:
        """Return a reliable reader that keeps the newest ``depth`` messages."""
        from cyclonedds.sub import DataReader

        made = DataReader(self.dds, self.topic(topic, kind, prefix), _quality("volatile", depth))
        self.readers.append(made.guid.bytes)
        return made

    def arrivals(self, readers: Sequence[Any]) -> Callable[[], bool]:
        """Return what says whether any of the readers has messages that were not taken yet."""
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet

        waiting = WaitSet(self.dds)
        for reader in readers:
            new = SampleState.NotRead | ViewState.Any | InstanceState.Any
            waiting.attach(ReadCondition(reader, new))
        return lambda: waiting.wait(0) > 0

    def topic(self, topic: str, kind: str, prefix: str = "rt") -> Any:
        """Return the topic of DDS."""
        from cyclonedds.topic import Topic

        return Topic(self.dds, prefix + topic, sample_type(kind))

    def close(self) -> None:
        """Leave the domain, and take all topics along: others are notified at once."""
        self.dds.__del__()  # the package has no other way before the last reference is gone


class Writer:
    """Writes messages of one kind: reliable, so that readers of either reliability match.

    ``latched`` is transient local, and keeps one: those who come later get it. A message that
    readers are too slow for is dropped, and counted.
    """

    def __init__(
        self,
        participant: Participant,
        topic: str,
        kind: str,
        durability: Durability = "volatile",
        prefix: str = "rt",
    ) -> None:
        from cyclonedds.core import DDSException
        from cyclonedds.pub import DataWriter

        self._refused: type[Exception] = DDSException
        self._sample = sample_type(kind)
        self.name, self.kind, self.dropped = topic, kind, 0
        depth = 1 if durability == "latched" else 10
        self.dds = DataWriter(
            participant.dds, participant.topic(topic, kind, prefix), _quality(durability, depth)
        )
        participant.writers.append(self.dds.guid.bytes)

    def write(self, data: bytes) -> None:
        """Write a message of the kind, as bytes (`packing`)."""
        try:
            self.dds.write(self._sample(data))
        except self._refused:
            self.dropped += 1


def _quality(durability: Durability, depth: int) -> Any:
    from cyclonedds.core import Policy, Qos

    kept = {"volatile": Policy.Durability.Volatile, "latched": Policy.Durability.TransientLocal}
    return Qos(
        Policy.Reliability.Reliable(max_blocking_time=0),
        kept[durability],
        Policy.History.KeepLast(depth),
        # Plain CDR: nodes of Humble know no other.
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )


def _check_process() -> None:
    """Raise InputError in a fork of a process that spoke DDS: its threads are not here."""
    _spoken_in.add(os.getpid())
    if len(_spoken_in) > 1:
        raise InputError(
            "this process was forked from one that speaks DDS, whose library cannot follow: run "
            "the trial from a process of its own (seatrial run)"
        )


def _check_middleware() -> None:
    named = os.environ.get("RMW_IMPLEMENTATION", "")
    if named and named not in SPOKEN:
        raise InputError(
            f"RMW_IMPLEMENTATION: {unknown('middleware', named, SPOKEN)}: this link speaks DDS"
        )


def _environment_domain() -> int:
    written = os.environ.get("ROS_DOMAIN_ID", "") or "0"
    if not written.isdecimal() or int(written) > HIGHEST_DOMAIN:
        raise InputError(f"ROS_DOMAIN_ID is {written!r}, allowed 0 to {HIGHEST_DOMAIN}")
    return int(written)


def reaches_others() -> bool:
    """Return whether other hosts are reached: allowed, and not narrowed by ROS' own variables."""
    narrowed = os.environ.get("ROS_LOCALHOST_ONLY") == "1" or os.environ.get(
        "ROS_AUTOMATIC_DISCOVERY_RANGE", ""
    ).upper() in ("LOCALHOST", "OFF")
    return network_allowed() and not narrowed


@contextmanager
def _configured() -> Iterator[None]:
    """Make CycloneDDS read its configuration, which it does as the first participant comes."""
    before = os.environ.get(_URI)
    if not reaches_others():
        os.environ[_URI] = LOOPBACK
    try:
        yield
    finally:
        os.environ.pop(_URI, None)
        if before is not None:
            os.environ[_URI] = before
