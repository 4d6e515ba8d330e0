"""Integrals of smooth densities over bands of frequency."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from .numbers import Array

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
_WIDEST = 0.05
"""A band wider than this in ln w is divided: 10 points there are exact to rounding."""


def integrals(density: Callable[[Array], Array], edges: Array) -> Array:
    """Return int density(w) dw of each band between neighbours of ``edges``, rising, above 0.

    Gauss-Legendre in ln w on equal parts of each band. A density must be smooth inside a band.
    """
    return np.array([_band(density, *np.log(edges[i : i + 2])) for i in range(len(edges) - 1)])


def _band(density: Callable[[Array], Array], low: float, high: float) -> float:
    parts = max(1, math.ceil((high - low) / _WIDEST))
    half = 0.5 * (high - low) / parts
    centres = low + half * (2.0 * np.arange(parts) + 1.0)
    omega = np.exp(centres[:, None] + half * _NODES)
    return float(half * ((density(omega) * omega) @ _WEIGHTS).sum())
