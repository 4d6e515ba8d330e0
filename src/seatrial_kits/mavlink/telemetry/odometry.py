"""Odometry telemetry, sent on request: odometry, and the true state."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import all as mavlink

from seatrial.model.unit_table import STANDARD_GRAVITY
from seatrial.physics.craft.kinematics import to_body

from ..codec import Message
from ..scaling import deg_e7, int16, int32, microseconds, quaternion
from ..service import Service, builds

_UNKNOWN = [math.nan] * 21


class OdometryTelemetry(Service):
    """ODOMETRY, the estimates of pose and motion in one, and HIL_STATE_QUATERNION, the truth as a
    PX4's simulator sends it. No link gets them before it requests them.

    ODOMETRY has its pose in {n} from the origin, its velocity and rates along the body axes; its
    covariances are not known. Without a valid position and an attitude there is none.
    """

    @builds(mavlink.MAVLINK_MSG_ID_ODOMETRY)
    def _odometry(self, now: float) -> list[Message]:
        e = self.vehicle.estimates
        if not (e.position_valid and e.has("tilt") and e.has("heading")):
            return []
        velocity = to_body(e.attitude, e.shown_velocity)
        return [
            mavlink.MAVLink_odometry_message(
                microseconds(now),
                mavlink.MAV_FRAME_LOCAL_NED,
                mavlink.MAV_FRAME_BODY_FRD,
                *e.position_n,
                quaternion(e.attitude),
                *velocity,
                *e.shown_rates,
                _UNKNOWN,
                _UNKNOWN,
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION)
    def _truth(self, now: float) -> list[Message]:
        truth = self.vehicle.truth
        if truth is None:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(truth.position_n)
        return [
            mavlink.MAVLink_hil_state_quaternion_message(
                microseconds(now),
                quaternion(truth.attitude),
                *truth.rates,
                deg_e7(latitude),
                deg_e7(longitude),
                int32(altitude * 1e3),
                *(int16(v * 100) for v in truth.velocity_n),
                0,
                0,
                *(int16(a / STANDARD_GRAVITY * 1e3) for a in truth.specific_force),
            )
        ]
