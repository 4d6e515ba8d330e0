"""Rotations between north-east-down and body axes, and Euler-angle rates.

Frames: {n} x north, y east, z down; {b} x bow, y starboard, z down. An attitude is
(phi, theta, psi): roll, pitch and yaw in rad, of the rotation psi about z, then theta about y,
then phi about x (Fossen; [Timm2026], eq. 10). phi > 0: starboard down; theta > 0: bow up;
psi > 0: clockwise seen from above.

For components that step in Python: plain floats. Equations of motion use `symbolic`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

Vector3 = tuple[float, float, float]
Rows = tuple[Vector3, Vector3, Vector3]


def rotation(phi: float, theta: float, psi: float) -> Rows:
    """Return the rows of R(phi, theta, psi), with v_n = R v_b. Angles in rad."""
    angles = (phi, theta, psi)
    return rotation_rows([math.sin(a) for a in angles], [math.cos(a) for a in angles])  # type: ignore[return-value]


def to_ned(attitude: Sequence[float], v: Sequence[float]) -> Vector3:
    """Return R v: the vector with body components ``v``, in north-east-down."""
    a, b, c = rotation(*attitude)
    x, y, z = v
    return (
        a[0] * x + a[1] * y + a[2] * z,
        b[0] * x + b[1] * y + b[2] * z,
        c[0] * x + c[1] * y + c[2] * z,
    )


def to_body(attitude: Sequence[float], v: Sequence[float]) -> Vector3:
    """Return R^T v: the vector with north-east-down components ``v``, in body axes."""
    a, b, c = rotation(*attitude)
    x, y, z = v
    return (
        a[0] * x + b[0] * y + c[0] * z,
        a[1] * x + b[1] * y + c[1] * z,
        a[2] * x + b[2] * y + c[2] * z,
    )


def specific_force(
    attitude: Sequence[float], acceleration: Sequence[float], gravity: float
) -> Vector3:
    """Return acceleration - R^T (0, 0, gravity), m/s2, body axes: what accelerometers read.

    ``acceleration`` is inertial, in body axes. At rest and level (0, 0, -gravity).
    """
    (ax, ay, az), (gx, gy, gz) = acceleration, to_body(attitude, (0.0, 0.0, gravity))
    return (ax - gx, ay - gy, az - gz)


def cross(a: Sequence[float], b: Sequence[float]) -> Vector3:
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def rotation_rows(sines: Sequence[Any], cosines: Sequence[Any]) -> tuple[tuple[Any, Any, Any], ...]:
    """Return R by rows from the sines and cosines of (phi, theta, psi), numbers or symbols."""
    sphi, sth, spsi = sines
    cphi, cth, cpsi = cosines
    return (
        (cpsi * cth, -spsi * cphi + cpsi * sth * sphi, spsi * sphi + cpsi * cphi * sth),
        (spsi * cth, cpsi * cphi + sphi * sth * spsi, -cpsi * sphi + sth * spsi * cphi),
        (-sth, cth * sphi, cth * cphi),
    )
