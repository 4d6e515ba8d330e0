"""Board telemetry: what the hardware of an autopilot reports beside its estimates."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned
from seatrial.model.unit_table import STANDARD_GRAVITY

from ..codec import Message
from ..scaling import deg_e7, int16, microseconds, milliseconds
from ..service import Service, builds
from ..transport import Transport
from ..vehicle import Vehicle

_SUPPLY_MV = 5000
"""Of the electronics and of the servos, assumed."""
_SMOOTHING = 0.1
_CLIPS = 16.0 * STANDARD_GRAVITY
"""Specific force at which an accelerometer of the usual range clips, m/s2."""


class BoardTelemetry(Service):
    """RAW_IMU, VIBRATION, POWER_STATUS, AHRS2, RANGEFINDER and, of a boat, WATER_DEPTH.

    RAW_IMU is what SCALED_IMU is, in its units. VIBRATION is how much the specific force scatters
    about its smoothed value. AHRS2 repeats the estimates: there is no second filter. Both distances
    are those of DISTANCE_SENSOR, downwards.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_RAW_IMU: 0.5,
        mavlink.MAVLINK_MSG_ID_VIBRATION: 0.5,
        mavlink.MAVLINK_MSG_ID_POWER_STATUS: 1.0,
        mavlink.MAVLINK_MSG_ID_AHRS2: 0.5,
        mavlink.MAVLINK_MSG_ID_RANGEFINDER: 0.5,
        mavlink.MAVLINK_MSG_ID_WATER_DEPTH: 0.5,
    }

    def __init__(self, vehicle: Vehicle, transport: Transport) -> None:
        super().__init__(vehicle, transport)
        self._smooth: Ned | None = None
        self._vibration = (0.0, 0.0, 0.0)
        self._clipped = [0, 0, 0]

    def tick(self, now: float) -> None:
        """Take in the specific force."""
        e = self.vehicle.estimates
        if not e.accelerometer_valid:
            return
        force = e.specific_force
        self._smooth = self._smooth or force
        x, y, z = (s + _SMOOTHING * (f - s) for f, s in zip(force, self._smooth, strict=True))
        self._smooth = x, y, z
        away = (abs(f - s) for f, s in zip(force, self._smooth, strict=True))
        x, y, z = (v + _SMOOTHING * (a - v) for v, a in zip(self._vibration, away, strict=True))
        self._vibration = x, y, z
        for axis, each in enumerate(force):
            self._clipped[axis] += abs(each) > _CLIPS

    @builds(mavlink.MAVLINK_MSG_ID_RAW_IMU)
    def _imu(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not (e.accelerometer_valid and e.gyro_valid):
            return []
        force = (int16(a / STANDARD_GRAVITY * 1e3) for a in e.specific_force)
        rates = (int16(w * 1e3) for w in e.rates)
        return [mavlink.MAVLink_raw_imu_message(microseconds(now), *force, *rates, 0, 0, 0)]

    @builds(mavlink.MAVLINK_MSG_ID_VIBRATION)
    def _vibrations(self, now: float) -> list[Message]:
        if not self.vehicle.estimates.has("accelerometer"):
            return []
        return [
            mavlink.MAVLink_vibration_message(microseconds(now), *self._vibration, *self._clipped)
        ]

    @builds(mavlink.MAVLINK_MSG_ID_POWER_STATUS)
    def _power(self, now: float) -> list[Message]:
        flags = mavlink.MAV_POWER_STATUS_BRICK_VALID | mavlink.MAV_POWER_STATUS_SERVO_VALID
        return [mavlink.MAVLink_power_status_message(_SUPPLY_MV, _SUPPLY_MV, flags)]

    @builds(mavlink.MAVLINK_MSG_ID_AHRS2)
    def _second(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not e.position_valid:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(e.position_n)
        place = (altitude, deg_e7(latitude), deg_e7(longitude))
        return [mavlink.MAVLink_ahrs2_message(*e.shown_attitude, *place)]

    @builds(mavlink.MAVLINK_MSG_ID_RANGEFINDER)
    def _range(self, now: float) -> list[Message]:
        distance = self.vehicle.estimates.ground_distance
        return [] if distance is None else [mavlink.MAVLink_rangefinder_message(distance, 0.0)]

    @builds(mavlink.MAVLINK_MSG_ID_WATER_DEPTH)
    def _depth(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if e.ground_distance is None or self.vehicle.identity.submerged or not e.position_valid:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(e.position_n)
        place = (deg_e7(latitude), deg_e7(longitude), altitude)
        return [
            mavlink.MAVLink_water_depth_message(
                milliseconds(now), 0, 1, *place, *e.shown_attitude, e.ground_distance, math.nan
            )
        ]
