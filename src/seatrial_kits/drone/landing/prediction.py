"""Prediction of a deck's heave and slopes from what they were, for some seconds.

Samples are (n, 3), oldest first, equally spaced: heave and two slopes; a prediction is (steps, 3),
the first one sample after the last that is known.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seatrial.physics.sea.numbers import Array

ORDER = 16
WINDOW = 120
PER_PERIOD = 14
"""Samples in a peak period."""
FARTHEST = 4 * PER_PERIOD
"""No prediction goes farther than this, in samples."""
_RIDGE = 1e-3
_BANK = np.linspace(0.4, 4.0, 73)
"""Frequencies of the harmonic model over that of the peak."""
_MEASURED = np.array([0.01, 0.003, 0.003])
"""Noise of a sample, m and rad, 1 sigma, in the harmonic model."""
_MISFIT = np.array([1e-2, 3e-3, 3e-3])
"""What that model does not explain, of the variance."""
_GAMMA = 3.3


Samples = Sequence[Sequence[float]]


def mean(samples: Samples, column: int) -> float:
    """Return the mean of a column."""
    total = 0.0
    for row in samples:
        total += row[column]
    return total / len(samples)


def coefficients(samples: Samples, column: int, mean: float) -> list[float]:
    """Return those of AR(16) for a column, newest sample first, by least squares with a ridge.

    y_k = sum_i c_i y_(k-i) about the ``mean``, of 17 samples or more; the ridge is 1e-3 of the
    mean diagonal of the normal equations. The sums of products y_(k-i) y_(k-j) are made for i = 0;
    those of i + 1 and j + 1 have one product more and one less than those of i and j.
    """
    recent = [0.0] * (ORDER + 1)
    products = [0.0] * (ORDER + 1)
    for place in range(len(samples)):
        recent = [samples[place][column] - mean, *recent[:-1]]
        if place >= ORDER:
            products = [p + recent[0] * y for p, y in zip(products, recent, strict=True)]
    oldest = [samples[ORDER - 1 - i][column] - mean for i in range(ORDER)]
    return _fitted(products, oldest, recent)


def _fitted(
    products: Sequence[float], oldest: Sequence[float], newest: Sequence[float]
) -> list[float]:
    """Return the coefficients for the sums of products, and the samples at both ends."""
    rows = [[*products]]
    for i in range(ORDER):
        later = [
            p + oldest[i] * oldest[j] - newest[i] * newest[j] for j, p in enumerate(rows[i][:ORDER])
        ]
        rows.append([products[i + 1], *later])
    trace = 0.0
    for i in range(ORDER):
        trace += rows[i + 1][i + 1]
    ridge = _RIDGE * max(trace / ORDER, 1e-12)
    normal = [
        [p + ridge if i == j else p for j, p in enumerate(row[1:])]
        for i, row in enumerate(rows[1:])
    ]
    return _solved(normal, products[1:])


def _solved(matrix: Sequence[Sequence[float]], right: Sequence[float]) -> list[float]:
    """Return x of A x = b by elimination without exchanges, for a positive definite A."""
    rows = [[*row, own] for row, own in zip(matrix, right, strict=True)]
    for i in range(ORDER):
        # A row that is eliminated loses its first element: row i begins with its pivot.
        for k in range(i + 1, ORDER):
            share = rows[k][0] / rows[i][0]
            rows[k] = [p - share * q for p, q in zip(rows[k][1:], rows[i][1:], strict=True)]
    found: list[float] = []
    for i in range(ORDER):
        row = rows[ORDER - 1 - i]
        own = row[-1]
        for p, x in zip(row[1:-1], found, strict=True):
            own = own - p * x
        found = [own / row[0], *found]
    return found


def step(fitted: Sequence[float], past: Sequence[float]) -> float:
    """Return the sample that follows ``past``, newest first, by `coefficients`; about the mean."""
    found = 0.0
    for c, y in zip(fitted, past, strict=True):
        found += c * y
    return found


def harmonic(samples: Array, steps: int) -> Array:
    """Return the next ``steps`` samples by a sum of oscillations that fits those before.

    Their frequencies are fixed, 0.4 to 4 of that of the peak, their amplitudes normal a priori:
    variances of heave as JONSWAP's spectrum at gamma 3.3, of slopes as that times omega^4. The
    amplitudes that the window makes most likely give the prediction, as a Kalman filter of
    the same oscillations without drift would.
    """
    mean, spread = samples.mean(axis=0), samples.std(axis=0) + 1e-9
    about, count = (samples - mean) / spread, len(samples)
    noise = (_MEASURED / spread) ** 2 + _MISFIT
    lags = np.arange(count + steps) * 2.0 * np.pi / PER_PERIOD
    rows = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    later = count + np.arange(steps)[:, None] - np.arange(count)
    found = np.empty((steps, samples.shape[1]))
    for axis in range(samples.shape[1]):
        weights = _expected(0 if axis == 0 else 4)
        covariance = np.cos(np.outer(lags, _BANK)) @ weights
        known = covariance[rows] + noise[axis] * np.eye(count)
        found[:, axis] = covariance[later] @ np.linalg.solve(known, about[:, axis])
    return np.asarray(found * spread + mean)


def _expected(power: int) -> Array:
    """Return the shares of a signal's variance by frequency: JONSWAP times omega^power."""
    width = np.where(_BANK <= 1.0, 0.07, 0.09)
    peaked = _GAMMA ** np.exp(-((_BANK - 1.0) ** 2) / (2.0 * width**2))
    density = _BANK ** (power - 5.0) * np.exp(-1.25 * _BANK**-4.0) * peaked
    return np.asarray(density / density.sum())


def at(prediction: Samples, steps: float) -> list[float]:
    """Return a prediction ``steps`` samples ahead (1 the first), linear in between."""
    place = min(max(steps - 1.0, 0.0), len(prediction) - 1.0)
    low = int(place)
    high = min(low + 1, len(prediction) - 1)
    return [
        p + (place - low) * (q - p) for p, q in zip(prediction[low], prediction[high], strict=True)
    ]
