"""Positions as ArduPilot's simulated receiver turns them back into latitude and longitude.

The firmware takes metres north and east, and makes latitude and longitude of them on a sphere
(`Location::offset_latlng`): dlat = n / R, dlon = e / (R cos(lat + dlat / 2)), with 1.1131884502e-2
m for 1e-7 degrees. On the ellipsoid of WGS 84 a degree of latitude is up to 0.7 % shorter: 30 m in
5 km, between what the firmware says and every other link of the same vehicle.
"""

from __future__ import annotations

import math

import pymap3d.rcurve

from seatrial.links.geodesy import Ned

RADIUS = math.degrees(1.1131884502145034e-2 / 1e-7)
"""Of ArduPilot's sphere, m."""


class Earth:
    """The ground around an origin at ``latitude``, rad.

    With the radii of curvature M and N of the ellipsoid there, its latitude and longitude of a
    place of the tangent plane are, to the second order,

        dlat = n / M - e^2 tan(lat) / (2 M N),    dlon = (e + e n tan(lat) / M) / (N cos(lat))

    The third order is some centimetres at 7 km.
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
