"""Measurements of a node as fields of the messages it sends."""

from __future__ import annotations

import math
from collections.abc import Callable

from seatrial.links.geodesy import Origin

from ..received.outputs import ENGINES
from .codec import Fields, Message
from .measured import ANGLE_DIGITS, TRUE, Measured, compass
from .ports import Nmea2000Ports

_NO, _YES = 0, 1
_AUTONOMOUS, _RHUMB_LINE = 0, 1
_AUTOMATIC, _THREE_DIMENSIONS = 3, 2
_USED = 2
_LATEST_S = 30 * 86400.0
"""A time of arrival beyond a month is none."""


def _battery(m: Measured) -> list[Fields]:
    voltage, current = m.one("battery_voltage"), m.one("battery_current")
    temperature = m.one("battery_temperature")
    if (voltage, current, temperature) == (None, None, None):
        return []
    return [
        {
            "instance": int(m.node.battery_instance),
            "voltage": voltage,
            "current": None if current is None else -current + 0.0,
            "temperature": temperature,
            "sid": m.sid,
        }
    ]


def _cross_track(m: Measured) -> list[Fields]:
    leg = m.leg()
    return [
        {
            "sid": m.sid,
            "xteMode": _AUTONOMOUS,
            "navigationTerminated": _YES if leg is None else _NO,
            "xte": None if leg is None else leg.cross_track,
        }
    ]


def _navigation(m: Measured) -> list[Fields]:
    leg = m.leg()
    if leg is None:
        return [{"sid": m.sid, "courseBearingReference": TRUE, "calculationType": _RHUMB_LINE}]
    latitude, longitude = m.latitude_longitude(leg.end)
    arrival: Fields = {}
    if leg.time is not None and leg.time < _LATEST_S:
        then = m.now(leg.time)
        arrival = {"etaDate": then["date"], "etaTime": then["time"]}
    return [
        {
            "sid": m.sid,
            "distanceToWaypoint": leg.distance,
            "courseBearingReference": TRUE,
            "perpendicularCrossed": _YES if leg.passed else _NO,
            "arrivalCircleEntered": _YES if leg.arrived else _NO,
            "calculationType": _RHUMB_LINE,
            **arrival,
            "bearingOriginToDestinationWaypoint": compass(leg.direction),
            "bearingPositionToDestinationWaypoint": compass(leg.bearing),
            "originWaypointNumber": leg.number - 1,
            "destinationWaypointNumber": leg.number,
            "destinationLatitude": latitude,
            "destinationLongitude": longitude,
            "waypointClosingVelocity": leg.closing,
        }
    ]


def _route(m: Measured) -> list[Fields]:
    leg = m.leg()
    if leg is None:
        return []
    items = []
    for number, place in ((leg.number - 1, leg.begin), (leg.number, leg.end)):
        latitude, longitude = m.latitude_longitude(place)
        name = f"WP{number}"
        items.append(
            {"wpId": number, "wpName": name, "wpLatitude": latitude, "wpLongitude": longitude}
        )
    return [
        {
            "startRps": leg.number - 1,
            "nitems": len(items),
            "databaseId": 0,
            "routeId": 0,
            "navigationDirectionInRoute": 0,
            "supplementaryRouteWpDataAvailable": 0,
            "routeName": "",
            "items": items,
        }
    ]


def _dilutions(m: Measured) -> list[Fields]:
    above = m.sky()
    fields: Fields = {"sid": m.sid, "desiredMode": _AUTOMATIC}
    if above is not None:
        fields |= {"hdop": above.hdop, "vdop": above.vdop, "tdop": above.tdop}
        fields["actualMode"] = _THREE_DIMENSIONS
    return [fields]


def _satellites(m: Measured) -> list[Fields]:
    above = m.sky()
    items = [
        {
            "prn": each.prn,
            "elevation": each.elevation,
            "azimuth": compass(each.azimuth),
            "snr": each.signal,
            "status": _USED,
        }
        for each in (() if above is None else above.satellites)
    ]
    return [{"sid": m.sid, "satsInView": len(items), "items": items}]


NAVIGATION_MAKERS: dict[int, Callable[[Measured], list[Fields]]] = {
    127508: _battery,
    129283: _cross_track,
    129284: _navigation,
    129285: _route,
    129539: _dilutions,
    129540: _satellites,
}


_MAGNETIC, _APPARENT = 1, 2
_MODES = range(6)
_RPM = 60.0 / math.tau


def messages(
    node: Nmea2000Ports, pgn: int, sid: int, origin: Origin, epoch_ns: int
) -> list[Message]:
    """Return the messages of a PGN with the inputs as they are.

    ``epoch_ns`` is the Unix time at 0 s of simulated time. Values that are not
    connected or not valid are left out, and so not available.
    """
    if pgn not in _MAKERS:  # goes when there is one
        return []
    made = _MAKERS[pgn](Measured(node, sid, origin, epoch_ns))
    return [Message(pgn, each, items=tuple(each.pop("items", ()))) for each in made]


def _system_time(m: Measured) -> list[Fields]:
    return [{"sid": m.sid, "source": 0, **m.now()}]


def _heading_control(m: Measured) -> list[Fields]:
    node, rudder = m.node, m.rudder("commanded_rudder")
    heading = m.one("heading", node.heading_valid and node.heading_reference == "true")
    return [
        {
            "steeringMode": node.steering_mode if node.steering_mode in _MODES else None,
            "headingReference": TRUE,
            "commandedRudderDirection": _direction(rudder),
            "commandedRudderAngle": rudder,
            "headingToSteerCourse": compass(m.one("heading_to_steer")),
            "track": compass(m.one("track")),
            "rudderLimit": m.one("rudder_limit"),
            "vesselHeading": compass(heading),
        }
    ]


def _rudder(m: Measured) -> list[Fields]:
    order = m.rudder("rudder_order")
    return [
        {
            "instance": int(m.node.rudder_instance),
            "directionOrder": _direction(order),
            "angleOrder": order,
            "position": m.rudder("rudder"),
        }
    ]


def _heading(m: Measured) -> list[Fields]:
    node = m.node
    return [
        {
            "sid": m.sid,
            "heading": compass(m.one("heading", node.heading_valid)),
            "deviation": m.one("deviation"),
            "variation": m.one("variation"),
            "reference": TRUE if node.heading_reference == "true" else _MAGNETIC,
        }
    ]


def _rate_of_turn(m: Measured) -> list[Fields]:
    return [{"sid": m.sid, "rate": m.one("rate_of_turn", m.node.rate_valid)}]


def _attitude(m: Measured) -> list[Fields]:
    phi, theta, psi = m.each("attitude", m.node.attitude_valid)
    yaw = None if psi is None else math.remainder(psi, math.tau)
    return [{"sid": m.sid, "yaw": yaw, "pitch": theta, "roll": phi}]


def _variation(m: Measured) -> list[Fields]:
    variation = m.one("variation")
    today = None if variation is None else m.now()["date"]
    return [{"sid": m.sid, "source": 0, "ageOfService": today, "variation": variation}]


def _engines_rapid(m: Measured) -> list[Fields]:
    return [
        {"instance": instance, "speed": abs(speed) * _RPM}
        for instance, speed in enumerate(m.each("engine_speed"))
        if speed is not None
    ]


def _engines_dynamic(m: Measured) -> list[Fields]:
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


def _speed(m: Measured) -> list[Fields]:
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


def _depth(m: Measured) -> list[Fields]:
    return [{"sid": m.sid, "depth": m.one("depth"), "offset": m.node.transducer_offset}]


def _position(m: Measured) -> list[Fields]:
    latitude, longitude, _ = m.geodetic()
    return [{"latitude": latitude, "longitude": longitude}]


def _course(m: Measured) -> list[Fields]:
    velocity = m.whole("velocity_n", m.node.position_valid)
    course = speed = None
    if velocity is not None:
        speed = math.hypot(velocity[0], velocity[1])
        course = compass(math.atan2(velocity[1], velocity[0]))
    return [{"sid": m.sid, "cogReference": TRUE, "cog": course, "sog": speed}]


def _gnss(m: Measured) -> list[Fields]:
    latitude, longitude, altitude = m.geodetic()
    above = m.sky()
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
            "numberOfSvs": 0 if above is None else len(above.satellites),
            "hdop": None if above is None else above.hdop,
            "pdop": None if above is None else above.pdop,
            "referenceStations": 0,
        }
    ]


def _wind(m: Measured) -> list[Fields]:
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
            {"sid": m.sid, "windSpeed": strength, "windAngle": comes_from, "reference": TRUE}
        )
    return found


def _direction(angle: float | None) -> int | None:
    """Return a direction order: 0 none, 1 to starboard, 2 to port."""
    if angle is None:
        return None
    rounded = round(angle, ANGLE_DIGITS)
    return 1 if rounded > 0.0 else 2 if rounded < 0.0 else 0


def _not_negative(value: float, digits: int) -> float | None:
    rounded = round(value, digits)
    return rounded if rounded >= 0.0 else None


_MAKERS: dict[int, Callable[[Measured], list[Fields]]] = {
    **NAVIGATION_MAKERS,
    126992: _system_time,
    127237: _heading_control,
    127245: _rudder,
    127250: _heading,
    127251: _rate_of_turn,
    127257: _attitude,
    127258: _variation,
    127488: _engines_rapid,
    127489: _engines_dynamic,
    128259: _speed,
    128267: _depth,
    129025: _position,
    129026: _course,
    129029: _gnss,
    130306: _wind,
}
