"""Positions in MAVLink's coordinate frames."""

from __future__ import annotations

import math

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.geodesy import Ned

from .vehicle import Vehicle

_ABOVE_SEA = {mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT}
_ABOVE_HOME = {mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT}
GLOBAL_FRAMES = frozenset(_ABOVE_SEA | _ABOVE_HOME)
"""Frames with latitude and longitude; those above terrain, which is not known here, are not."""

FARTHEST = 1e6
"""Positions beyond, m from the origin, are no place to go to."""

LOCAL_FRAMES = frozenset(
    {
        mavlink.MAV_FRAME_LOCAL_NED,
        mavlink.MAV_FRAME_LOCAL_OFFSET_NED,
        mavlink.MAV_FRAME_BODY_NED,
        mavlink.MAV_FRAME_BODY_OFFSET_NED,
        mavlink.MAV_FRAME_BODY_FRD,
    }
)
"""Frames in metres: from the origin, from the vehicle, or along its heading."""


def global_position(
    vehicle: Vehicle, frame: int, latitude: float, longitude: float, altitude: float
) -> Ned | None:
    """Return the position in {n} of latitude and longitude, degrees, in a global frame.

    An altitude that is no number, and any of a boat, is where the vehicle is now. None for
    what is no place on Earth, or beyond `FARTHEST`.
    """
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):  # also if not a number
        return None
    north, east, down = vehicle.origin.position(latitude, longitude, altitude)
    if frame in _ABOVE_HOME:
        down = vehicle.home_n[2] - altitude
    if not vehicle.identity.submerged or not math.isfinite(down):
        down = vehicle.estimates.position_n[2]
    return (north, east, down) if is_near(north, east, down) else None


def is_near(*position: float) -> bool:
    """Return whether a position in {n} is finite and not beyond `FARTHEST`."""
    return all(abs(x) <= FARTHEST for x in position)  # false for what is not a number
