"""Magnetic field of the earth: the World Magnetic Model of NOAA and the British Geological Survey.

The one place for it: whatever needs a field, its declination or inclination takes it from here.
"""

from __future__ import annotations

import datetime
import math

from pygeomag import GeoMag

FIRST, LAST = 2010.0, 2030.0
"""Years that pygeomag's models are made for: one for each five of them."""
_LIFE = 5.0


def earth_field(
    latitude: float, longitude: float, altitude: float, unix_s: float
) -> tuple[float, float, float]:
    """Return the field north, east and down, T.

    ``latitude`` and ``longitude`` rad, WGS 84, ``altitude`` m, ``unix_s`` the time, s. Spherical
    harmonics up to degree 12, by the model of these years; before `FIRST` and after `LAST` it is
    the field of then. What is local is not in the model: rocks, harbours, the vehicle's iron.
    """
    year = min(max(_year(unix_s), FIRST), LAST)
    base = min(LAST - _LIFE, year - (year - FIRST) % _LIFE)
    model = GeoMag(base_year=base)
    place = math.degrees(latitude), math.degrees(longitude), 1e-3 * altitude
    found = model.calculate(*place, year)
    return 1e-9 * found.x, 1e-9 * found.y, 1e-9 * found.z


def _year(unix_s: float) -> float:
    """Return a Unix time, s, as a year and its fraction."""
    now = datetime.datetime.fromtimestamp(unix_s, datetime.UTC)
    first, following = (
        datetime.datetime(year, 1, 1, tzinfo=datetime.UTC) for year in (now.year, now.year + 1)
    )
    return now.year + (now - first) / (following - first)
