"""A service: one protocol of MAVLink over the state of the vehicle."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .transport import Sender, Transport
from .vehicle import Vehicle


@dataclass(frozen=True)
class Command:
    """A COMMAND_LONG or COMMAND_INT: the same to all but those that have a position."""

    number: int
    """MAV_CMD."""
    parameters: tuple[float, float, float, float, float, float, float]
    """Parameters 1 to 7 as sent; 5 and 6 in degrees if they were integers of a global frame."""
    frame: int
    """MAV_FRAME; of COMMAND_LONG, which has none, global."""


Handler = Callable[[Command, Sender, float], int]
"""Carries a command out at a simulated time, s, and returns MAV_RESULT."""
Receiver = Callable[[Message, Sender, float], None]
"""Takes a message in at a simulated time, s."""
Builder = Callable[[float], list[Message]]
"""Returns a message's content at a simulated time, s; nothing if there is none."""
M = TypeVar("M", bound=Callable[..., Any])


def _mark(name: str, numbers: tuple[int, ...]) -> Callable[[M], M]:
    def marked(method: M) -> M:
        setattr(method, name, numbers)
        return method

    return marked


def on_command(*numbers: int) -> Callable[[M], M]:
    """Mark the `Handler` of commands, by MAV_CMD."""
    return _mark("on_command", numbers)


def on_message(*numbers: int) -> Callable[[M], M]:
    """Mark the `Receiver` of messages, by number."""
    return _mark("on_message", numbers)


def builds(*numbers: int) -> Callable[[M], M]:
    """Mark the `Builder` of messages, by number."""
    return _mark("builds", numbers)


class Service:
    """Base of the services.

    A service takes in the messages of its ``receivers``, by number, among those that are meant for
    this vehicle, and every instant (`tick`). It offers ``commands`` by MAV_CMD and ``messages`` by
    number to whoever asks for them or streams them, and sends through ``transport``. Times are
    simulated, s, and never run backwards.
    """

    capabilities: ClassVar[int] = 0
    """What it adds to MAV_PROTOCOL_CAPABILITY."""
    streams: ClassVar[Mapping[int, float]] = {}
    """Messages that every link gets unless it requests something else: interval, s."""

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        self.vehicle, self.transport = vehicle, transport

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in, by number: methods marked with `on_message`."""
        return self._marked("on_message")

    @property
    def commands(self) -> Mapping[int, Handler]:
        """Commands that it carries out: methods marked with `on_command`."""
        return self._marked("on_command")

    @property
    def messages(self) -> Mapping[int, Builder]:
        """Messages that it can build: methods marked with `builds`."""
        return self._marked("builds")

    def _marked(self, mark: str) -> dict[int, Any]:
        return {
            number: getattr(self, name)
            for kind in reversed(type(self).__mro__)
            for name, each in vars(kind).items()
            for number in getattr(each, mark, ())
        }

    def tick(self, now: float) -> None:
        """Let time pass: called once per instant, after its messages."""


ACCEPTED: int = mavlink.MAV_RESULT_ACCEPTED
DENIED: int = mavlink.MAV_RESULT_DENIED
UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED
FAILED: int = mavlink.MAV_RESULT_FAILED

INFO: int = mavlink.MAV_SEVERITY_INFO
NOTICE: int = mavlink.MAV_SEVERITY_NOTICE
WARNING: int = mavlink.MAV_SEVERITY_WARNING
CRITICAL: int = mavlink.MAV_SEVERITY_CRITICAL


def whole(value: float) -> int | None:
    """Return a parameter that should be a whole number as one, None if it is none."""
    return round(value) if math.isfinite(value) and abs(value) < 2.0**53 else None
