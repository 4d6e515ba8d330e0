"""Unit quaternions (w, x, y, z) in arrays, the last axis over their members.

SciPy has them too, and takes longer to import than a report to write.
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]


def product(first: Any, second: Any) -> Array:
    """Return the rotation that is ``second``, then ``first``."""
    w, x, y, z = np.moveaxis(np.asarray(first, dtype=float), -1, 0)
    a, b, c, d = np.moveaxis(np.asarray(second, dtype=float), -1, 0)
    members = (
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    )
    return np.stack(members, -1)


def about(axis: Any, angle: Any) -> Array:
    """Return the rotation by an angle, rad, about an axis of any length."""
    unit = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    half = 0.5 * np.asarray(angle, dtype=float)[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * unit], -1)


def turned(rotation: Any, vectors: Any) -> Array:
    """Return vectors, the last axis over x, y and z, turned by one rotation."""
    w, axis = float(rotation[0]), np.asarray(rotation[1:], dtype=float)
    found = np.asarray(vectors, dtype=float)
    aside = 2.0 * np.cross(axis, found)
    return np.asarray(found + w * aside + np.cross(axis, aside))


def of_euler(angles: Any) -> Array:
    """Return the rotation by yaw, then pitch, then roll, of (roll, pitch, yaw), rad.

    It takes body axes to those that the angles are counted from ([Fossen2021], section 2.2).
    """
    phi, theta, psi = np.moveaxis(np.asarray(angles, dtype=float), -1, 0)
    yaw, pitch = about((0.0, 0.0, 1.0), psi), about((0.0, 1.0, 0.0), theta)
    return product(product(yaw, pitch), about((1.0, 0.0, 0.0), phi))


def continuous(quaternions: Array) -> Array:
    """Return the same rotations, row by row, each with the sign nearer to the one before."""
    jumps = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0
    signs = np.where(np.concatenate([[0], np.cumsum(jumps)]) % 2 == 1, -1.0, 1.0)
    return np.asarray(signs[: len(quaternions), None] * quaternions)


def to_euler(quaternions: Any) -> tuple[Array, Array, Array]:
    """Return roll, pitch and yaw, rad, of rotations: the inverse of `of_euler`."""
    w, x, y, z = np.moveaxis(np.asarray(quaternions, dtype=float), -1, 0)
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return roll, pitch, yaw
