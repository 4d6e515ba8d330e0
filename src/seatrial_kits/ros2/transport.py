"""Transports of messages, as the link sees them: DDS by itself (`dds`), or a node of rclpy (`rcl`).

Messages are bytes, plain CDR (`packing`), as they are written, and rosbags' classes as they are
read, over either.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Protocol

Durability = Literal["volatile", "latched"]
"""Latched is transient local: those who come later get the last message."""


class Sample(NamedTuple):
    """A message that has come: None if its bytes are none of the type."""

    message: Any
    publisher: int
    """Who wrote it; 0 where the transport does not tell."""


class Endpoint(NamedTuple):
    """A reader or writer of somebody, as it was announced."""

    topic: str
    kind: str
    is_best_effort: bool
    is_latched: bool
    is_ours: bool
    """Whether this process has it."""


@dataclass(frozen=True)
class Call:
    """One call of a service, to be answered once, now or later."""

    request: Any
    answer: Callable[[Mapping[str, Any]], None]


Handler = Callable[[Call], None]


class Writer(Protocol):
    """Writes messages of one kind: reliable, so that readers of either reliability match.

    A message that readers are too slow for is dropped, and counted.
    """

    name: str
    kind: str
    dropped: int

    def write(self, data: bytes) -> None:
        """Write a message of the kind, as bytes (`packing`)."""

    @property
    def readers(self) -> int:
        """Number of readers that match."""


class Reader(Protocol):
    """Reads one topic, reliably."""

    def take(self, most: int) -> list[Sample]:
        """Return messages that have come since."""

    @property
    def publishers(self) -> int:
        """Number of publishers that match."""


class Service(Protocol):
    """A service of the link's own."""

    def serve(self) -> None:
        """Answer the calls that have come; what is no request is dropped."""


class Transport(Protocol):
    """Membership of a domain; topics by their names in ROS, ``/otter/imu/data``."""

    domain: int
    title: str
    """Package and middleware, for people."""

    def lacks(self, kind: str) -> str:
        """Return why messages of the kind cannot be had here, empty if they can."""

    def writer(self, topic: str, kind: str, durability: Durability = "volatile") -> Writer:
        """Return a writer of messages."""

    def reader(self, topic: str, kind: str, depth: int = 10) -> Reader:
        """Return a reader that keeps the newest ``depth`` messages."""

    def arrivals(self, readers: Sequence[Any]) -> Callable[[], bool]:
        """Return what says whether any of the readers has messages that were not taken yet."""

    def service(self, name: str, kind: str, handler: Handler) -> Service:
        """Return a service ``name`` of the type ``kind``; ``handler`` answers each call."""

    def announce(self) -> None:
        """Announce readers and writers that have come since as those of the node."""

    def endpoints(
        self, read: Iterable[str], written: Iterable[str]
    ) -> tuple[Iterator[Endpoint], Iterator[Endpoint]]:
        """Return publishers of topics that are read, and of the clock, and subscribers of those
        that are ``written``, as far as they were announced since the last call, or all of them."""

    def close(self) -> None:
        """Leave the domain, and take all topics along: others are notified at once."""
