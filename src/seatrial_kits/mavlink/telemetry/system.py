"""System telemetry: health, time, servo outputs, radio channels."""

from __future__ import annotations

from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..scaling import UNKNOWN_U16, clamped, int16, microseconds, milliseconds, uint16
from ..service import Service, builds
from ..services.manual_control import shown_channels


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

    @builds(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
    def _status(self, now: float) -> list[Message]:
        e, dives = self.vehicle.estimates, self.vehicle.identity.submerged
        fixes = "position" in e.connected and (e.position_valid or not dives)
        sensors = (
            (mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO, "gyro" in e.connected, e.gyro_valid),
            (
                mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL,
                "accelerometer" in e.connected,
                e.accelerometer_valid,
            ),
            (mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG, "heading" in e.connected, e.heading_valid),
            (
                mavlink.MAV_SYS_STATUS_AHRS,
                bool(e.connected & {"tilt", "heading"}),
                e.tilt_valid and e.heading_valid,
            ),
            (mavlink.MAV_SYS_STATUS_SENSOR_GPS, fixes, e.position_valid),
            (
                mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE,
                dives and "depth" in e.connected,
                e.depth is not None,
            ),
            (mavlink.MAV_SYS_STATUS_SENSOR_BATTERY, e.voltage is not None, True),
            # There always, or a ground station reports a breach.
            (mavlink.MAV_SYS_STATUS_GEOFENCE, True, not self.vehicle.fence_breached),
            (mavlink.MAV_SYS_STATUS_PREARM_CHECK, True, self.vehicle.healthy),
        )
        present = sum(bit for bit, is_there, _ in sensors if is_there)
        healthy = sum(bit for bit, is_there, is_good in sensors if is_there and is_good)
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

    @builds(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME)
    def _time(self, now: float) -> list[Message]:
        unix = self.vehicle.identity.boot_unix_us + microseconds(now)
        return [mavlink.MAVLink_system_time_message(unix, milliseconds(now))]

    @builds(mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE)
    def _landed(self, now: float) -> list[Message]:
        on_ground = mavlink.MAV_LANDED_STATE_ON_GROUND  # what never flies has landed
        return [
            mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, on_ground)
        ]

    @builds(mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW)
    def _servos(self, now: float) -> list[Message]:
        pulses = [uint16(pulse * 1e6) for pulse in self.vehicle.estimates.pulses]
        time = microseconds(now) % (1 << 32)
        return [mavlink.MAVLink_servo_output_raw_message(time, 0, *pulses)]

    @builds(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    def _channels(self, now: float) -> list[Message]:
        channels = [width or UNKNOWN_U16 for width in shown_channels(self.vehicle)]
        return [
            mavlink.MAVLink_rc_channels_message(milliseconds(now), len(channels), *channels, 0xFF)
        ]
