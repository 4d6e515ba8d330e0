"""Fields of sentences as text, by pynmeagps's names."""

from __future__ import annotations

import math
from typing import Any

from .readings import Readings

Fields = dict[str, Any]

KNOT = 1852.0 / 3600.0
"""m/s."""
FOOT = 0.3048
FATHOM = 6.0 * FOOT
CELSIUS = 273.15
MILE = 1852.0


def bearing(direction: float | None) -> str:
    """Return a direction in degrees, 0.00 to 359.99."""
    return "" if direction is None else f"{round(math.degrees(direction), 2) % 360.0:.2f}"


def number(value: float | None, decimals: int, unit: float = 1.0) -> str:
    """Return a value in a unit with some decimals, "" for none."""
    # Adding 0 takes the sign off what was rounded to minus zero.
    return "" if value is None else f"{round(value / unit, decimals) + 0.0:.{decimals}f}"


def time(of: Readings) -> str:
    """Return the time of day, UTC."""
    return f"{of.time:%H%M%S}.{of.time.microsecond // 10_000:02}"


def place(of: Readings) -> Fields:
    """Return latitude and longitude, degrees."""
    if of.position is None:
        return {"lat": "", "lon": ""}
    return {"lat": of.position[0], "lon": of.position[1]}


def variation(of: Readings, name: str, side: str) -> Fields:
    """Return the magnetic variation and its side."""
    degrees = round(math.degrees(of.variation), 1)
    return {name: f"{abs(degrees):.1f}", side: "W" if degrees < 0.0 else "E"}


def status(reading: object) -> str:
    """Return A for a reading that is valid, V for one that is not."""
    return "V" if reading is None else "A"


def mode(reading: object) -> str:
    """Return mode A for a reading that is valid, N for one that is not."""
    return "N" if reading is None else "A"
