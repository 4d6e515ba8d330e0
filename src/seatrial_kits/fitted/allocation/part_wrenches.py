"""Wrenches of parts of a body: force and moment about its origin, per unit of what a part gives."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from seatrial.errors import InputError

Array = npt.NDArray[np.float64]

AXES = ("surge", "sway", "heave", "roll", "pitch", "yaw")
"""Rows of a wrench in body axes: X, Y, Z in N, K, M, N in N.m."""


def thrust_wrench(position: Sequence[float], axis: Sequence[float], angle: float) -> Array:
    """Return (d, r x d) of a thrust along ``axis``, turned by ``angle`` about z, from x to y.

    r = ``position``, m; d = R_z(angle) axis, a unit vector in body axes.
    """
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis
    return _wrench(position, (c * x - s * y, s * x + c * y, z))


def lift_wrench(position: Sequence[float], roll: float) -> Array:
    """Return (n, r x n) of the lift of a foil whose span is turned by ``roll`` about x.

        n = (0, -cos roll, -sin roll)

    is its direction on a craft ahead with a positive angle, right-handed about the span: at roll
    0, a rudder, to port, which aft turns the craft to starboard; at roll 90 deg, a stern plane,
    upwards, which aft turns the bow down.
    """
    return _wrench(position, (0.0, -math.cos(roll), -math.sin(roll)))


def _wrench(position: Sequence[float], direction: Sequence[float]) -> Array:
    return np.concatenate([direction, np.cross(position, direction)])


def read_axes(text: str) -> list[int]:
    """Return the rows that a text such as ``surge yaw`` names. Raises InputError."""
    words = text.split()
    for word in words:
        if word not in AXES or words.count(word) > 1:
            raise InputError(f"axes: {text!r} must name some of {', '.join(AXES)}, each once")
    return [AXES.index(word) for word in words]


def capacities(columns: Array) -> Array:
    """Return the largest force or moment that columns of full effect give, row by row."""
    most: Array = np.abs(columns).sum(axis=1)
    return most


def given_alone(columns: Array, rows: Sequence[int]) -> list[bool]:
    """Return for each of ``rows`` whether the columns give it without another one of them.

    Row i is, if its unit vector is in the range of the rows' columns: (B B+)_ii = 1.
    """
    force = capacities(columns)[:3].max(initial=0.0)
    asked = columns[list(rows)]
    size = capacities(asked)
    there = size > 1e-9 * force
    scaled = asked[there] / size[there, None]
    projected = np.diag(scaled @ np.linalg.pinv(scaled, rcond=1e-9))
    alone = np.zeros(len(rows), dtype=bool)
    alone[there] = projected > 1.0 - 1e-6
    return [bool(each) for each in alone]
