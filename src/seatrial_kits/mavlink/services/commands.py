"""Commands: COMMAND_LONG and COMMAND_INT to their services, and always an answer."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..frames import GLOBAL_FRAMES, LOCAL_FRAMES
from ..service import ACCEPTED, UNSUPPORTED, Command, Handler, Receiver, Service
from ..transport import Sender, Transport
from ..vehicle import Vehicle

_NOT_GIVEN = 0x7FFFFFFF
"""An integer coordinate that stands for not a number."""
_ASKING = (
    mavlink.MAV_CMD_REQUEST_MESSAGE,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_GET_MESSAGE_INTERVAL,
    mavlink.MAV_CMD_GET_HOME_POSITION,
    mavlink.MAV_CMD_RUN_PREARM_CHECKS,
)
"""Commands that change nothing of the vehicle."""


class CommandService(Service):
    """Dispatches commands to ``handlers`` by number and answers with COMMAND_ACK.

    The answer goes to the sender over its own link; a command without a service is
    UNSUPPORTED.
    """

    capabilities = mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT

    def __init__(
        self, vehicle: Vehicle, transport: Transport, handlers: Mapping[int, Handler]
    ) -> None:
        super().__init__(vehicle, transport)
        self._handlers = handlers

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {
            mavlink.MAVLINK_MSG_ID_COMMAND_LONG: self._take_long,
            mavlink.MAVLINK_MSG_ID_COMMAND_INT: self._take_int,
        }

    def _take_long(self, message: Message, sender: Sender, now: float) -> None:
        self._carry_out(_of_long(message), sender, now)

    def _take_int(self, message: Message, sender: Sender, now: float) -> None:
        self._carry_out(_of_int(message), sender, now)

    def _carry_out(self, command: Command, sender: Sender, now: float) -> None:
        handler = self._handlers.get(command.number)
        result = UNSUPPORTED if handler is None else handler(command, sender, now)
        if result == ACCEPTED and command.number not in _ASKING:
            name = mavlink.enums["MAV_CMD"][command.number].name
            self.vehicle.ordered(name, command.parameters)
        answer = mavlink.MAVLink_command_ack_message(
            command.number, result, 0, 0, sender.system, sender.component
        )
        self.transport.send(sender.link, answer)


def _of_long(m: Message) -> Command:
    parameters = (m.param1, m.param2, m.param3, m.param4, m.param5, m.param6, m.param7)
    return Command(m.command, parameters, mavlink.MAV_FRAME_GLOBAL)


def _of_int(m: Message) -> Command:
    unit = 1e-7 if m.frame in GLOBAL_FRAMES else 1e-4 if m.frame in LOCAL_FRAMES else 1.0
    x, y = (float("nan") if value == _NOT_GIVEN else value * unit for value in (m.x, m.y))
    return Command(m.command, (m.param1, m.param2, m.param3, m.param4, x, y, m.z), m.frame)
