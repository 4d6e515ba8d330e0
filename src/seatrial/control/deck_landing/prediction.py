"""Prediction of a deck's heave and slopes from what they were, for some seconds.

Samples are (n, 3), oldest first, equally spaced: heave and two slopes; a prediction is (steps, 3),
the first one sample after the last that is known.
"""

from __future__ import annotations

import numpy as np

from ...physics.sea.numbers import Array

ORDER = 16
WINDOW = 120
PER_PERIOD = 14
"""Samples in a peak period."""
_RIDGE = 1e-3
_BANK = np.linspace(0.4, 4.0, 73)
"""Frequencies of the harmonic model over that of the peak."""
_MEASURED = np.array([0.01, 0.003, 0.003])
"""Noise of a sample, m and rad, 1 sigma, in the harmonic model."""
_MISFIT = np.array([1e-2, 3e-3, 3e-3])
"""What that model does not explain, of the variance."""
_GAMMA = 3.3


def coefficients(samples: Array) -> Array:
    """Return those of AR(16), (3, 16), newest sample first, by least squares with a ridge.

    y_k = sum_i c_i y_(k-i) about the mean of the samples; the ridge is 1e-3 of the mean diagonal
    of the normal equations. Fewer than 2 ORDER samples give none: all coefficients 0.
    """
    count = len(samples)
    fitted = np.zeros((samples.shape[1], ORDER))
    if count < 2 * ORDER:
        return fitted
    about = samples - samples.mean(axis=0)
    places = np.arange(ORDER, count)[:, None] - np.arange(1, ORDER + 1)
    for axis in range(samples.shape[1]):
        past, now = about[places, axis], about[ORDER:, axis]
        normal = past.T @ past
        ridge = _RIDGE * max(float(np.trace(normal)) / ORDER, 1e-12)
        fitted[axis] = np.linalg.solve(normal + ridge * np.eye(ORDER), past.T @ now)
    return fitted


def autoregressive(samples: Array, fitted: Array, steps: int) -> Array:
    """Return the next ``steps`` samples by `coefficients`."""
    mean = samples.mean(axis=0)
    past = (samples[-ORDER:] - mean)[::-1].T.copy()
    found = np.empty((steps, samples.shape[1]))
    for k in range(steps):
        new = np.einsum("ij,ij->i", fitted, past)
        past[:, 1:] = past[:, :-1].copy()
        past[:, 0] = new
        found[k] = new + mean
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


def at(prediction: Array, steps: float) -> Array:
    """Return a prediction ``steps`` samples ahead (1 the first), linear in between."""
    place = min(max(steps - 1.0, 0.0), len(prediction) - 1.0)
    low = int(place)
    high = min(low + 1, len(prediction) - 1)
    return np.asarray(prediction[low] + (place - low) * (prediction[high] - prediction[low]))
