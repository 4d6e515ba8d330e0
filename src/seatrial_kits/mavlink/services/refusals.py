"""Commands that vehicles like this one know and this one refuses, with the reason."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..service import DENIED, FAILED, WARNING, Command, Handler, Receiver, Service
from ..transport import Sender

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

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {mavlink.MAVLINK_MSG_ID_SETUP_SIGNING: self._refuse_key}

    def _refuse_key(self, message: Message, sender: Sender, now: float) -> None:
        self.vehicle.report(WARNING, "No key is taken over a link: give it in signing_key_file")

    def _miss(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.report(WARNING, f"{_NOTHING} ({command.number})")
        return _ABSENT[command.number]

    def _refuse(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.report(WARNING, _REASONS[command.number])
        is_servo = command.number in _SERVOS and self.vehicle.dialect.is_ardupilot
        return FAILED if is_servo else DENIED
