"""A gateway: where programs outside meet a simulated bus."""

from __future__ import annotations

from abc import ABC, abstractmethod

from .frame import Frame
from .operations import Error

MOST_FRAMES = 1000
"""Frames taken in by one poll, about: a flood must not stop the simulation."""


class Gateway(ABC):
    """Polled once a step, never waited for. What is lost outside is no error here.

    Whoever is behind it is known by a number: several clients hear each other too.
    """

    reached_at: str
    """What the other side opens, as it is bound: with the port's number where 0 was asked for."""

    @property
    @abstractmethod
    def clients(self) -> int:
        """How many are connected."""

    @abstractmethod
    def poll(self) -> list[tuple[int, Frame]]:
        """Return frames that have arrived, and who sent each; accept and answer on the way."""

    @abstractmethod
    def send(self, time_ns: int, frame: Frame, sender: int | None = None) -> None:
        """Tell all but ``sender`` of a frame that was on the bus at a simulated time."""

    def send_error(self, time_ns: int, error: Error) -> None:
        """Tell all of an error frame, where the protocol has a word for it."""
        del time_ns, error

    @abstractmethod
    def close(self) -> None:
        """Let go of sockets, ports and buses."""
