"""Presence: HEARTBEAT, identity of the vehicle, and status texts."""

from __future__ import annotations

from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..modes import MANUAL_MODES
from ..service import ACCEPTED, Command, Service, builds, on_command
from ..transport import Sender, Transport
from ..vehicle import Vehicle

INTERVAL_S = 1.0
"""Of HEARTBEAT."""

_TEXT_BYTES = 50
_FIRMWARE = {
    "dev": mavlink.FIRMWARE_VERSION_TYPE_DEV,
    "alpha": mavlink.FIRMWARE_VERSION_TYPE_ALPHA,
    "beta": mavlink.FIRMWARE_VERSION_TYPE_BETA,
    "rc": mavlink.FIRMWARE_VERSION_TYPE_RC,
    "": mavlink.FIRMWARE_VERSION_TYPE_OFFICIAL,
}


class PresenceService(Service):
    """HEARTBEAT every second and whenever mode or arming change, AUTOPILOT_VERSION, STATUSTEXT.

    A sentence of more than 50 bytes goes out in pieces with a common id.
    """

    capabilities = (
        mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2 | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    )
    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_HEARTBEAT: INTERVAL_S}

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        super().__init__(vehicle, transport)
        self._reported = (vehicle.mode, vehicle.armed, vehicle.failsafe)
        self._text_id = 0

    def tick(self, now: float) -> None:
        """Send at once what has changed, and the status texts."""
        state = (self.vehicle.mode, self.vehicle.armed, self.vehicle.failsafe)
        if state != self._reported:
            self._reported = state
            self.transport.broadcast(self._heartbeat(now)[0])
        for text in self.vehicle.texts:
            for message in self._pieces(text.severity, text.text.encode()):
                self.transport.broadcast(message)
        self.vehicle.texts.clear()

    def last(self) -> Message:
        """Return the last HEARTBEAT: whatever the vehicle was, nobody drives it any more."""
        return self._made(armed=False, failsafe=False)

    @builds(mavlink.MAVLINK_MSG_ID_HEARTBEAT)
    def _heartbeat(self, now: float) -> list[Message]:
        return [self._made(armed=self.vehicle.armed, failsafe=self.vehicle.failsafe)]

    def _made(self, *, armed: bool, failsafe: bool) -> Message:
        vehicle = self.vehicle
        flags = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        flags |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED if armed else 0
        name = vehicle.mode.name
        if name in MANUAL_MODES:
            flags |= mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        else:
            flags |= mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
        flags |= mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED if name != "manual" else 0
        flags |= mavlink.MAV_MODE_FLAG_AUTO_ENABLED if name in ("auto", "return") else 0
        status = mavlink.MAV_STATE_ACTIVE if armed else mavlink.MAV_STATE_STANDBY
        return mavlink.MAVLink_heartbeat_message(
            vehicle.identity.vehicle_type,
            vehicle.dialect.autopilot,
            flags,
            vehicle.mode.custom_mode,
            mavlink.MAV_STATE_CRITICAL if failsafe else status,
            3,
        )

    @builds(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    def _version(self, now: float) -> list[Message]:
        identity = self.vehicle.identity
        return [
            mavlink.MAVLink_autopilot_version_message(
                self.vehicle.capabilities,
                firmware_number(self.vehicle.dialect.version),
                0,
                0,
                0,
                custom_version(identity.firmware_version, self.vehicle.dialect.autopilot),
                [0] * 8,
                [0] * 8,
                0,
                0,
                identity.uid,
            )
        ]

    @on_command(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES)
    def _send_version(self, command: Command, sender: Sender, now: float) -> int:
        self.transport.send(sender.link, self._version(now)[0])
        return ACCEPTED

    def _pieces(self, severity: int, text: bytes) -> list[Message]:
        if len(text) <= _TEXT_BYTES:
            return [mavlink.MAVLink_statustext_message(severity, text)]
        self._text_id = self._text_id % 0xFFFF + 1
        # A piece of full length goes on; so the last one is shorter, if only an empty one.
        starts = range(0, len(text) + 1, _TEXT_BYTES)
        return [
            mavlink.MAVLink_statustext_message(
                severity, text[start : start + _TEXT_BYTES], self._text_id, piece
            )
            for piece, start in enumerate(starts)
        ]


def firmware_number(version: str) -> int:
    """Return ``major.minor.patch`` or ``major.minor.patch-kind`` as AUTOPILOT_VERSION has it."""
    numbers, _, kind = version.partition("-")
    major, minor, patch = (int(part) % 256 for part in numbers.split("."))
    return major << 24 | minor << 16 | patch << 8 | int(_FIRMWARE[kind])


def custom_version(version: str, autopilot: int) -> list[int]:
    """Return ``major.minor.patch-kind`` as AUTOPILOT_VERSION's 8 bytes for a vendor's own version.

    Of a PX4 stations read three numbers from the last to the first, of an ArduPilot text.
    """
    if autopilot == mavlink.MAV_AUTOPILOT_PX4:
        numbers = version.partition("-")[0].split(".")
        return [*(int(number) % 256 for number in reversed(numbers)), *[0] * 5]
    return list(version.replace("-", "").encode("ascii")[:8].ljust(8, b"\0"))
