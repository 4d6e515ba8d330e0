"""Gateway for clients of a text protocol: each has a state of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

from seatrial.errors import InputError
from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Channel, Endpoint
from seatrial.links.safe_state import HeldChannels, inherited

from ..frame import Frame
from ..operations import Error
from ..safe_state import frames_of
from .gateway import LEAST, RATE, Gateway

LONGEST_LINE = 1000
"""Characters without an end after which they are thrown away."""


class Client(ABC):
    """One client: what it has requested, and what is sent to it."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._unread = b""
        self.refused = 0
        """Lines that were not understood, and texts without an end."""

    def receive(self, data: bytes) -> list[Frame]:
        """Take in bytes; return the frames among them, and answer the rest."""
        *lines, self._unread = (self._unread + data).split(self.end)
        if len(self._unread) > LONGEST_LINE:
            self._unread = b""
            self.refused += 1
        found = []
        for line in lines:
            try:
                frame = self.read(line.decode("ascii", "replace"))
            except (InputError, ValueError, IndexError):
                self.refused += 1
                self.refuse()
                continue
            if frame is not None:
                found.append(frame)
        return found

    def write(self, text: str) -> None:
        """Send a text."""
        self._channel.send(text.encode("ascii"))

    end: bytes
    """What ends a line."""

    @abstractmethod
    def read(self, line: str) -> Frame | None:
        """Carry out a line; return the frame if it is one. May raise ValueError or IndexError."""

    @abstractmethod
    def refuse(self) -> None:
        """Report that a line was not understood."""

    @abstractmethod
    def send(self, time_ns: int, frame: Frame) -> None:
        """Send a frame, if that is wanted."""

    def send_error(self, time_ns: int, error: Error) -> None:
        """Report an error frame, if that is wanted and the protocol can."""
        del time_ns, error

    def written(self, frames: Sequence[Frame]) -> bytes:
        """Return what `send` would send of some frames now."""
        channel, collected = self._channel, _Collecting()
        self._channel = collected
        try:
            for frame in frames:
                self.send(0, frame)
        finally:
            self._channel = channel
        return bytes(collected.data)

    def finish(self) -> None:  # noqa: B027  most keep nothing back
        """Send what was kept back: nothing follows."""

    def tick(self) -> None:  # noqa: B027  most have nothing to do
        """Do what is due by wall time."""


class _Collecting(Channel):
    def __init__(self) -> None:
        self.data = bytearray()

    def send(self, data: bytes) -> None:
        self.data += data


class ClientsGateway(Gateway):
    """Serves the peers of an endpoint, each as a ``client`` of its own."""

    def __init__(self, endpoint: Endpoint, client: Callable[[Channel], Client]) -> None:
        self._endpoint, self._client = endpoint, client
        self.budget = endpoint.budget = Budget(RATE, LEAST)
        self._clients: dict[Channel, Client] = {}
        self._numbers: dict[Channel, int] = {}
        self._next = 0
        self._held: HeldChannels | None = None

    @property
    def clients(self) -> int:
        """Number of clients connected."""
        return len(self._clients)

    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, and each one's sender."""
        arrived = self._endpoint.poll()
        self._greet([*self._endpoint.channels(), *(channel for channel, _ in arrived)])
        found = []
        for channel, data in arrived:
            client = self._clients[channel]
            before = client.refused
            frames = client.receive(data)
            self.refused += client.refused - before
            found += [(self._numbers[channel], frame) for frame in frames]
        self._forget(
            self._endpoint.channels()
        )  # a client that is gone may have sent something before
        for client in self._clients.values():
            client.tick()
        return found

    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send a frame to all but ``sender``."""
        for channel, client in self._clients.items():
            if self._numbers[channel] != sender:
                client.send(time_ns, frame)

    def send_error(self, time_ns: int, error: Error) -> None:
        """Report an error frame to all."""
        for client in self._clients.values():
            client.send_error(time_ns, error)

    def keep(self, name: str, frames: str) -> None:
        """Hold frames for every client, as far as it receives any."""
        if not inherited():
            return
        self._greet(self._endpoint.channels())
        self._held = self._held or HeldChannels(name)
        wanted = frames_of(frames)
        self._held.keep([self._endpoint], lambda channel: self._clients[channel].written(wanted))

    def close(self) -> None:
        """Close all connections."""
        if self._held is not None:
            self._held.release()
        for client in self._clients.values():
            client.finish()
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
