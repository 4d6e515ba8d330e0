"""Motion telemetry: attitude, position, velocity, home, truth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from .codec import Message
from .modes import MANUAL_MODES
from .scaling import (
    compass_degrees,
    deg_e7,
    int16,
    int32,
    microseconds,
    milliseconds,
    quaternion,
    uint16,
)
from .service import Builder, Service

_NO_QUATERNION = [math.nan, 0.0, 0.0, 0.0]


class MotionTelemetry(Service):
    """ATTITUDE, ATTITUDE_QUATERNION, LOCAL_POSITION_NED, GLOBAL_POSITION_INT, VFR_HUD, ALTITUDE,
    and SIM_STATE, the truth beside the estimates, if it is known.

    A boat without a valid position sends none; a submarine gives its depth, as
    negative altitude, at latitude and longitude 0, which ground stations take for none.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_ATTITUDE: 0.1,
        mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 0.25,
        mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: 0.2,
        mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: 0.2,
        mavlink.MAVLINK_MSG_ID_VFR_HUD: 0.25,
        mavlink.MAVLINK_MSG_ID_ALTITUDE: 1.0,
        mavlink.MAVLINK_MSG_ID_SIM_STATE: 0.25,
    }

    @property
    def messages(self) -> Mapping[int, Builder]:
        """Messages that it can build."""
        return {
            mavlink.MAVLINK_MSG_ID_ATTITUDE: self._attitude,
            mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: self._attitude_quaternion,
            mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED: self._local_position,
            mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: self._global_position,
            mavlink.MAVLINK_MSG_ID_VFR_HUD: self._hud,
            mavlink.MAVLINK_MSG_ID_ALTITUDE: self._altitude,
            mavlink.MAVLINK_MSG_ID_SIM_STATE: self._truth,
        }

    def _attitude(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        phi, theta, psi = e.attitude
        heading = math.remainder(psi, math.tau)
        return [mavlink.MAVLink_attitude_message(milliseconds(now), phi, theta, heading, *e.rates)]

    def _attitude_quaternion(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        return [
            mavlink.MAVLink_attitude_quaternion_message(
                milliseconds(now), *quaternion(e.attitude), *e.rates
            )
        ]

    def _local_position(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not self._has_position():
            return []
        return [
            mavlink.MAVLink_local_position_ned_message(
                milliseconds(now), *e.position_n, *e.velocity_n
            )
        ]

    def _global_position(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not self._has_position():
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(e.position_n)
        if not e.position_valid:
            latitude = longitude = 0.0
        above_home = self.vehicle.home_n[2] - e.position_n[2]
        heading = round(compass_degrees(e.attitude[2]) * 100) % 36000
        return [
            mavlink.MAVLink_global_position_int_message(
                milliseconds(now),
                deg_e7(latitude),
                deg_e7(longitude),
                int32(altitude * 1e3),
                int32(above_home * 1e3),
                *(int16(v * 100) for v in e.velocity_n),
                heading if e.heading_valid else 0xFFFF,
            )
        ]

    def _hud(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        wind = e.apparent_wind[0] if e.apparent_wind is not None else 0.0
        ordered = abs(self.vehicle.manual[0]) if self.vehicle.mode.name in MANUAL_MODES else 0.0
        throttle = ordered if e.throttle is None else e.throttle
        throttle = throttle if self.vehicle.armed else 0.0
        return [
            mavlink.MAVLink_vfr_hud_message(
                wind,
                math.hypot(*e.velocity_n[:2]),
                round(compass_degrees(e.attitude[2])) % 360,
                uint16(throttle * 100),
                self.vehicle.origin.altitude - e.position_n[2],
                -e.velocity_n[2],
            )
        ]

    def _altitude(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        above_sea = self.vehicle.origin.altitude - e.position_n[2]
        return [
            mavlink.MAVLink_altitude_message(
                microseconds(now),
                above_sea,
                above_sea,
                -e.position_n[2],
                self.vehicle.home_n[2] - e.position_n[2],
                math.nan,
                math.nan,
            )
        ]

    def _truth(self, now: float) -> list[Message]:
        truth = self.vehicle.truth
        if truth is None:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(truth.position_n)
        phi, theta, psi = truth.attitude
        return [
            mavlink.MAVLink_sim_state_message(
                *quaternion(truth.attitude),
                phi,
                theta,
                math.remainder(psi, math.tau),
                *truth.specific_force,
                *truth.rates,
                latitude,
                longitude,
                altitude,
                0.0,
                0.0,
                *truth.velocity_n,
                deg_e7(latitude),
                deg_e7(longitude),
            )
        ]

    def _has_position(self) -> bool:
        return self.vehicle.estimates.position_valid or self.vehicle.identity.submerged
