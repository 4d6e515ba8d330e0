"""Turns between the axes of vessels and those of ROS (REP 103).

Here {n} is north-east-down and {b} bow-starboard-down; there the world is east-north-up and the
body ahead-left-up: x_enu = P x_ned and x_flu = F x_frd, with

    P = [[0, 1, 0], [1, 0, 0], [0, 0, -1]],    F = diag(1, -1, -1),    R_there = P R F
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

TO_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
"""P; its own inverse."""
TO_FLU = np.diag([1.0, -1.0, -1.0])
"""F; its own inverse."""

Vector = tuple[float, float, float]
_HALF = math.sqrt(0.5)


def enu(vector: Sequence[float]) -> Vector:
    """Return a vector in {n} in east-north-up, or one in east-north-up in {n}."""
    return vector[1], vector[0], -vector[2]


def flu(vector: Sequence[float]) -> Vector:
    """Return a vector in {b} in ahead-left-up, or one in ahead-left-up in {b}.

    Of angular velocities and moments too: both axes systems are right-handed.
    """
    return vector[0], -vector[1], -vector[2]


def quaternion(attitude: Sequence[float]) -> tuple[float, float, float, float]:
    """Return x, y, z, w of ahead-left-up in east-north-up, of Euler angles ZYX here, rad.

    With q of R = Rz(psi) Ry(theta) Rx(phi): P and F are half turns, about (1, 1, 0) and x, so
    that q_there = p q f, p = (1, 1, 0) / sqrt(2), f = (1, 0, 0), both with the real part 0.
    """
    cr, sr = math.cos(0.5 * attitude[0]), math.sin(0.5 * attitude[0])
    cp, sp = math.cos(0.5 * attitude[1]), math.sin(0.5 * attitude[1])
    cy, sy = math.cos(0.5 * attitude[2]), math.sin(0.5 * attitude[2])
    w = cr * cp * cy + sr * sp * sy
    x = sr * cp * cy - cr * sp * sy
    y = cr * sp * cy + sr * cp * sy
    z = cr * cp * sy - sr * sp * cy
    # p q f, up to its sign, with a real part that is not negative.
    found = _HALF * (x + y), _HALF * (x - y), _HALF * (w - z), _HALF * (w + z)
    sign = math.copysign(1.0, found[3])
    return sign * found[0], sign * found[1], sign * found[2], sign * found[3]


def heading(turn: Sequence[float]) -> float:
    """Return the heading, clockwise from north, -pi to pi, of the quaternion x, y, z, w there."""
    x, y, z, w = turn
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return math.remainder(0.5 * math.pi - yaw, math.tau)


def turned(covariance: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return T C T^T, the covariance in the axes that ``turn`` leads to."""
    return np.asarray(turn @ covariance @ turn.T)
