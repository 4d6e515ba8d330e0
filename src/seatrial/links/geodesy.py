"""Latitude, longitude and altitude of positions in {n}, and back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pymap3d

Ned = tuple[float, float, float]
"""North, east, down, m."""


@dataclass(frozen=True)
class Origin:
    """Origin of {n}: WGS 84, latitude and longitude in rad, altitude in m.

    North and east lie in the plane that touches the ellipsoid at the origin; down is counted
    from the surface through the origin, not from that plane, which at 10 km is 8 m above the
    sea. So depth z is altitude -z wherever the vehicle is, and `position` undoes `geodetic`
    within 1e-6 of the distance up to 10 km. No geoid: altitude is above the surface that the
    origin's altitude is counted from.
    """

    latitude: float
    longitude: float
    altitude: float = 0.0

    def geodetic(self, position: Ned) -> Ned:
        """Return latitude and longitude in degrees, altitude in m, of a position in {n}."""
        north, east, down = position
        latitude, longitude, _ = pymap3d.ned2geodetic(
            north, east, 0.0, *self._degrees(), self.altitude
        )
        return float(latitude), float(longitude), self.altitude - down

    def position(self, latitude: float, longitude: float, altitude: float) -> Ned:
        """Return the position in {n} of latitude and longitude in degrees, altitude in m."""
        north, east, _ = pymap3d.geodetic2ned(
            latitude, longitude, self.altitude, *self._degrees(), self.altitude
        )
        return float(north), float(east), self.altitude - altitude

    def _degrees(self) -> tuple[float, float]:
        return math.degrees(self.latitude), math.degrees(self.longitude)
