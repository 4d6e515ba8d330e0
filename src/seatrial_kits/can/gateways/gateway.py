"""Gateway interface between a simulated bus and programs outside."""

from __future__ import annotations

from abc import ABC, abstractmethod

from seatrial.links.endpoints.budget import Budget

from ..frame import Frame
from ..operations import Error

RATE, LEAST = 150_000.0, 1024
"""Bytes per second, and in one poll at least: as text, more than a full bus of 250 kbit/s."""
FRAME_BYTES = 16
"""What a frame of a bus is taken for, whose bytes nobody sees: so a full one of 1 Mbit/s fits."""


class Gateway(ABC):
    """Polled once a step, never waited for. What is lost outside is no error here.

    Clients behind it are known by numbers: several receive each other too.
    """

    budget: Budget
    """What one poll takes in."""
    is_lost = False
    """Whether the bus was there and is gone."""
    reconnections = 0
    """How often it came back."""
    refused = 0
    """Lines, datagrams and frames from outside that were none."""
    reached_at: str
    """What the other side opens, as it is bound: with the port's number where 0 was given."""

    @property
    @abstractmethod
    def clients(self) -> int:
        """Number of clients connected."""

    @abstractmethod
    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, and each one's sender; accept and answer on the way."""

    @abstractmethod
    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Send all but ``sender`` a frame that was on the bus at a simulated time."""

    def send_error(self, time_ns: int, error: Error) -> None:
        """Report an error frame to all, where the protocol can."""
        del time_ns, error

    def keep(self, name: str, frames: str) -> None:
        """Hold frames (`safe_state`) of the component ``name`` for whoever supervises this process.

        Called every step, as clients come and go; `close` releases them. Where nobody but this
        process can send anything, nothing is held.
        """
        del name, frames

    @abstractmethod
    def close(self) -> None:
        """Let go of sockets, ports and buses."""
