"""GPS satellites above a place: directions, signal strengths and dilutions of precision.

The 24 slots of the nominal constellation, circular orbits of 26559.7 km at 55 degrees: GPS
Standard Positioning Service Performance Standard (2020), table of the baseline constellation, for
0 h UTC of 1 July 1993. Slots keep their places in the orbits for ever; orbits turn with the stars
alone, and the earth is a sphere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

_EPOCH_S = 741_484_800.0
"""Unix time of 1 July 1993, 0 h UTC."""
_SIDEREAL_EPOCH = math.radians(278.9)
"""Greenwich sidereal angle then."""
_EARTH_RATE = 7.292115e-5
_ORBIT, _EARTH = 26_559.7e3, 6_371.0e3
_ORBIT_RATE = math.sqrt(3.986004418e14 / _ORBIT**3)
_INCLINATION = math.radians(55.0)
_NODE, _BETWEEN_PLANES = 272.847, 60.0
_SLOTS = (
    (268.126, 161.786, 11.676, 41.806),
    (80.956, 173.336, 309.976, 204.376),
    (111.876, 11.796, 339.666, 241.556),
    (135.226, 265.446, 35.156, 167.356),
    (197.046, 302.596, 66.066, 333.686),
    (238.886, 345.226, 105.206, 135.346),
)
"""Arguments of latitude in the planes A to F, degrees."""
MASK = math.radians(5.0)
"""Elevation below which a receiver takes none."""
_ZENITH_DB, _HORIZON_DB = 50.0, 35.0
"""Signal over noise in 1 Hz: usual of receivers; in between by the sine of the elevation."""
_WORST = 99.99


@dataclass(frozen=True)
class Satellite:
    """One above the mask, rad."""

    prn: int
    elevation: float
    azimuth: float
    """Clockwise from north."""
    signal: float
    """Carrier over noise density, dB-Hz."""


@dataclass(frozen=True)
class Sky:
    """What a receiver uses: satellites, the highest first, and dilutions of precision."""

    satellites: tuple[Satellite, ...] = ()
    pdop: float = _WORST
    hdop: float = _WORST
    vdop: float = _WORST
    tdop: float = _WORST


def sky(unix_s: float, latitude: float, longitude: float) -> Sky:
    """Return what is above a place, degrees, at a Unix time, s; as of the whole second."""
    return _sky(math.floor(unix_s), round(latitude, 2), round(longitude, 2))


@lru_cache(64)
def _sky(unix_s: int, latitude: float, longitude: float) -> Sky:
    passed = unix_s - _EPOCH_S
    east, north, up = _directions(math.radians(latitude), math.radians(longitude))
    greenwich = _SIDEREAL_EPOCH + _EARTH_RATE * passed
    found, lines = [], []
    for number in range(24):
        plane, slot = divmod(number, 4)
        node = math.radians(_NODE + _BETWEEN_PLANES * plane) - greenwich
        along = math.radians(_SLOTS[plane][slot]) + math.fmod(_ORBIT_RATE * passed, math.tau)
        x, y = math.cos(along), math.sin(along) * math.cos(_INCLINATION)
        z = math.sin(along) * math.sin(_INCLINATION)
        place = np.array(
            (x * math.cos(node) - y * math.sin(node), x * math.sin(node) + y * math.cos(node), z)
        )
        away = _ORBIT * place - _EARTH * up
        line = away / np.linalg.norm(away)
        elevation = math.asin(float(line @ up))
        if elevation < MASK:
            continue
        signal = _HORIZON_DB + (_ZENITH_DB - _HORIZON_DB) * math.sin(elevation)
        azimuth = math.atan2(float(line @ east), float(line @ north)) % math.tau
        found.append(Satellite(number + 1, elevation, azimuth, signal))
        lines.append((float(line @ east), float(line @ north), float(line @ up), 1.0))
    found.sort(key=lambda each: (-each.elevation, each.prn))
    return Sky(tuple(found), *_dilutions(np.array(lines)))


def _directions(latitude: float, longitude: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    sl, cl, so, co = (
        *(math.sin(latitude), math.cos(latitude)),
        *(math.sin(longitude), math.cos(longitude)),
    )
    east = np.array((-so, co, 0.0))
    return east, np.array((-sl * co, -sl * so, cl)), np.array((cl * co, cl * so, sl))


def _dilutions(lines: np.ndarray) -> tuple[float, float, float, float]:
    """Return PDOP, HDOP, VDOP and TDOP of the directions east, north, up and 1 (clock)."""
    if len(lines) < 4:
        return _WORST, _WORST, _WORST, _WORST
    e, n, u, t = np.diag(np.linalg.pinv(lines.T @ lines)).tolist()
    found = (math.sqrt(e + n + u), math.sqrt(e + n), math.sqrt(u), math.sqrt(t))
    pdop, hdop, vdop, tdop = (min(each, _WORST) for each in found)
    return pdop, hdop, vdop, tdop
