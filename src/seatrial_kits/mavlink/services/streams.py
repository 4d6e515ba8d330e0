"""Streams: which message goes to which link how often, and single messages on request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    UNSUPPORTED,
    Builder,
    Command,
    Service,
    on_command,
    on_message,
    whole,
)
from ..transport import Sender, Transport
from ..vehicle import Vehicle

_SHORTEST_US, _LONGEST_US = 1_000, 60_000_000
"""Of an interval: below it is refused, above it is this."""
_FIXED = (mavlink.MAVLINK_MSG_ID_HEARTBEAT,)
"""Messages whose rate cannot be changed: presence depends on them."""

_NUMBERED = (mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES,)
"""Messages of which one is requested by its index, from 1; 0 requests all."""

GROUPS: Mapping[int, tuple[int, ...]] = {
    mavlink.MAV_DATA_STREAM_RAW_SENSORS: (
        mavlink.MAVLINK_MSG_ID_RAW_IMU,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2,
    ),
    mavlink.MAV_DATA_STREAM_EXTENDED_STATUS: (
        mavlink.MAVLINK_MSG_ID_SYS_STATUS,
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT,
        mavlink.MAVLINK_MSG_ID_MISSION_CURRENT,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT,
        mavlink.MAVLINK_MSG_ID_POWER_STATUS,
    ),
    mavlink.MAV_DATA_STREAM_RC_CHANNELS: (
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS,
    ),
    mavlink.MAV_DATA_STREAM_POSITION: (
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    ),
    mavlink.MAV_DATA_STREAM_EXTRA1: (
        mavlink.MAVLINK_MSG_ID_ATTITUDE,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION,
        mavlink.MAVLINK_MSG_ID_SIM_STATE,
        mavlink.MAVLINK_MSG_ID_AHRS2,
    ),
    mavlink.MAV_DATA_STREAM_EXTRA2: (mavlink.MAVLINK_MSG_ID_VFR_HUD,),
    mavlink.MAV_DATA_STREAM_EXTRA3: (
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME,
        mavlink.MAVLINK_MSG_ID_BATTERY_STATUS,
        mavlink.MAVLINK_MSG_ID_WIND,
        mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT,
        mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS,
        mavlink.MAVLINK_MSG_ID_VIBRATION,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR,
        mavlink.MAVLINK_MSG_ID_RANGEFINDER,
        mavlink.MAVLINK_MSG_ID_WATER_DEPTH,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE,
    ),
}
"""What REQUEST_DATA_STREAM requests by group; group 0 is all of them."""

_SLACK_S = 1e-9  # what two doubles for one instant may differ by


@dataclass
class _Schedule:
    """Streams of one link: interval and next instant of each message, s."""

    intervals: dict[int, float]
    due: dict[int, float] = field(default_factory=dict)


class StreamService(Service):
    """Sends messages at the intervals that each link requested, and once on request.

    A link starts with ``defaults``. SET_MESSAGE_INTERVAL and REQUEST_DATA_STREAM change the
    streams of the link over which they come, REQUEST_MESSAGE answers over it. Intervals are in
    simulated time, and not shorter than the vehicle's period; an instant that was missed is not
    made up for.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        transport: Transport,
        builders: Mapping[int, Builder],
        defaults: Mapping[int, float],
    ) -> None:
        super().__init__(vehicle, transport)
        self._builders, self._defaults = builders, defaults
        self._schedules: dict[int, _Schedule] = {}

    @on_message(mavlink.MAVLINK_MSG_ID_REQUEST_DATA_STREAM)
    def _change_group(self, message: Message, sender: Sender, now: float) -> None:
        wanted = message.req_message_rate if message.start_stop else 0
        for group, numbers in GROUPS.items():
            if message.req_stream_id in (mavlink.MAV_DATA_STREAM_ALL, group):
                for number in numbers:
                    if number in self._builders:
                        self._change(sender.link, number, 1.0 / wanted if wanted else 0.0)

    def tick(self, now: float) -> None:
        """Send what is due, and forget the links that are gone."""
        links = self.transport.links()
        self._schedules = {link: self._schedule(link) for link in links}
        for link, schedule in self._schedules.items():
            for number, interval in schedule.intervals.items():
                at = self.vehicle.link_time(now) if number in _FIXED else now
                due = schedule.due.get(number, at)
                if at >= due - _SLACK_S:
                    schedule.due[number] = max(due + interval, at)
                    for message in self._builders[number](now):
                        self.transport.send(link, message)

    def _schedule(self, link: int) -> _Schedule:
        if link not in self._schedules:
            self._schedules[link] = _Schedule(dict(self._defaults))
        return self._schedules[link]

    def _change(self, link: int, number: int, interval: float) -> None:
        """Set an interval, s; 0 stops the stream."""
        schedule = self._schedule(link)
        schedule.due.pop(number, None)
        if interval > 0.0:
            schedule.intervals[number] = interval
        else:
            schedule.intervals.pop(number, None)

    @on_command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL)
    def _set_interval(self, command: Command, sender: Sender, now: float) -> int:
        number, interval_us = whole(command.parameters[0]), whole(command.parameters[1])
        if number is None or interval_us is None:
            return DENIED
        if number not in self._builders or number in _FIXED:
            return DENIED
        if interval_us not in (-1, 0) and not _SHORTEST_US <= interval_us < 1 << 31:
            return DENIED
        interval_us = min(interval_us, _LONGEST_US)
        interval = self._defaults.get(number, 0.0) if interval_us == 0 else interval_us * 1e-6
        self._change(sender.link, number, interval)
        return ACCEPTED

    @on_command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL)
    def _send_interval(self, command: Command, sender: Sender, now: float) -> int:
        number = whole(command.parameters[0])
        if number is None:
            return DENIED
        interval = self._schedule(sender.link).intervals.get(number)
        stopped = -1 if number in self._builders else 0
        interval_us = stopped if interval is None else round(interval * 1e6)
        self.transport.send(
            sender.link, mavlink.MAVLink_message_interval_message(number & 0xFFFF, interval_us)
        )
        return ACCEPTED if number in self._builders else FAILED

    @on_command(mavlink.MAV_CMD_REQUEST_MESSAGE)
    def _send_once(self, command: Command, sender: Sender, now: float) -> int:
        number, index = whole(command.parameters[0]), whole(command.parameters[1]) or 0
        if number is None or number not in self._builders:
            return FAILED if self.vehicle.dialect.is_ardupilot else UNSUPPORTED
        built = self._builders[number](now)
        if number in _NUMBERED and index != 0:
            built = built[index - 1 : index] if index > 0 else []
        for message in built:
            self.transport.send(sender.link, message)
        return ACCEPTED if built else DENIED
