"""Functions and sums whose bits C has too: those of the C library, and term after term."""

from __future__ import annotations

import math

import numpy as np

from .numbers import Array


def cosines(angles: Array) -> Array:
    """Return the cosine of each of ``angles`` (n,), rad. Raises ValueError for an infinite one."""
    return np.array([math.cos(angle) for angle in angles.tolist()])


def sines(angles: Array) -> Array:
    """Return the sine of each of ``angles`` (n,), rad. Raises ValueError for an infinite one."""
    return np.array([math.sin(angle) for angle in angles.tolist()])


def exponentials(powers: Array) -> Array:
    """Return e to each of ``powers`` (n,). Raises OverflowError for one above 709."""
    return np.array([math.exp(power) for power in powers.tolist()])


def summed(terms: Array) -> Array:
    """Return the sum over the first axis, from 0 on in its order; NumPy's own sums take others."""
    return np.asarray(np.add.accumulate(terms)[-1] + 0.0)
