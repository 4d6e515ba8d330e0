"""Measurements of a node as fields of the messages it sends."""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable, Sequence
from typing import Any

from ...component import NS, seconds
from ..geodesy import Origin
from .codec import Fields, Message
from .ports import ENGINES, NOT_CONNECTED, Nmea2000Ports

_DAY_S = 86400
_ANGLE_DIGITS = 4
"""Angles have a resolution of 1e-4 rad."""
_TRUE, _MAGNETIC, _APPARENT = 0, 1, 2
_MODES = range(6)
_RPM = 60.0 / math.tau


def messages(node: Nmea2000Ports, pgn: int, sid: int, origin: Origin, day: int) -> list[Message]:
    """Return the messages of a PGN with the inputs as they are; ``day`` is counted from 1970.

    Values that are not connected or not valid are left out, and so not available.
    """
    made = _MAKERS[pgn](_Measured(node, sid, origin, day))
    return [Message(pgn, each) for each in made]


class _Measured:
    """A view of a node's inputs: None for what is not there."""

    def __init__(self, node: Nmea2000Ports, sid: int, origin: Origin, day: int) -> None:
        self.node, self.sid, self.day = node, sid, day
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

    def now(self) -> Fields:
        """Return date (days since 1970) and time of day (s), UTC."""
        days, rest = divmod(self.node.now_ns, _DAY_S * NS)
        return {"date": self.day + days, "time": seconds(rest)}


def _system_time(m: _Measured) -> list[Fields]:
    return [{"sid": m.sid, "source": 0, **m.now()}]


def _heading_control(m: _Measured) -> list[Fields]:
    node, rudder = m.node, m.rudder("commanded_rudder")
    heading = m.one("heading", node.heading_valid and node.heading_reference == "true")
    return [
        {
            "steeringMode": node.steering_mode if node.steering_mode in _MODES else None,
            "headingReference": _TRUE,
            "commandedRudderDirection": _direction(rudder),
            "commandedRudderAngle": rudder,
            "headingToSteerCourse": compass(m.one("heading_to_steer")),
            "track": compass(m.one("track")),
            "rudderLimit": m.one("rudder_limit"),
            "vesselHeading": compass(heading),
        }
    ]


def _rudder(m: _Measured) -> list[Fields]:
    order = m.rudder("rudder_order")
    return [
        {
            "instance": int(m.node.rudder_instance),
            "directionOrder": _direction(order),
            "angleOrder": order,
            "position": m.rudder("rudder"),
        }
    ]


def _heading(m: _Measured) -> list[Fields]:
    node = m.node
    return [
        {
            "sid": m.sid,
            "heading": compass(m.one("heading", node.heading_valid)),
            "deviation": m.one("deviation"),
            "variation": m.one("variation"),
            "reference": _TRUE if node.heading_reference == "true" else _MAGNETIC,
        }
    ]


def _rate_of_turn(m: _Measured) -> list[Fields]:
    return [{"sid": m.sid, "rate": m.one("rate_of_turn", m.node.rate_valid)}]


def _attitude(m: _Measured) -> list[Fields]:
    phi, theta, psi = m.each("attitude", m.node.attitude_valid)
    yaw = None if psi is None else math.remainder(psi, math.tau)
    return [{"sid": m.sid, "yaw": yaw, "pitch": theta, "roll": phi}]


def _engines_rapid(m: _Measured) -> list[Fields]:
    return [
        {"instance": instance, "speed": abs(speed) * _RPM}
        for instance, speed in enumerate(m.each("engine_speed"))
        if speed is not None
    ]


def _engines_dynamic(m: _Measured) -> list[Fields]:
    names = ("engine_voltage", "engine_temperature", "engine_load")
    voltage, temperature, load = (m.each(name) for name in names)
    found: list[Fields] = []
    for instance in range(ENGINES):
        values = voltage[instance], temperature[instance], load[instance]
        if values != (None, None, None):
            share = values[2]
            found.append(
                {
                    "instance": instance,
                    "alternatorPotential": values[0],
                    "temperature": values[1],
                    "discreteStatus1": 0,
                    "discreteStatus2": 0,
                    "engineLoad": None if share is None else round(100.0 * abs(share)),
                }
            )
    return found


def _speed(m: _Measured) -> list[Fields]:
    velocity = m.whole("velocity_n", m.node.position_valid)
    over_ground = None if velocity is None else math.hypot(velocity[0], velocity[1])
    ahead = m.one("water_speed")
    return [
        {
            "sid": m.sid,
            "speedWaterReferenced": None if ahead is None else _not_negative(ahead, 2),
            "speedGroundReferenced": over_ground,
        }
    ]


def _depth(m: _Measured) -> list[Fields]:
    return [{"sid": m.sid, "depth": m.one("depth"), "offset": m.node.transducer_offset}]


def _position(m: _Measured) -> list[Fields]:
    latitude, longitude, _ = m.geodetic()
    return [{"latitude": latitude, "longitude": longitude}]


def _course(m: _Measured) -> list[Fields]:
    velocity = m.whole("velocity_n", m.node.position_valid)
    course = speed = None
    if velocity is not None:
        speed = math.hypot(velocity[0], velocity[1])
        course = compass(math.atan2(velocity[1], velocity[0]))
    return [{"sid": m.sid, "cogReference": _TRUE, "cog": course, "sog": speed}]


def _gnss(m: _Measured) -> list[Fields]:
    latitude, longitude, altitude = m.geodetic()
    return [
        {
            "sid": m.sid,
            **m.now(),
            "latitude": latitude,
            "longitude": longitude,
            "altitude": altitude,
            "gnssType": 0,
            "method": 0 if latitude is None else 1,
            "integrity": 0,
            "referenceStations": 0,
        }
    ]


def _wind(m: _Measured) -> list[Fields]:
    valid = m.node.wind_valid
    speed, angle = m.one("wind_speed", valid), m.one("wind_angle", valid)
    air = m.whole("true_wind")
    found: list[Fields] = []
    if air is None or m.one("wind_speed") is not None:
        comes_from = None if angle is None else compass(angle + math.pi)
        found.append(
            {"sid": m.sid, "windSpeed": speed, "windAngle": comes_from, "reference": _APPARENT}
        )
    if air is not None:
        comes_from = compass(math.atan2(-air[1], -air[0]))
        strength = math.hypot(*air)
        found.append(
            {"sid": m.sid, "windSpeed": strength, "windAngle": comes_from, "reference": _TRUE}
        )
    return found


def compass(angle: float | None) -> float | None:
    """Return an angle from 0 to below 2 pi, also when it is rounded to the resolution."""
    if angle is None:
        return None
    rounded = round(angle % math.tau, _ANGLE_DIGITS)
    return rounded if rounded < math.tau else 0.0


def day_of(date: str) -> int:
    """Return the days from 1970-01-01 to an ISO date. Raises ValueError."""
    return (datetime.date.fromisoformat(date) - datetime.date(1970, 1, 1)).days


def _direction(angle: float | None) -> int | None:
    """Return a direction order: 0 none, 1 to starboard, 2 to port."""
    if angle is None:
        return None
    rounded = round(angle, _ANGLE_DIGITS)
    return 1 if rounded > 0.0 else 2 if rounded < 0.0 else 0


def _not_negative(value: float, digits: int) -> float | None:
    rounded = round(value, digits)
    return rounded if rounded >= 0.0 else None


_MAKERS: dict[int, Callable[[_Measured], list[dict[str, Any]]]] = {
    126992: _system_time,
    127237: _heading_control,
    127245: _rudder,
    127250: _heading,
    127251: _rate_of_turn,
    127257: _attitude,
    127488: _engines_rapid,
    127489: _engines_dynamic,
    128259: _speed,
    128267: _depth,
    129025: _position,
    129026: _course,
    129029: _gnss,
    130306: _wind,
}
