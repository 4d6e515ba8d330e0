"""Navigation telemetry: commanded course, distance and errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..codec import Message
from ..scaling import deg_e7, int16, milliseconds, uint16
from ..service import Service, builds
from ..transport import Transport
from ..vehicle import Vehicle

_POSITION_ALONE, _UPPER_BITS = 0xDF8, 0xF000
"""POSITION_TARGET_TYPEMASK: velocities, accelerations and yaw are not given."""


class NavigationTelemetry(Service):
    """NAV_CONTROLLER_OUTPUT, while guidance stays somewhere, follows a leg or steers, and
    POSITION_TARGET_GLOBAL_INT, while there is a ``goal``.

    nav_bearing is the heading wanted, target_bearing the direction of ``goal``, -180 to 180
    degrees; without a goal it is the heading wanted too. xtrack_error is positive to starboard of
    the leg; alt_error (of a submarine) and aspd_error are what is wanted less what is. Roll and
    pitch, which no guidance commands here, are 0.
    """

    streams: ClassVar = {
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 0.5,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: 0.5,
    }

    def __init__(
        self, vehicle: Vehicle, transport: Transport, goal: Callable[[], Ned | None]
    ) -> None:
        super().__init__(vehicle, transport)
        self._goal = goal

    @builds(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT)
    def _target(self, now: float) -> list[Message]:
        goal = self._goal()
        if goal is None:
            return []
        latitude, longitude, altitude = self.vehicle.origin.geodetic(goal)
        place = (deg_e7(latitude), deg_e7(longitude), altitude)
        unused = (0.0,) * 8
        mask = _POSITION_ALONE | (_UPPER_BITS if self.vehicle.dialect.is_ardupilot else 0)
        return [
            mavlink.MAVLink_position_target_global_int_message(
                milliseconds(now), mavlink.MAV_FRAME_GLOBAL, mask, *place, *unused
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT)
    def _navigation(self, now: float) -> list[Message]:
        e, way = self.vehicle.estimates, self.vehicle.estimates.way
        if way is None:
            return []
        north, east, down = e.position_n
        goal, psi = self._goal(), e.shown_attitude[2]
        bearing = way.heading if goal is None else math.atan2(goal[1] - east, goal[0] - north)
        over_ground = e.shown_velocity
        ahead = math.cos(psi) * over_ground[0] + math.sin(psi) * over_ground[1]
        return [
            mavlink.MAVLink_nav_controller_output_message(
                0.0,
                0.0,
                _bearing(way.heading),
                _bearing(bearing),
                uint16(way.distance),
                down - way.depth if self.vehicle.identity.submerged else 0.0,
                0.0 if way.speed is None else way.speed - ahead,
                way.cross_track,
            )
        ]


def _bearing(angle: float) -> int:
    return int16(math.degrees(math.remainder(angle, math.tau)))
