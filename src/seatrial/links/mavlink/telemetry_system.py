"""System telemetry: health, time, servo outputs, radio channels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .scaling import UNKNOWN_U16, clamped, int16, microseconds, milliseconds, uint16
from .service import Builder, Service
from .service_manual_control import shown_channels

_IMU = mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
_HEADING = mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG | mavlink.MAV_SYS_STATUS_AHRS


class SystemTelemetry(Service):
    """SYS_STATUS, SYSTEM_TIME, EXTENDED_SYS_STATE, SERVO_OUTPUT_RAW and RC_CHANNELS.

    Axes of MANUAL_CONTROL are shown as the channels that would have the same effect, as an
    ArduPilot shows them.

    Health comes from the validity of the estimates. Simulated time counts from the Unix time of
    the vehicle's day, so that two runs send the same.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_SYS_STATUS: 0.5,
        mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
        mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: 1.0,
        mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: 0.25,
        mavlink.MAVLINK_MSG_ID_RC_CHANNELS: 0.5,
    }

    @property
    def messages(self) -> Mapping[int, Builder]:
        """Messages that it can build."""
        return {
            mavlink.MAVLINK_MSG_ID_SYS_STATUS: self._status,
            mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: self._time,
            mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: self._landed,
            mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: self._servos,
            mavlink.MAVLINK_MSG_ID_RC_CHANNELS: self._channels,
        }

    def _status(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        present = _IMU | _HEADING | mavlink.MAV_SYS_STATUS_PREARM_CHECK
        healthy = (_IMU if e.imu_valid else 0) | (_HEADING if e.heading_valid else 0)
        present |= mavlink.MAV_SYS_STATUS_GEOFENCE  # or a ground station reports a breach
        if not self.vehicle.fence_breached:
            healthy |= mavlink.MAV_SYS_STATUS_GEOFENCE
        if self.vehicle.healthy:
            healthy |= mavlink.MAV_SYS_STATUS_PREARM_CHECK
        if e.position_valid or not self.vehicle.identity.submerged:
            present |= mavlink.MAV_SYS_STATUS_SENSOR_GPS
        if e.position_valid:
            healthy |= mavlink.MAV_SYS_STATUS_SENSOR_GPS
        for there, bit in (
            (e.voltage is not None, mavlink.MAV_SYS_STATUS_SENSOR_BATTERY),
            (self.vehicle.identity.submerged, mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE),
        ):
            present, healthy = (present | bit, healthy | bit) if there else (present, healthy)
        return [
            mavlink.MAVLink_sys_status_message(
                present,
                present,
                healthy,
                0,
                UNKNOWN_U16 if e.voltage is None else uint16(e.voltage * 1e3),
                -1 if e.current is None else int16(e.current * 100),
                -1 if e.charge is None else clamped(e.charge * 100, 0, 100),
                0,
                0,
                0,
                0,
                0,
                0,
            )
        ]

    def _time(self, now: float) -> list[Message]:
        unix = self.vehicle.identity.boot_unix_us + microseconds(now)
        return [mavlink.MAVLink_system_time_message(unix, milliseconds(now))]

    def _landed(self, now: float) -> list[Message]:
        on_ground = mavlink.MAV_LANDED_STATE_ON_GROUND  # what never flies has landed
        return [
            mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, on_ground)
        ]

    def _servos(self, now: float) -> list[Message]:
        pulses = [uint16(pulse * 1e6) for pulse in self.vehicle.estimates.pulses]
        time = microseconds(now) % (1 << 32)
        return [mavlink.MAVLink_servo_output_raw_message(time, 0, *pulses)]

    def _channels(self, now: float) -> list[Message]:
        channels = [width or UNKNOWN_U16 for width in shown_channels(self.vehicle)]
        return [
            mavlink.MAVLink_rc_channels_message(milliseconds(now), len(channels), *channels, 0xFF)
        ]
