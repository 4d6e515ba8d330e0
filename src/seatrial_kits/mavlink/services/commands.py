"""Commands: COMMAND_LONG and COMMAND_INT to their services, and always an answer."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..frames import GLOBAL_FRAMES, LOCAL_FRAMES
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    UNSUPPORTED,
    WARNING,
    Command,
    Handler,
    Service,
    on_message,
)
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

    @on_message(mavlink.MAVLINK_MSG_ID_COMMAND_LONG)
    def _take_long(self, message: Message, sender: Sender, now: float) -> None:
        self._carry_out(_of_long(message), sender, now)

    @on_message(mavlink.MAVLINK_MSG_ID_COMMAND_INT)
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


_NOTHING = "Nothing is on board for that command"
_ABSENT: Mapping[int, int] = {
    getattr(mavlink, f"MAV_CMD_{name}"): result
    for result, names in (
        (FAILED, "DO_MOUNT_CONFIGURE DO_MOUNT_CONTROL DO_MOTOR_TEST DO_GRIPPER DO_JUMP_TAG"),
        (FAILED, "DO_GIMBAL_MANAGER_PITCHYAW IMAGE_START_CAPTURE VIDEO_START_CAPTURE"),
        (FAILED, "DO_ACCEPT_MAG_CAL ACCELCAL_VEHICLE_POS"),
        (DENIED, "PREFLIGHT_STORAGE SET_EKF_SOURCE_SET DEBUG_TRAP SCRIPTING"),
    )
    for name in names.split()
}
"""Commands of equipment, with the result of an ArduPilot that has none."""
_REASONS: Mapping[int, str] = {
    mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: (
        "No reboot: this vehicle is simulated; start the trial again"
    ),
    mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: (
        "No calibration: the errors of simulated sensors belong to the trial"
    ),
    mavlink.MAV_CMD_DO_SET_SERVO: "No servo is set: all outputs are the autopilot's",
    mavlink.MAV_CMD_DO_REPEAT_SERVO: "No servo is set: all outputs are the autopilot's",
    mavlink.MAV_CMD_DO_SET_RELAY: "There are no relays",
    mavlink.MAV_CMD_DO_REPEAT_RELAY: "There are no relays",
}


_SERVOS = (mavlink.MAV_CMD_DO_SET_SERVO, mavlink.MAV_CMD_DO_REPEAT_SERVO)


class RefusalService(Service):
    """Denies reboot, calibration, servos and relays, refuses SETUP_SIGNING, with the reason."""

    @property
    def commands(self) -> Mapping[int, Handler]:
        """Commands that it refuses."""
        absent = dict.fromkeys(_ABSENT, self._miss) if self.vehicle.dialect.is_ardupilot else {}
        return dict.fromkeys(_REASONS, self._refuse) | absent

    @on_message(mavlink.MAVLINK_MSG_ID_SETUP_SIGNING)
    def _refuse_key(self, message: Message, sender: Sender, now: float) -> None:
        self.vehicle.report(WARNING, "No key is taken over a link: give it in signing_key_file")

    def _miss(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.report(WARNING, f"{_NOTHING} ({command.number})")
        return _ABSENT[command.number]

    def _refuse(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.report(WARNING, _REASONS[command.number])
        is_servo = command.number in _SERVOS and self.vehicle.dialect.is_ardupilot
        return FAILED if is_servo else DENIED
