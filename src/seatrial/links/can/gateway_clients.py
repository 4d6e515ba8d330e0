"""A gateway with clients who speak a protocol of text: each has a state of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from ...errors import InputError
from ..endpoints.endpoint import Channel, Endpoint
from .frame import Frame
from .gateway import Gateway
from .operations import Error

LONGEST_LINE = 1000
"""Characters without an end after which they are thrown away."""


class Client(ABC):
    """What one client has asked for, and what it is told."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._unread = b""

    def receive(self, data: bytes) -> list[Frame]:
        """Take in bytes; return the frames among them, and answer the rest."""
        *lines, self._unread = (self._unread + data).split(self.end)
        if len(self._unread) > LONGEST_LINE:
            self._unread = b""
        found = []
        for line in lines:
            try:
                frame = self.read(line.decode("ascii", "replace"))
            except (InputError, ValueError, IndexError):
                self.refuse()
                continue
            if frame is not None:
                found.append(frame)
        return found

    def say(self, text: str) -> None:
        """Send a text."""
        self._channel.send(text.encode("ascii"))

    end: bytes
    """What ends a line."""

    @abstractmethod
    def read(self, line: str) -> Frame | None:
        """Carry out a line; return the frame if it is one. May raise ValueError or IndexError."""

    @abstractmethod
    def refuse(self) -> None:
        """Say that a line was not understood."""

    @abstractmethod
    def send(self, time_ns: int, frame: Frame) -> None:
        """Tell of a frame, if that is wanted."""

    def send_error(self, time_ns: int, error: Error) -> None:
        """Tell of an error frame, if that is wanted and there is a word for it."""
        del time_ns, error

    def tick(self) -> None:  # noqa: B027  most have nothing to do
        """Do what is due by wall time."""


class ClientsGateway(Gateway):
    """Serves the peers of an endpoint, each as a ``client`` of its own."""

    def __init__(self, endpoint: Endpoint, client: Callable[[Channel], Client]) -> None:
        self._endpoint, self._client = endpoint, client
        self._clients: dict[Channel, Client] = {}
        self._numbers: dict[Channel, int] = {}
        self._next = 0

    @property
    def clients(self) -> int:
        """How many are connected."""
        return len(self._clients)

    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, and who sent each."""
        arrived = self._endpoint.poll()
        self._greet([*self._endpoint.channels(), *(channel for channel, _ in arrived)])
        found = []
        for channel, data in arrived:
            frames = self._clients[channel].receive(data)
            found += [(self._numbers[channel], frame) for frame in frames]
        self._forget(self._endpoint.channels())  # whoever is gone may have said something before
        for client in self._clients.values():
            client.tick()
        return found

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Tell all but ``sender`` of a frame."""
        for channel, client in self._clients.items():
            if self._numbers[channel] != sender:
                client.send(time_ns, frame)

    def send_error(self, time_ns: int, error: Error) -> None:
        """Tell all of an error frame."""
        for client in self._clients.values():
            client.send_error(time_ns, error)

    def close(self) -> None:
        """Close all connections."""
        self._endpoint.close()

    def _greet(self, present: Sequence[Channel]) -> None:
        for channel in present:
            if channel not in self._clients:
                self._clients[channel] = self._client(channel)
                self._numbers[channel] = self._next
                self._next += 1

    def _forget(self, present: Sequence[Channel]) -> None:
        for channel in [each for each in self._clients if each not in present]:
            del self._clients[channel], self._numbers[channel]
