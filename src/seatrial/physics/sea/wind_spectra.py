"""Wind over the sea: mean by height, spectra of the speed, and gusts as a sum of components."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import lattice
from .in_order import cosines, summed
from .numbers import Array, Numbers, fixed, require_positive
from .quadrature import integrals

LOWEST, HIGHEST = 1.0 / 3600.0, 0.5
"""Hz: the band that gusts are made of."""


def power_law(mean: float, z: Numbers, exponent: float = 0.12) -> Array:
    """Return U(z), m/s, from U at 10 m: exponent 0.11 to 0.14 at sea, 1/7 over land; z >= 0.1."""
    return np.asarray(mean * (np.maximum(z, 0.1) / 10.0) ** exponent)


def logarithmic(mean: float, z: Numbers, roughness: float = 2e-4) -> Array:
    """Return U(z), m/s, from U at 10 m over a surface of ``roughness``, m; z >= 0.1 m."""
    return np.asarray(mean * np.log(np.maximum(z, 0.1) / roughness) / math.log(10.0 / roughness))


def froya(mean: float, z: float, averaging: float = 3600.0) -> float:
    """Return Froya's U(z, T), m/s, from the 1 h mean at 10 m, for T of up to 3600 s.

    U (1 + C ln(z/10)) (1 - 0.41 Iu ln(T/3600)), C = 0.0573 sqrt(1 + 0.15 U),
    Iu = 0.06 (1 + 0.043 U) (z/10)^-0.22; z >= 0.1 m. Raises InputError for T not above 0.
    """
    require_positive(averaging=averaging)
    z = max(z, 0.1)
    hourly = mean * (1.0 + 0.0573 * math.sqrt(1.0 + 0.15 * mean) * math.log(z / 10.0))
    intensity = 0.06 * (1.0 + 0.043 * mean) * math.pow(z / 10.0, -0.22)
    return hourly * (1.0 - 0.41 * intensity * math.log(min(averaging, 3600.0) / 3600.0))


def davenport(f: Array, mean: float, drag: float = 0.0025) -> Array:
    """Return 4 k L U x/(1 + x^2)^(4/3), m2/s2/Hz, x = f L/U, L = 1200 m, k = ``drag``."""
    x = 1200.0 * f / mean
    return np.asarray(4.0 * drag * 1200.0 * mean * x / (1.0 + x**2) ** (4.0 / 3.0))


def harris(f: Array, mean: float, drag: float = 0.0025) -> Array:
    """Return 4 k L U/(2 + x^2)^(5/6), m2/s2/Hz, x = f L/U, L = 1800 m, k = ``drag``."""
    x = 1800.0 * f / mean
    return np.asarray(4.0 * drag * 1800.0 * mean / (2.0 + x**2) ** (5.0 / 6.0))


def norsok(f: Array, mean: float, z: float = 10.0) -> Array:
    """Return Froya's (NORSOK's) spectrum, m2/s2/Hz, of the 1 h mean at 10 m; 1/600 to 0.5 Hz.

    320 (U/10)^2 (z/10)^0.45/(1 + x^n)^(5/(3n)), x = 172 f (z/10)^(2/3) (U/10)^-0.75, n = 0.468
    """
    n = 0.468
    x = 172.0 * f * (z / 10.0) ** (2.0 / 3.0) * (mean / 10.0) ** -0.75
    return np.asarray(320.0 * (mean / 10.0) ** 2 * (z / 10.0) ** 0.45 / (1.0 + x**n) ** (5 / 3 / n))


@dataclass(frozen=True, eq=False)
class Gusts:
    """A speed beside the mean, sum a cos(w t + e), m/s, the same everywhere."""

    amplitude: Array
    omega: Array
    phase: Array

    def speed(self, t: float) -> float:
        """Return the speed to be added to the mean at ``t``, m/s."""
        return float(summed(self.amplitude * cosines(self.omega * t + self.phase)))


def gust_energies(spectrum: Callable[[Array], Array], per_octave: int = 10) -> Array:
    """Return int S df, m2/s2, of each band of `gusts`, of ``spectrum``, m2/s2/Hz of f, Hz."""
    return integrals(spectrum, lattice.edges(_bands(per_octave), per_octave) / math.tau)


def gusts(energies: Array, seed: int, per_octave: int = 10) -> Gusts:
    """Return a realisation of a spectrum with `gust_energies`, from 1/3600 to 0.5 Hz.

    Keyed like waves: frequency and phase of a band depend on its place and ``seed`` alone.
    """
    indices = _bands(per_octave)
    return Gusts(
        fixed(np.sqrt(2.0 * energies)),
        fixed(lattice.frequencies("wind", seed, indices, lattice.edges(indices, per_octave))),
        fixed(math.tau * lattice.draws("wind", seed, lattice.PHASE, indices)),
    )


def _bands(per_octave: int) -> range:
    return lattice.bands(math.tau * LOWEST, math.tau * HIGHEST, per_octave)
