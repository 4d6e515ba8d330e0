"""Kalman filter of a landing pad: position, velocity, and acceleration of each axis.

The state is (3, 3): rows position, velocity, acceleration, columns north, east, down. All
axes have the same noise, and so one covariance (3, 3). Metres and seconds, {n}.
"""

from __future__ import annotations

import numpy as np

from ...physics.sea.numbers import Array

_UNKNOWN = (1e2, 1e1, 1e0)
"""Variances of a pad that nothing is known of but its first position."""


def first(position: Array) -> tuple[Array, Array]:
    """Return the state of a pad seen for the first time, and its covariance."""
    return np.array([position, np.zeros(3), np.zeros(3)]), np.diag(_UNKNOWN)


def moved_on(x: Array, P: Array, h: float, jerk: float) -> tuple[Array, Array]:
    """Return state and covariance ``h`` s later; ``jerk`` is its spectral density, m2/s5."""
    F = np.array([[1.0, h, 0.5 * h * h], [0.0, 1.0, h], [0.0, 0.0, 1.0]])
    Q = jerk * np.array(
        [
            [h**5 / 20.0, h**4 / 8.0, h**3 / 6.0],
            [h**4 / 8.0, h**3 / 3.0, h**2 / 2.0],
            [h**3 / 6.0, h**2 / 2.0, h],
        ]
    )
    return F @ x, F @ P @ F.T + Q


def corrected(x: Array, P: Array, row: int, value: Array, noise: float) -> tuple[Array, Array]:
    """Return both after a measurement of a row (0 position, 1 velocity) with ``noise``, 1 sigma."""
    gain = P[:, row] / (P[row, row] + noise * noise)
    x = x + np.outer(gain, value - x[row])
    P = P - np.outer(gain, P[row])
    return x, 0.5 * (P + P.T)


def ahead(x: Array, h: float, omega: float) -> Array:
    """Return the state ``h`` s later with the jerk of an oscillation, -omega^2 v."""
    jerk = -(omega**2) * x[1]
    return np.array(
        [
            x[0] + x[1] * h + x[2] * h**2 / 2.0 + jerk * h**3 / 6.0,
            x[1] + x[2] * h + jerk * h**2 / 2.0,
            x[2] + jerk * h,
        ]
    )
