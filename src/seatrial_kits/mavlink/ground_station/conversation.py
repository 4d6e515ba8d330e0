"""Conversation of a ground station with one vehicle: what came, and asking until it does."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator

from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import SimulationError

from ..codec import Message

Wait = Iterator[str]
"""Yields what it waits for, each time there is nothing else to do."""

ASK_AGAIN_S = 2.0
COMMAND_S = 60.0
"""Simulated time in which a command is accepted: arming waits for the last checks."""
_TEXTS = 5
_LEAST_SEVERE = mavlink.MAV_SEVERITY_NOTICE


class Conversation:
    """The newest message of each name, and a way to send. Times simulated, s."""

    def __init__(self, send: Callable[[Message], None]) -> None:
        self.send = send
        self.newest: dict[str, Message] = {}
        self.now = 0.0
        self.system = 0
        """Of the vehicle, 0 while none is known."""
        self._texts: deque[str] = deque(maxlen=_TEXTS)

    def take(self, message: Message) -> bool:
        """Take a message in; return whether it is the vehicle's."""
        kind, sender = message.get_type(), (message.get_srcSystem(), message.get_srcComponent())
        if kind == "HEARTBEAT" and not self.system and sender[1] == 1:
            self.system = sender[0]
        if sender != (self.system, 1):
            return False
        self.newest[kind] = message
        if kind == "STATUSTEXT" and message.severity <= _LEAST_SEVERE:
            self._texts.append(message.text)
        return True

    def until(
        self,
        holds: Callable[[], bool],
        what: str,
        limit: float,
        ask: Callable[[], None] | None = None,
    ) -> Wait:
        """Wait until something holds, and ``ask`` for it again and again.

        Raises SimulationError, with what the vehicle said last, after ``limit``.
        """
        begun = asked = self.now
        if ask is not None and not holds():
            ask()
        while not holds():
            if self.now - begun > limit:
                said = "; ".join(self._texts) or "nothing"
                raise SimulationError(f"no {what} within {limit:g} s; the vehicle said: {said}")
            if ask is not None and self.now - asked >= ASK_AGAIN_S:
                asked = self.now
                ask()
            yield what

    def command(self, number: int, what: str, *parameters: float) -> Wait:
        """Send a command until it is accepted. Raises SimulationError."""
        seven = (*parameters, *(0.0,) * (7 - len(parameters)))
        order = mavlink.MAVLink_command_long_message(self.system, 1, number, 0, *seven)
        self.newest.pop("COMMAND_ACK", None)
        yield from self.until(
            lambda: self._is_accepted(number), what, COMMAND_S, lambda: self.send(order)
        )

    def request(self, name: str, rate: float) -> None:
        """Ask for a message ``rate`` times a second."""
        number = getattr(mavlink, f"MAVLINK_MSG_ID_{name}")
        interval = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
        self.send(
            mavlink.MAVLink_command_long_message(
                self.system, 1, interval, 0, number, 1e6 / rate, 0, 0, 0, 0, 0
            )
        )

    def _is_accepted(self, number: int) -> bool:
        answer = self.newest.get("COMMAND_ACK")
        return (
            answer is not None
            and answer.command == number
            and answer.result == mavlink.MAV_RESULT_ACCEPTED
        )
