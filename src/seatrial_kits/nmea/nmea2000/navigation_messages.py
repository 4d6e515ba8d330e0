"""Routes, satellites and batteries of a node as fields of the messages it sends."""

from __future__ import annotations

from collections.abc import Callable

from .codec import Fields
from .measured import TRUE, Measured, compass

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
