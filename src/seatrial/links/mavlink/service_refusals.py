"""Commands that vehicles like this one know and this one refuses, with the reason."""

from __future__ import annotations

from collections.abc import Mapping

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .service import DENIED, WARNING, Command, Handler, Service
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
    """Denies reboot, calibration, servos and relays, refuses SETUP_SIGNING, and says why."""

    @property
    def commands(self) -> Mapping[int, Handler]:
        """Commands that it refuses."""
        return dict.fromkeys(_REASONS, self._refuse)

    def handle(self, message: Message, sender: Sender, now: float) -> None:
        """Refuse a key."""
        if message.get_type() == "SETUP_SIGNING":
            self.vehicle.say(WARNING, "No key is taken over a link: give it in signing_key_file")

    def _refuse(self, command: Command, sender: Sender, now: float) -> int:
        self.vehicle.say(WARNING, _REASONS[command.number])
        return DENIED
