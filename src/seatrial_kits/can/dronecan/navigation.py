"""Position and attitude on the bus: Fix2 and ahrs.Solution, from values and back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from seatrial.links.geodesy import Ned, Origin
from seatrial.links.unconnected import NOT_CONNECTED

from .codec import equipment

Fix2: Any = equipment.gnss.Fix2
Solution: Any = equipment.ahrs.Solution

Vector = tuple[float, float, float]

_SCALE = 1e8  # of degrees
_MM = 1e3
_SATELLITES = 12  # assumed: what autopilots want to see before they trust a receiver


class Motion(NamedTuple):
    """Attitude (phi, theta, psi), rad; rates (p, q, r), rad/s; acceleration (x, y, z), m/s2."""

    attitude: Vector
    rates: Vector
    acceleration: Vector


def fix(origin: Origin, position: Ned, velocity: Sequence[float], valid: bool, utc_us: int) -> Any:
    """Return a Fix2 of a position in {n} (m) and a velocity, north-east-down (m/s).

    There is no geoid: both heights are the altitude. Time is UTC, us. Not valid: no fix.
    """
    latitude, longitude, altitude = origin.geodetic(position)
    message = Fix2(
        latitude_deg_1e8=round(latitude * _SCALE),
        longitude_deg_1e8=round(longitude * _SCALE),
        height_ellipsoid_mm=round(altitude * _MM),
        height_msl_mm=round(altitude * _MM),
        ned_velocity=list(velocity),
        sats_used=_SATELLITES if valid else 0,
        pdop=1.0 if valid else 99.0,
    )
    message.status = message.STATUS_3D_FIX if valid else message.STATUS_NO_FIX
    message.gnss_timestamp.usec = utc_us
    message.gnss_time_standard = message.GNSS_TIME_STANDARD_UTC
    return message


def fixed(origin: Origin, message: Any) -> tuple[Ned, Vector] | None:
    """Return position in {n} and velocity of a Fix2, None if it has no fix in two dimensions."""
    if message.status < message.STATUS_2D_FIX:
        return None
    latitude, longitude = message.latitude_deg_1e8 / _SCALE, message.longitude_deg_1e8 / _SCALE
    position = origin.position(latitude, longitude, message.height_msl_mm / _MM)
    velocity = _finite(message.ned_velocity)
    return (position, velocity) if velocity is not None else None


def solution(motion: Motion) -> Any:
    """Return an ahrs.Solution: the quaternion turns body axes (x bow, y starboard) to {n}.

    Rates and accelerations that are not connected are NaN.
    """
    x, y, z, w = quaternion(motion.attitude)
    return Solution(
        orientation_xyzw=[x, y, z, w],
        angular_velocity=[_or_nan(value) for value in motion.rates],
        linear_acceleration=[_or_nan(value) for value in motion.acceleration],
    )


def solved(message: Any) -> Motion | None:
    """Return the motion of an ahrs.Solution, None if it has no orientation.

    Rates and accelerations that are unknown are 0.
    """
    orientation = [float(value) for value in message.orientation_xyzw]
    if not all(map(math.isfinite, orientation)):
        return None
    x, y, z, w = orientation
    if math.hypot(x, y, z, w) < 0.5:
        return None
    rates, acceleration = (
        _three([value if math.isfinite(value) else 0.0 for value in map(float, each)])
        for each in (message.angular_velocity, message.linear_acceleration)
    )
    return Motion(euler(x, y, z, w), rates, acceleration)


def quaternion(attitude: Sequence[float]) -> tuple[float, float, float, float]:
    """Return (x, y, z, w), with w >= 0, of Euler angles ZYX, rad."""
    (sp, cp), (st, ct), (sy, cy) = ((math.sin(a / 2), math.cos(a / 2)) for a in attitude)
    x, y = sp * ct * cy - cp * st * sy, cp * st * cy + sp * ct * sy
    z, w = cp * ct * sy - sp * st * cy, cp * ct * cy + sp * st * sy
    return (x, y, z, w) if w >= 0.0 else (-x, -y, -z, -w)


def euler(x: float, y: float, z: float, w: float) -> Vector:
    """Return Euler angles ZYX, rad, of a quaternion of any length above 0."""
    square = x * x + y * y + z * z + w * w
    sine = 2.0 * (w * y - z * x) / square
    return (
        math.atan2(2.0 * (w * x + y * z), w * w - x * x - y * y + z * z),
        math.asin(max(-1.0, min(1.0, sine))),
        math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z),
    )


def _or_nan(value: float) -> float:
    return value if value < NOT_CONNECTED else math.nan


def _finite(values: Sequence[float]) -> Vector | None:
    numbers = [float(value) for value in values]
    return _three(numbers) if all(map(math.isfinite, numbers)) else None


def _three(values: Sequence[float]) -> Vector:
    a, b, c = values
    return a, b, c
