"""Kalman filter of a landing pad: position, velocity, and acceleration of each axis.

The state is (3, 3): rows position, velocity, acceleration, columns north, east, down. All
axes have the same noise, and so one covariance (3, 3). Metres and seconds, {n}.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Rows = list[list[float]]
_UNKNOWN = (1e2, 1e1, 1e0)
"""Variances of a pad that nothing is known of but its first position."""


def first(position: Sequence[float]) -> tuple[Rows, Rows]:
    """Return the state of a pad seen for the first time, and its covariance."""
    a, b, c = _UNKNOWN
    return (
        [[position[0], position[1], position[2]], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
    )


def moved_on(x: Rows, P: Rows, h: float, omega: float, jerk: float) -> tuple[Rows, Rows]:
    """Return state (`ahead`) and covariance ``h`` s later; ``jerk`` is its density, m2/s5."""
    noise = [
        [h**5 / 20.0, h**4 / 8.0, h**3 / 6.0],
        [h**4 / 8.0, h**3 / 3.0, h**2 / 2.0],
        [h**3 / 6.0, h**2 / 2.0, h],
    ]
    # F P F^T, with F^T from the right as F on the columns: P is symmetric.
    grown = ahead(_columns(ahead(P, h, omega)), h, omega)
    return ahead(x, h, omega), [
        [p + jerk * q for p, q in zip(row, own, strict=True)]
        for row, own in zip(grown, noise, strict=True)
    ]


def corrected(
    x: Rows, P: Rows, row: int, value: Sequence[float], noise: float
) -> tuple[Rows, Rows]:
    """Return both after a measurement of a row (0 position, 1 velocity) with ``noise``, 1 sigma."""
    variance = P[row][row] + noise * noise
    gain = [each[row] / variance for each in P]
    missed = [v - own for v, own in zip(value, x[row], strict=True)]
    less = [
        [p - g * q for p, q in zip(each, P[row], strict=True)]
        for g, each in zip(gain, P, strict=True)
    ]
    return (
        [
            [own + g * m for own, m in zip(each, missed, strict=True)]
            for g, each in zip(gain, x, strict=True)
        ],
        [
            [0.5 * (a + b) for a, b in zip(one, other, strict=True)]
            for one, other in zip(less, _columns(less), strict=True)
        ],
    )


def ahead(x: Rows, h: float, omega: float) -> Rows:
    """Return the state ``h`` s later of an oscillation, of which a' = -omega^2 v.

    F = ((1, s / omega, (1 - c) / omega^2), (0, c, s / omega), (0, -omega s, c)) with the cosine c
    and sine s of omega h.
    """
    c, s = math.cos(omega * h), math.sin(omega * h)
    mean, half = s / omega, (1.0 - c) / omega**2
    place, speed, push = x
    return [
        [p + mean * v + half * a for p, v, a in zip(place, speed, push, strict=True)],
        [c * v + mean * a for v, a in zip(speed, push, strict=True)],
        [c * a - omega * s * v for v, a in zip(speed, push, strict=True)],
    ]


def _columns(rows: Rows) -> Rows:
    return [list(column) for column in zip(*rows, strict=True)]
