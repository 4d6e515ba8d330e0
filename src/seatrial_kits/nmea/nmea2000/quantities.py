"""Quantities that messages hold, by PGN: SI and rad, but for latitude and longitude, deg.

Each field is read by itself: one that is not available leaves the others as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from ..received.memory import Values
from .codec import numbers

_TRUE, _MAGNETIC = 0, 1
_NO_GNSS = 0
_YES = 1
_PER_RPM = math.tau / 60.0
_LITRES_PER_HOUR = 1e-3 / 3600.0
_FULL_TURN = math.tau + 1e-4
"""rad, and half a resolution more: angles beyond are none."""
_WATER, _OUTSIDE_AIR, _OUTSIDE, _ATMOSPHERE = 0, 1, 1, 0
_NO_DATES = 65532
"""Days from which on a date is none."""

Fields = dict[str, Any]


def _angle(f: Fields, name: str) -> tuple[float, ...] | None:
    """Return an angle of a circle; None beyond one."""
    found = numbers(f, name)
    return found if found is not None and abs(found[0]) <= _FULL_TURN else None


def _from_north(name: str, reference: Any, found: tuple[float, ...] | None) -> Values:
    """Return a direction as true or magnetic; of one without a reference it is not known which."""
    if reference not in (_TRUE, _MAGNETIC):
        return {}
    return {name if reference == _TRUE else f"magnetic_{name}": found}


def _heading(f: Fields) -> Values:
    """Heading with its deviation; a magnetic one with the variation, if its message has that."""
    reference, shown = f.get("reference"), _angle(f, "heading")
    variation = numbers(f, "variation")
    if shown is not None and reference == _MAGNETIC:
        shown = (shown[0] + (f.get("deviation") or 0.0), *(variation or ()))
    return {**_from_north("heading", reference, shown), "variation": variation}


def _place(f: Fields) -> tuple[float, ...] | None:
    found = numbers(f, "latitude", "longitude")
    within = found is not None and abs(found[0]) <= 90.0 and abs(found[1]) <= 180.0
    return found if within else None


def _fix(f: Fields) -> Values:
    """Position of a receiver; without a fix it is not available whatever it says."""
    lost = f.get("method") == _NO_GNSS
    return {
        "place": None if lost else _place(f),
        "altitude": None if lost else numbers(f, "altitude"),
        **_date(f),
    }


def _date(f: Fields) -> Values:
    found = numbers(f, "date")
    return {"date": found if found is not None and 0.0 < found[0] < _NO_DATES else None}


def _rudder(f: Fields) -> Values:
    ways = {0: 0.0, 1: 1.0, 2: -1.0}
    direction = f.get("directionOrder")
    return {
        "rudder": numbers(f, "position"),
        "rudder_order": numbers(f, "angleOrder"),
        "rudder_direction": (ways[direction],) if direction in ways else None,
    }


def _course(f: Fields) -> Values:
    return {
        "speed_over_ground": numbers(f, "sog"),
        **_from_north("course", f.get("cogReference"), _angle(f, "cog")),
    }


def _wind(f: Fields) -> Values:
    """Wind by its reference: 0 true and 1 magnetic north, over ground; 2 apparent; 3, from the
    bow, over ground; 4, from the bow, over the water."""
    reference, speed, angle = f.get("reference"), numbers(f, "windSpeed"), _angle(f, "windAngle")
    if reference in (_TRUE, _MAGNETIC):
        from_north = _from_north("wind_direction", reference, angle)
        return {"ground_wind_speed": speed, **from_north}
    bow = None if angle is None else (math.remainder(angle[0] - math.pi, math.tau),)
    if reference == 2:
        return {"wind_speed": speed, "wind_angle": bow}
    if reference == 3:
        return {"ground_wind_speed": speed, "ground_wind_angle": angle}
    return {"water_wind_speed": speed, "water_wind_angle": bow} if reference == 4 else {}


def _engine(f: Fields, fields: dict[str, tuple[str, float]]) -> Values:
    """Quantities of an engine: by field the quantity, and the unit that it is in."""
    instance, found = f.get("instance"), Values()
    if instance is not None:
        for name, (quantity, unit) in fields.items():
            values = numbers(f, name)
            found[f"engine_{quantity} {instance}"] = None if values is None else (values[0] * unit,)
    return found


_ENGINES_RAPID = {"speed": ("speed", _PER_RPM)}
_ENGINES_DYNAMIC = {
    "fuelRate": ("fuel_rate", _LITRES_PER_HOUR),
    "temperature": ("temperature", 1.0),
    "oilPressure": ("oil_pressure", 1.0),
    "alternatorPotential": ("voltage", 1.0),
    "engineLoad": ("load", 0.01),
}


def _heading_control(f: Fields) -> Values:
    """Orders to the helm, as a direction and whether it is magnetic, and the pilot's heading."""
    reference, mode = f.get("headingReference"), f.get("steeringMode")
    magnetic = float(reference == _MAGNETIC)  # a command may leave the reference out: true
    known = reference in (_TRUE, _MAGNETIC, None, 3)  # 3: not available

    def ordered(name: str) -> tuple[float, ...] | None:
        found = _angle(f, name)
        return (found[0], magnetic) if found is not None and known else None

    return {
        "heading_to_steer": ordered("headingToSteerCourse"),
        "track": ordered("track"),
        "commanded_rudder": numbers(f, "commandedRudderAngle"),
        "steering_mode": (float(mode or 0),) if mode in range(6) else None,
        **_from_north("heading", reference, _angle(f, "vesselHeading")),
    }


def _cross_track(f: Fields) -> Values:
    over = f.get("navigationTerminated") == _YES
    return {"cross_track": None if over else numbers(f, "xte")}


def _navigation(f: Fields) -> Values:
    reference = f.get("courseBearingReference")
    place = numbers(f, "destinationLatitude", "destinationLongitude")
    reached = f.get("arrivalCircleEntered"), f.get("perpendicularCrossed")
    known = any(each in (0, _YES) for each in reached)
    return {
        "waypoint_distance": numbers(f, "distanceToWaypoint"),
        "closing_speed": numbers(f, "waypointClosingVelocity"),
        "waypoint_number": numbers(f, "destinationWaypointNumber"),
        "waypoint_place": place,
        "arrived": (float(_YES in reached),) if known else None,
        **_from_north("leg_direction", reference, _angle(f, "bearingOriginToDestinationWaypoint")),
        **_from_north(
            "waypoint_bearing", reference, _angle(f, "bearingPositionToDestinationWaypoint")
        ),
    }


def _temperature(f: Fields, name: str, source: str = "source") -> Values:
    """Temperature of the water or the air outside, by its source; others are not read."""
    quantities = {_WATER: "water_temperature", _OUTSIDE_AIR: "air_temperature"}
    quantity = quantities.get(f.get(source, -1))
    return {} if quantity is None else {quantity: numbers(f, name)}


def _humidity(f: Fields, name: str, source: str) -> Values:
    found = numbers(f, name)
    share = None if found is None else (0.01 * found[0],)
    return {"humidity": share} if f.get(source) == _OUTSIDE else {}


def _surroundings(f: Fields) -> Values:
    return {
        **_temperature(f, "temperature", "temperatureSource"),
        **_humidity(f, "humidity", "humiditySource"),
        "air_pressure": numbers(f, "atmosphericPressure"),
    }


def _pressure(f: Fields) -> Values:
    return {"air_pressure": numbers(f, "pressure")} if f.get("source") == _ATMOSPHERE else {}


def _alone(**fields: str) -> Callable[[Fields], Values]:
    """Return a reader of fields of one value each, by quantity."""
    return lambda f: {quantity: numbers(f, name) for quantity, name in fields.items()}


READERS: dict[int, Callable[[Fields], Values]] = {
    126992: _date,
    127237: _heading_control,
    127245: _rudder,
    127250: _heading,
    127251: _alone(rate_of_turn="rate"),
    127257: _alone(roll="roll", pitch="pitch", yaw="yaw"),
    127258: _alone(variation="variation"),
    127488: lambda f: _engine(f, _ENGINES_RAPID),
    127489: lambda f: _engine(f, _ENGINES_DYNAMIC),
    128259: _alone(water_speed="speedWaterReferenced", speed_over_ground="speedGroundReferenced"),
    128267: _alone(depth="depth", depth_offset="offset"),
    129025: lambda f: {"place": _place(f)},
    129026: _course,
    129029: _fix,
    129033: _date,
    129283: _cross_track,
    129284: _navigation,
    130306: _wind,
    130310: _alone(
        water_temperature="waterTemperature",
        air_temperature="outsideAmbientAirTemperature",
        air_pressure="atmosphericPressure",
    ),
    130311: _surroundings,
    130312: lambda f: _temperature(f, "actualTemperature"),
    130313: lambda f: _humidity(f, "actualHumidity", "source"),
    130314: _pressure,
    130315: _alone(set_pressure="pressure"),
    130316: lambda f: _temperature(f, "temperature"),
}
"""By PGN."""

LATE: dict[int, tuple[str, ...]] = {
    127237: ("heading", "magnetic_heading"),
    127250: ("variation",),
    128259: ("speed_over_ground",),
}
"""Quantities that a message repeats of others, by PGN: used where nothing else has them."""
