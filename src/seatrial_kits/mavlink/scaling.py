"""Numbers as MAVLink's integers have them; angles and rotations."""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatrial.links.geodesy import Ned

UNKNOWN_U16 = 0xFFFF
UNKNOWN_16 = 0x7FFF
STANDARD_PRESSURE = 101_325.0
"""Of the air at the surface, Pa."""
FRESH_WATER = 1000.0
"""Density, kg/m3."""


def known_int16(value: float) -> int:
    """Return the nearest int16 that does not mean unknown, which is that of NaN."""
    return UNKNOWN_16 if math.isnan(value) else clamped(value, -(1 << 15), UNKNOWN_16 - 1)


def clamped(value: float, low: int, high: int) -> int:
    """Return the nearest whole number within limits; 0 for what is no finite number."""
    return min(max(round(value), low), high) if math.isfinite(value) else 0


def int16(value: float) -> int:
    """Return the nearest int16."""
    return clamped(value, -(1 << 15), (1 << 15) - 1)


def int32(value: float) -> int:
    """Return the nearest int32."""
    return clamped(value, -(1 << 31), (1 << 31) - 1)


def uint16(value: float) -> int:
    """Return the nearest uint16 that does not mean unknown."""
    return clamped(value, 0, UNKNOWN_U16 - 1)


def deg_e7(degrees: float) -> int:
    """Return degrees in units of 1e-7, rounded: cutting off would shift coordinates."""
    return int32(degrees * 1e7)


def milliseconds(seconds: float) -> int:
    """Return simulated time as MAVLink's time since boot: ms, which wraps after 49 days."""
    return round(seconds * 1e3) % (1 << 32)


def microseconds(seconds: float) -> int:
    """Return simulated time in us."""
    return round(seconds * 1e6)


def compass_degrees(angle: float) -> float:
    """Return an angle in rad as degrees from 0 to below 360."""
    degrees = math.degrees(angle) % 360.0
    return degrees if degrees < 360.0 else 0.0


def quaternion(attitude: Ned) -> list[float]:
    """Return the quaternion (w, x, y, z) body to {n} of Euler angles ZYX.

    It is continuous in headings from -pi to pi: of the two for one rotation, w is not negative
    at small angles of roll and pitch.
    """
    phi, theta, psi = attitude
    half = phi / 2, theta / 2, math.remainder(psi, math.tau) / 2
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in half)
    return [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]


def yaw(quaternion: Sequence[float]) -> float | None:
    """Return the heading of a quaternion (w, x, y, z) of any length; None if it has none."""
    w, x, y, z = quaternion
    length = math.hypot(w, x, y, z)
    if not math.isfinite(length) or length < 1e-6:
        return None
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def turned(heading: float, ahead: float, starboard: float) -> tuple[float, float]:
    """Return north and east of a horizontal vector given along and abeam of a heading."""
    c, s = math.cos(heading), math.sin(heading)
    return c * ahead - s * starboard, s * ahead + c * starboard
