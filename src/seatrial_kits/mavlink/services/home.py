"""Home, to which the vehicle returns, and the origin, from which positions count."""

from __future__ import annotations

import math
from typing import ClassVar

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from ..codec import Message
from ..frames import GLOBAL_FRAMES, is_near
from ..scaling import deg_e7, int32, microseconds
from ..service import (
    ACCEPTED,
    DENIED,
    FAILED,
    WARNING,
    Command,
    Service,
    builds,
    on_command,
    on_message,
)
from ..transport import Sender


class HomeService(Service):
    """HOME_POSITION and GPS_GLOBAL_ORIGIN out; DO_SET_HOME, SET_HOME_POSITION,
    GET_HOME_POSITION and SET_GPS_GLOBAL_ORIGIN in.

    Home is the origin until it is set; the setting station is answered with the new one, as
    are all others. The origin belongs to the trial and stays: requests to set it get it.
    """

    streams: ClassVar = {mavlink.MAVLINK_MSG_ID_HOME_POSITION: 2.0}

    @on_message(mavlink.MAVLINK_MSG_ID_SET_HOME_POSITION)
    def _take_home(self, message: Message, sender: Sender, now: float) -> None:
        self._move(message.latitude * 1e-7, message.longitude * 1e-7, message.altitude * 1e-3, now)

    @on_message(mavlink.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN)
    def _refuse_origin(self, message: Message, sender: Sender, now: float) -> None:
        self.vehicle.report(WARNING, "The origin stays: it belongs to the trial")
        self.transport.send(sender.link, self._origin(now)[0])

    @on_command(mavlink.MAV_CMD_DO_SET_HOME)
    def _set_home(self, command: Command, sender: Sender, now: float) -> int:
        how = command.parameters[0]
        if how not in (0.0, 1.0):
            return FAILED
        if how == 1.0:
            if not self.vehicle.estimates.position_valid:
                return FAILED
            self._moved(self.vehicle.estimates.position_n, now)
            return ACCEPTED
        if command.frame not in GLOBAL_FRAMES:
            return DENIED
        latitude, longitude, altitude = command.parameters[4:]
        return ACCEPTED if self._move(latitude, longitude, altitude, now) else FAILED

    def _move(self, latitude: float, longitude: float, altitude: float, now: float) -> bool:
        """Move home to degrees and m above the sea; return whether that is a place near enough."""
        if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0 and math.isfinite(altitude)):
            return False
        position = self.vehicle.origin.position(latitude, longitude, altitude)
        if is_near(*position):
            self._moved(position, now)
        return is_near(*position)

    def _moved(self, position: Ned, now: float) -> None:
        self.vehicle.home_n = position
        self.transport.broadcast(self._home(now)[0])

    @on_command(mavlink.MAV_CMD_GET_HOME_POSITION)
    def _send_home(self, command: Command, sender: Sender, now: float) -> int:
        self.transport.send(sender.link, self._home(now)[0])
        return ACCEPTED

    @builds(mavlink.MAVLINK_MSG_ID_HOME_POSITION)
    def _home(self, now: float) -> list[Message]:
        latitude, longitude, altitude = self.vehicle.origin.geodetic(self.vehicle.home_n)
        return [
            mavlink.MAVLink_home_position_message(
                deg_e7(latitude),
                deg_e7(longitude),
                int32(altitude * 1e3),
                *self.vehicle.home_n,
                [1.0, 0.0, 0.0, 0.0],
                0.0,
                0.0,
                0.0,
                microseconds(now),
            )
        ]

    @builds(mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN)
    def _origin(self, now: float) -> list[Message]:
        latitude, longitude, altitude = self.vehicle.origin.geodetic((0.0, 0.0, 0.0))
        return [
            mavlink.MAVLink_gps_global_origin_message(
                deg_e7(latitude), deg_e7(longitude), int32(altitude * 1e3), microseconds(now)
            )
        ]
