"""What the vehicle says of its way: where it heads for, and how far off it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from ..geodesy import Ned
from .codec import Message
from .scaling import int16, uint16
from .service import Builder, Service
from .transport import Transport
from .vehicle import Vehicle


class NavigationTelemetry(Service):
    """NAV_CONTROLLER_OUTPUT, while guidance stays somewhere, follows a leg or steers.

    nav_bearing is the heading wanted, target_bearing the direction of ``goal``, -180 to 180
    degrees; without a goal it is the heading wanted too. xtrack_error is positive to starboard of
    the leg; alt_error (of a submarine) and aspd_error are what is wanted less what is. Roll and
    pitch, which no guidance commands here, are 0.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: 0.5}

    def __init__(
        self, vehicle: Vehicle, transport: Transport, goal: Callable[[], Ned | None]
    ) -> None:
        super().__init__(vehicle, transport)
        self._goal = goal

    @property
    def messages(self) -> Mapping[int, Builder]:
        """Messages that it can build."""
        return {mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: self._navigation}

    def _navigation(self, now: float) -> list[Message]:
        e, way = self.vehicle.estimates, self.vehicle.estimates.way
        if way is None:
            return []
        north, east, down = e.position_n
        goal, psi = self._goal(), e.attitude[2]
        bearing = way.heading if goal is None else math.atan2(goal[1] - east, goal[0] - north)
        ahead = math.cos(psi) * e.velocity_n[0] + math.sin(psi) * e.velocity_n[1]
        return [
            mavlink.MAVLink_nav_controller_output_message(
                *(0.0, 0.0),
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
