"""Quantities that messages hold, by PGN: SI and rad, but for latitude and longitude, deg."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from .codec import numbers

_TRUE, _MAGNETIC, _APPARENT = 0, 1, 2
_PER_RPM = math.tau / 60.0

Values = dict[str, tuple[float, ...] | None]
"""By quantity; None for one that is not available."""


def _heading(f: dict[str, Any]) -> Values:
    """True heading: if the compass is magnetic, what it shows + deviation + variation."""
    shown = numbers(f, "heading")
    reference = f.get("reference")
    if shown is None or reference not in (_TRUE, _MAGNETIC):
        return {"heading": None}
    if reference == _TRUE:
        return {"heading": shown}
    if f.get("variation") is None:
        return {"heading": None}
    true: float = shown[0] + (f.get("deviation") or 0.0) + f["variation"]
    return {"heading": (true % math.tau,)}


def _rudder(f: dict[str, Any]) -> Values:
    ways = {0: 0.0, 1: 1.0, 2: -1.0}
    direction = f.get("directionOrder")
    return {
        "rudder": numbers(f, "position"),
        "rudder_order": numbers(f, "angleOrder"),
        "rudder_direction": (ways[direction],) if direction in ways else None,
    }


def _course(f: dict[str, Any]) -> Values:
    found = numbers(f, "cog", "sog")
    if found is None or f.get("cogReference") != _TRUE:
        return {"velocity": None}
    course, speed = found
    return {"velocity": (speed * math.cos(course), speed * math.sin(course))}


def _wind(f: dict[str, Any]) -> Values:
    if f.get("reference") != _APPARENT:
        return {}
    found = numbers(f, "windSpeed", "windAngle")
    if found is None:
        return {"wind": None}
    return {"wind": (found[0], math.remainder(found[1] - math.pi, math.tau))}


def _engine(f: dict[str, Any]) -> Values:
    instance, speed = f.get("instance"), numbers(f, "speed")
    if instance is None:
        return {}
    return {f"engine {instance}": None if speed is None else (speed[0] * _PER_RPM,)}


def _heading_control(f: dict[str, Any]) -> Values:
    counted_from_north = f.get("headingReference") in (_TRUE, None, 3)  # 3: not available
    mode = f.get("steeringMode")
    return {
        "heading_to_steer": numbers(f, "headingToSteerCourse") if counted_from_north else None,
        "track": numbers(f, "track") if counted_from_north else None,
        "commanded_rudder": numbers(f, "commandedRudderAngle"),
        "steering_mode": (float(mode or 0),) if mode in range(6) else None,
    }


READERS: dict[int, Callable[[dict[str, Any]], Values]] = {
    127237: _heading_control,
    127245: _rudder,
    127250: _heading,
    127251: lambda f: {"rate_of_turn": numbers(f, "rate")},
    127257: lambda f: {"attitude": numbers(f, "roll", "pitch", "yaw")},
    127488: _engine,
    128259: lambda f: {"water_speed": numbers(f, "speedWaterReferenced")},
    128267: lambda f: {"depth": numbers(f, "depth")},
    129025: lambda f: {"place": numbers(f, "latitude", "longitude")},
    129026: _course,
    129029: lambda f: {
        "place": numbers(f, "latitude", "longitude"),
        "altitude": numbers(f, "altitude"),
    },
    130306: _wind,
}
"""By PGN."""
