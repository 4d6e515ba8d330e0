"""Answers to ArduPilot's simulated firmware: the physics as one line of JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import pymap3d.rcurve

from seatrial.errors import InputError, unknown
from seatrial.links.geodesy import Ned
from seatrial.links.truth import Truth, require_possible

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


RADIUS = math.degrees(1.1131884502145034e-2 / 1e-7)
"""Of ArduPilot's sphere, m."""


class Earth:
    """The ground around an origin at ``latitude``, rad.

    With the radii of curvature M and N of the ellipsoid there, its latitude and longitude of a
    place of the tangent plane are, to the second order,

        dlat = n / M - e^2 tan(lat) / (2 M N),    dlon = (e + e n tan(lat) / M) / (N cos(lat))

    The third order is some centimetres at 7 km. The firmware takes metres north and east, and makes
    latitude and longitude of them on a sphere (`Location::offset_latlng`): dlat = n / R, dlon =
    e / (R cos(lat + dlat / 2)), with 1.1131884502e-2 m for 1e-7 degrees. On the ellipsoid of WGS 84
    a degree of latitude is up to 0.7 % shorter: 30 m in 5 km, between what the firmware says and
    every other link of the same vehicle.
    """

    def __init__(self, latitude: float) -> None:
        self._latitude = latitude
        self._meridian = float(pymap3d.rcurve.meridian(latitude, deg=False))
        self._transverse = float(pymap3d.rcurve.transverse(latitude, deg=False))

    def on_its_sphere(self, position: Ned) -> Ned:
        """Return the metres of which the firmware makes the place's own latitude and longitude."""
        north, east, down = position
        M, N, slope = self._meridian, self._transverse, math.tan(self._latitude)
        d_lat = north / M - east * east * slope / (2.0 * M * N)
        d_lon = (east + east * north * slope / M) / (N * math.cos(self._latitude))
        middle = math.cos(self._latitude + d_lat / 2.0)
        return RADIUS * d_lat, RADIUS * d_lon * middle, down
