"""Slow drift of a craft in waves, by Newman's approximation from mean drift coefficients."""

from __future__ import annotations

import numpy as np

from .numbers import Array, Complex


def mean_drift(amplitude: Array, coefficients: Array) -> Array:
    """Return sum a^2 D, N, of coefficients D (..., components), N/m2."""
    return np.asarray(coefficients @ np.square(amplitude))


def slow_drift(phasors: Complex, coefficients: Array) -> Array:
    """Return Re[conj(sum a e^(i theta)) sum a D e^(i theta)], N: mean and differences alone.

    ``phasors`` a exp(i theta) at the craft, ``coefficients`` D (..., components), N/m2, of any
    sign. There are no sum frequencies in it.
    """
    return np.asarray((np.conj(phasors.sum()) * (coefficients @ phasors)).real)
