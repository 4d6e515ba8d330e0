"""Inputs of a node, as what its messages are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatrial.links.geodesy import Origin
from seatrial.links.unconnected import NOT_CONNECTED
from seatrial.model.component import NS, seconds

from ..leg import LegStatus, leg_status
from ..satellites import Sky, sky
from .codec import Fields
from .ports import Nmea2000Ports

_DAY_S = 86400
ANGLE_DIGITS = 4
"""Angles have a resolution of 1e-4 rad."""
TRUE = 0
"""North that directions are counted from."""


class Measured:
    """A view of a node's inputs: None for what is not there."""

    def __init__(self, node: Nmea2000Ports, sid: int, origin: Origin, epoch_ns: int) -> None:
        self.node, self.sid, self._epoch_ns = node, sid, epoch_ns
        self._origin = origin

    def one(self, name: str, valid: bool = True) -> float | None:
        """Return an input, None if it is not connected or not valid."""
        value: float = getattr(self.node, name)
        return value if valid and value < NOT_CONNECTED else None

    def rudder(self, name: str) -> float | None:
        """Return an angle of a rudder, positive to turn to starboard."""
        angle = self.one(name)
        return -angle if angle is not None and self.node.rudder_positive == "port" else angle

    def each(self, name: str, valid: bool = True) -> Sequence[float | None]:
        """Return the values of an input with axes."""
        values: Sequence[float] = getattr(self.node, name)
        return [value if valid and value < NOT_CONNECTED else None for value in values]

    def whole(self, name: str, valid: bool = True) -> Sequence[float] | None:
        """Return the values of an input with axes, None if one of them is not there."""
        values: Sequence[float] = getattr(self.node, name)
        return values if valid and all(value < NOT_CONNECTED for value in values) else None

    def geodetic(self) -> Sequence[float | None]:
        """Return latitude and longitude (deg) and altitude (m)."""
        position = self.whole("position_n", self.node.position_valid)
        if position is None:
            return None, None, None
        north, east, down = position
        return self._origin.geodetic((north, east, down))

    def latitude_longitude(self, place: Sequence[float]) -> tuple[float, float]:
        """Return latitude and longitude (deg) of a place north and east of the origin, m."""
        latitude, longitude, _ = self._origin.geodetic((place[0], place[1], 0.0))
        return latitude, longitude

    def now(self, later_s: float = 0.0) -> Fields:
        """Return date (days since 1970) and time of day (s), UTC; of so many seconds later."""
        later_ns = round(later_s * NS)
        days, rest = divmod(self._epoch_ns + self.node.now_ns + later_ns, _DAY_S * NS)
        return {"date": days, "time": seconds(rest)}

    def sky(self) -> Sky | None:
        """Return the satellites above the receiver, None if it has no position."""
        latitude, longitude, _ = self.geodetic()
        if latitude is None or longitude is None:
            return None
        return sky((self._epoch_ns + self.node.now_ns) / NS, latitude, longitude)

    def leg(self) -> LegStatus | None:
        """Return where the vessel is on its leg: by its own position, or else by the bus's."""
        node = self.node
        begin, end = self.whole("leg_from"), self.whole("leg_to")
        position = self.whole("position_n", node.position_valid)
        velocity = self.whole("velocity_n", node.position_valid)
        if position is None and node.bus_position_valid:
            position = node.bus_position_n
            velocity = node.bus_velocity_n if node.bus_velocity_valid else None
        if node.leg < 1 or begin is None or end is None or position is None:
            return None
        return leg_status(node.leg, begin, end, self.one("leg_radius") or 0.0, position, velocity)


def compass(angle: float | None) -> float | None:
    """Return an angle from 0 to below 2 pi, also when it is rounded to the resolution."""
    if angle is None:
        return None
    rounded = round(angle % math.tau, ANGLE_DIGITS)
    return rounded if rounded < math.tau else 0.0
