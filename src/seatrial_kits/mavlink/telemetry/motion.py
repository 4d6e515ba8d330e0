"""Motion telemetry: attitude, position, velocity, home, truth."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..codec import Message
from ..modes import MANUAL_MODES
from ..scaling import (
    UNKNOWN_16,
    UNKNOWN_U16,
    compass_degrees,
    deg_e7,
    int32,
    known_int16,
    microseconds,
    milliseconds,
    quaternion,
    uint16,
)
from ..service import Service, builds


class MotionTelemetry(Service):
    """ATTITUDE, ATTITUDE_QUATERNION, LOCAL_POSITION_NED, GLOBAL_POSITION_INT, VFR_HUD, ALTITUDE,
    and SIM_STATE, the truth beside the estimates, if it is known.

    A boat without a valid position sends none; a submarine gives its depth, as
    negative altitude, at latitude and longitude 0, which ground stations take for none. A field
    that nothing measures is NaN, of an integer INT16_MAX; the airspeed is the apparent wind's, or
    else, as an ArduPilot has it, the speed over ground.
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

    @builds(mavlink.MAVLINK_MSG_ID_ATTITUDE)
    def _attitude(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not e.has("tilt", "heading", "gyro"):
            return []
        phi, theta, psi = e.shown_attitude
        heading = math.remainder(psi, math.tau)
        return [
            mavlink.MAVLink_attitude_message(milliseconds(now), phi, theta, heading, *e.shown_rates)
        ]

    @builds(mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION)
    def _attitude_quaternion(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not (e.has("tilt") and e.has("heading") and e.has("tilt", "heading", "gyro")):
            return []
        return [
            mavlink.MAVLink_attitude_quaternion_message(
                milliseconds(now), *quaternion(e.attitude), *e.shown_rates
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED)
    def _local_position(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not self._has_position():
            return []
        place = e.position_n[:2] if e.has("position") else (math.nan, math.nan)
        return [
            mavlink.MAVLink_local_position_ned_message(
                milliseconds(now), *place, e.position_n[2], *e.shown_velocity
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
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
                *(known_int16(v * 100) for v in e.shown_velocity),
                heading if e.heading_valid else UNKNOWN_U16,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_VFR_HUD)
    def _hud(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        north, east, down = e.shown_velocity
        heading = e.shown_attitude[2]
        over_ground = math.hypot(north, east)
        wind = e.apparent_wind[0] if e.apparent_wind is not None else over_ground
        ordered = abs(self.vehicle.manual[0]) if self.vehicle.mode.name in MANUAL_MODES else 0.0
        throttle = ordered if e.throttle is None else e.throttle
        throttle = throttle if self.vehicle.armed else 0.0
        return [
            mavlink.MAVLink_vfr_hud_message(
                wind,
                over_ground,
                UNKNOWN_16 if math.isnan(heading) else round(compass_degrees(heading)) % 360,
                uint16(throttle * 100),
                self.vehicle.origin.altitude - e.shown_down,
                -down,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_ALTITUDE)
    def _altitude(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        down = e.shown_down
        if math.isnan(down):
            return []
        above_sea = self.vehicle.origin.altitude - down
        return [
            mavlink.MAVLink_altitude_message(
                microseconds(now),
                above_sea,
                above_sea,
                -down,
                self.vehicle.home_n[2] - down,
                math.nan,
                math.nan if e.ground_distance is None else e.ground_distance,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_SIM_STATE)
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
        e = self.vehicle.estimates
        dives = self.vehicle.identity.submerged and not math.isnan(e.shown_down)
        return e.position_valid or dives
