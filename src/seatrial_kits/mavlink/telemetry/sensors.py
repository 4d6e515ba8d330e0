"""Sensor telemetry: satellites, inertia, pressure, wind."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.model.unit_table import STANDARD_GRAVITY

from ..codec import Message
from ..scaling import (
    FRESH_WATER,
    STANDARD_PRESSURE,
    UNKNOWN_16,
    UNKNOWN_U16,
    compass_degrees,
    deg_e7,
    int16,
    int32,
    microseconds,
    milliseconds,
    turned,
    uint16,
)
from ..service import Service, builds
from ..vehicle import NO_FIX

_ACCELERATION, _RATES, _PRESSURE = 0x7, 0x38, 0x200
"""Of HIGHRES_IMU's fields_updated."""
_NONE = (0.0, 0.0, 0.0)
_FARTHEST_CM = 0xFFFF


class SensorTelemetry(Service):
    """GPS_RAW_INT, SCALED_IMU, HIGHRES_IMU, SCALED_PRESSURE2 (of the water, in a submarine),
    DISTANCE_SENSOR (downwards), WIND and WIND_COV, NAMED_VALUE_FLOAT.

    The true wind is the apparent one, which is measured in the horizontal plane here, turned
    by the heading, plus the vehicle's velocity. A sensor that is lost sends nothing.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 0.5,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU: 0.5,
        mavlink.MAVLINK_MSG_ID_HIGHRES_IMU: 0.5,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2: 1.0,
        mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.5,
        mavlink.MAVLINK_MSG_ID_WIND: 1.0,
        mavlink.MAVLINK_MSG_ID_WIND_COV: 1.0,
        mavlink.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT: 0.5,
    }

    @builds(mavlink.MAVLINK_MSG_ID_GPS_RAW_INT)
    def _gps(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        dives = self.vehicle.identity.submerged and not e.position_valid
        if dives or "position" not in e.connected:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(e.position_n)
        north, east, _ = e.velocity_n
        course = round(compass_degrees(math.atan2(east, north)) * 100) % 36000
        moves = "velocity" in e.begun
        receiver = self.vehicle.receiver if e.position_valid else NO_FIX
        return [
            mavlink.MAVLink_gps_raw_int_message(
                microseconds(now),
                receiver.fix,
                deg_e7(latitude),
                deg_e7(longitude),
                int32(altitude * 1e3),
                UNKNOWN_U16 if receiver.hdop is None else uint16(receiver.hdop * 100),
                UNKNOWN_U16,
                uint16(math.hypot(north, east) * 100) if moves else UNKNOWN_U16,
                course if moves else UNKNOWN_U16,
                receiver.satellites,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_SCALED_IMU)
    def _scaled_imu(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not (e.accelerometer_valid and e.gyro_valid):
            return []
        return [
            mavlink.MAVLink_scaled_imu_message(
                milliseconds(now),
                *(int16(a / STANDARD_GRAVITY * 1e3) for a in e.specific_force),
                *(int16(w * 1e3) for w in e.rates),
                0,
                0,
                0,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_HIGHRES_IMU)
    def _highres_imu(self, now: float) -> list[Message]:
        e, pressure = self.vehicle.estimates, self._pressure()
        measured = (
            (e.accelerometer_valid, _ACCELERATION),
            (e.gyro_valid, _RATES),
            (pressure is not None, _PRESSURE),
        )
        updated = sum(bits for is_there, bits in measured if is_there)
        if not updated:
            return []
        return [
            mavlink.MAVLink_highres_imu_message(
                microseconds(now),
                *(e.specific_force if e.accelerometer_valid else _NONE),
                *(e.rates if e.gyro_valid else _NONE),
                0.0,
                0.0,
                0.0,
                0.0 if pressure is None else pressure / 100.0,
                0.0,
                0.0,
                0.0,
                updated,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2)
    def _scaled_pressure(self, now: float) -> list[Message]:
        pressure = self._pressure()
        if pressure is None:
            return []
        return [
            mavlink.MAVLink_scaled_pressure2_message(
                milliseconds(now), pressure / 100.0, 0.0, UNKNOWN_16
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR)
    def _distance(self, now: float) -> list[Message]:
        distance = self.vehicle.estimates.ground_distance
        if distance is None:
            return []
        return [
            mavlink.MAVLink_distance_sensor_message(
                milliseconds(now),
                0,
                _FARTHEST_CM,
                uint16(distance * 100),
                mavlink.MAV_DISTANCE_SENSOR_ULTRASOUND,
                0,
                mavlink.MAV_SENSOR_ROTATION_PITCH_270,
                0xFF,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_WIND)
    def _wind(self, now: float) -> list[Message]:
        true = self._true_wind()
        if true is None:
            return []
        comes_from = compass_degrees(math.atan2(-true[1], -true[0]))
        return [mavlink.MAVLink_wind_message(comes_from, math.hypot(*true), 0.0)]

    @builds(mavlink.MAVLINK_MSG_ID_WIND_COV)
    def _wind_cov(self, now: float) -> list[Message]:
        true = self._true_wind()
        if true is None:
            return []
        unknown = [math.nan] * 5
        return [mavlink.MAVLink_wind_cov_message(microseconds(now), *true, 0.0, *unknown)]

    @builds(mavlink.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT)
    def _named(self, now: float) -> list[Message]:
        return [
            mavlink.MAVLink_named_value_float_message(milliseconds(now), name.encode(), value)
            for name, value in self.vehicle.estimates.named
        ]

    def _pressure(self) -> float | None:
        """Return the absolute pressure of the water, Pa."""
        depth = self.vehicle.estimates.depth
        return None if depth is None else STANDARD_PRESSURE + FRESH_WATER * STANDARD_GRAVITY * depth

    def _true_wind(self) -> tuple[float, float] | None:
        """Return where the wind blows to, north and east, m/s."""
        e = self.vehicle.estimates
        if e.apparent_wind is None or not (e.heading_valid and e.has("velocity")):
            return None
        speed, angle = e.apparent_wind
        north, east = turned(e.attitude[2], speed * math.cos(angle), speed * math.sin(angle))
        return north + e.velocity_n[0], east + e.velocity_n[1]
