"""Sensors of a vehicle's profile, as text: for firmwares whose instruments follow from them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ..errors import InputError

Sensor = Mapping[str, Any]
Sensors = Mapping[str, Sensor]


def read_instruments(text: str) -> Sensors:
    """Return the sensors of a profile, by name: kind and values, SI. Raises InputError."""
    try:
        sensors: Sensors = json.loads(text or "{}")
        if not all(isinstance(each["kind"], str) for each in sensors.values()):
            raise TypeError
    except (ValueError, TypeError, KeyError, AttributeError):
        raise InputError(
            f"instruments: a JSON object of sensors with their kinds is needed, not {text[:80]!r}"
        ) from None
    return sensors


def first_of(sensors: Sensors, kind: str) -> tuple[str, Sensor | None]:
    """Return name and values of the first sensor of a kind; None if there is none."""
    return next(((name, one) for name, one in sensors.items() if one["kind"] == kind), ("", None))


def axis(value: Any, index: int = 0) -> float:
    """Return one element: a file may give one value for all, a component's start is a list."""
    if not isinstance(value, (list, tuple)):
        return float(value)
    return float(value[index if len(value) > 1 else 0])


def three(value: Any) -> list[float]:
    """Return the elements of a port with three axes."""
    return [axis(value, index) for index in range(3)]
