"""Endpoint interface: peers are found and polled, never waited for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

LARGEST_DATAGRAM = 65536
MOST_READS = 256
"""Reads from one endpoint in one poll: a flood must not stop the simulation."""


class Channel(ABC):
    """One peer behind an endpoint: bytes come from it and go to it."""

    @abstractmethod
    def send(self, data: bytes) -> None:
        """Send one frame; it is lost silently if the peer takes no more or is gone."""


class Endpoint(ABC):
    """One URL. What has gone wrong on the way is no error here: protocols repeat themselves."""

    url: str
    """As it is bound: with the port's number where 0 was given."""

    @abstractmethod
    def channels(self) -> Sequence[Channel]:
        """Return the peers that there are now."""

    @abstractmethod
    def poll(self) -> list[tuple[Channel, bytes]]:
        """Return what has arrived, in order; connect and accept on the way."""

    @abstractmethod
    def close(self) -> None:
        """Let go of sockets and ports."""
