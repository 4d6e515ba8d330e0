"""Answers to ArduPilot's simulated firmware: the physics as one line of JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.links.truth import Truth, require_possible

from .earth import Earth

RANGES = tuple(f"rng_{number}" for number in range(1, 7))
FIELDS = ("windvane", "velocity_wind", "airspeed", *RANGES, "rc", "battery")
"""What may be sent beside the motion, in the order in which it is sent.

The firmware looks for a name from the beginning of the line on, so that ``velocity`` must stand
before ``velocity_wind``, and ``windvane`` with its ``speed`` before ``airspeed``.
"""

_encoded = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode


def read_fields(text: str) -> tuple[str, ...]:
    """Return the fields that ``text`` names, in the order of `FIELDS`. Raises InputError."""
    named = text.split()
    for name in named:
        if name not in FIELDS:
            raise InputError(unknown("field", name, FIELDS))
    return tuple(field for field in FIELDS if field in named)


def blows_from(wind_angle: float) -> float:
    """Return where a wind comes from, 0 to 2 pi from the bow, of where it blows to. Angles rad."""
    return (wind_angle + math.pi) % (2.0 * math.pi)


def reply(t: float, truth: Truth, earth: Earth, others: Mapping[str, Any]) -> bytes:
    """Return the line for the physics at ``t`` (s); ``others`` are fields of `FIELDS`.

    Raises SimulationError for a motion that cannot be, which would upset the firmware's estimator.
    """
    require_possible(truth, "ArduPilot")
    content = {
        "timestamp": t,
        "imu": {"gyro": truth.rates, "accel_body": truth.specific_force},
        "position": earth.on_its_sphere(truth.position_n),
        "attitude": truth.attitude,
        "velocity": truth.velocity_n,
        **others,
    }
    # The firmware finds a value two characters after its name: there are no spaces.
    return f"\n{_encoded(content)}\n".encode()
