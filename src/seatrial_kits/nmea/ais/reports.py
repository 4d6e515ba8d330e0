"""AIS messages, fields by pyais's names, as reports of `received.targets`."""

from __future__ import annotations

import math
from typing import Any

from .station import Fields

_KNOT = 1852.0 / 3600.0
_MOVING = (1, 2, 3, 9, 18, 19, 21, 27)
"""Messages with a place; 21 is of a mark."""
_NAMED = (5, 19, 21, 24)
_NO_COURSE, _NO_SPEED = 360.0, 102.25


def report(received: Fields) -> dict[str, Any] | None:
    """Return the report of a message, None for one about no station's place or name."""
    kind = received["msg_type"]
    if kind not in (*_MOVING, *_NAMED):
        return None
    found: dict[str, Any] = {"mmsi": int(received["mmsi"])}
    if kind in _MOVING and abs(received["lat"]) <= 90.0 and abs(received["lon"]) <= 180.0:
        found |= {"latitude": received["lat"], "longitude": received["lon"]}
    course, speed = received.get("course"), received.get("speed")
    if course is not None and course < _NO_COURSE:
        found["course"] = math.radians(course)
    if speed is not None and speed < _NO_SPEED:
        found["speed"] = float(speed) * _KNOT
    heading = received.get("heading")
    if heading is not None and heading < _NO_COURSE:
        found["heading"] = math.radians(heading)
    name = str(received.get("shipname") or received.get("name") or "").strip(" @")
    if name:
        found["name"] = name
    if received.get("to_bow") is not None:
        found["length"] = float(received["to_bow"] + received["to_stern"])
        found["beam"] = float(received["to_port"] + received["to_starboard"])
    return found
