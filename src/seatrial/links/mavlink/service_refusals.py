"""Commands that vehicles like this one know and this one refuses, with the reason."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .service import DENIED, WARNING, Command, Handler, Receiver, Service
from .transport import Sender

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


class RefusalService(Service):
    """Denies reboot, calibration, servos and relays, refuses SETUP_SIGNING, with the reason."""

    @property
    def commands(self) -> Mapping[int, Handler]:
        """Commands that it refuses."""
        return dict.fromkeys(_REASONS, self._refuse)

    @property
    def receivers(self) -> Mapping[int, Receiver]:
        """Messages that it takes in."""
        return {
            mavlink.MAVLINK_MSG_ID_SETUP_SIGNING: self._refuse_key,
        }

    def _refuse_key(self, message: Message, sender: Sender, now: float) -> None:
        self.vehicle.report(WARNING, "No key is taken over a link: give it in signing_key_file")

    def _refuse(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.report(WARNING, _REASONS[command.number])
        return DENIED
