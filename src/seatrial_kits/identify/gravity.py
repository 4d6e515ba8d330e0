"""Gravity compensation of accelerometer readings."""

from __future__ import annotations

from typing import Literal

import numpy as np

from seatrial.model.expressions import Vector

Reads = Literal[
    "specific-force", "gravity-less-acceleration", "gravity-plus-acceleration", "acceleration"
]


def acceleration_along(
    axis: Literal["surge", "sway", "heave"],
    reading: Vector,
    roll: Vector,
    pitch: Vector,
    *,
    reads: Reads,
    gravity: float = 9.81,
) -> Vector:
    """Return the acceleration (n,) along a body axis, m/s2, from a reading and the attitude (n,).

    With f = J1^T (0, 0, g) = g (-sin theta, cos theta sin phi, cos theta cos phi), z down:

    - "specific-force": reading = a - f, what most units give; at rest and level -g on z.
    - "gravity-less-acceleration": reading = f - a. [Paulino2015], table 7.1 reads f at rest, which
      it takes for offsets; the sign of a is inferred.
    - "gravity-plus-acceleration": reading = f + a, the other sign.
    - "acceleration": reading = a, and the attitude is not used.

    Attitude in rad, measured: an error of 0.1 deg lets 1.7 cm/s2 of gravity through. The part
    omega x v of the acceleration stays in.
    """
    f = {
        "surge": -np.sin(pitch),
        "sway": np.cos(pitch) * np.sin(roll),
        "heave": np.cos(pitch) * np.cos(roll),
    }[axis] * gravity
    return {
        "specific-force": reading + f,
        "gravity-less-acceleration": f - reading,
        "gravity-plus-acceleration": reading - f,
        "acceleration": reading,
    }[reads]
