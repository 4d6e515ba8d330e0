"""Spreading of waves about their mean direction, by the cosine of the angle or of its half."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .numbers import Array, Numbers, require_positive


@dataclass(frozen=True)
class Spreading:
    """Density of energy over D, the angle from the mean direction, rad:

        G(D) = N cos^power(D / divisor) for |D| <= divisor pi/2, else 0
        N = Gamma(power/2 + 1) / (divisor sqrt(pi) Gamma(power/2 + 1/2))

    Made by `cos_2s` and `cos_n`, whose parameters differ in meaning.
    """

    power: float
    divisor: float

    def density(self, angle: Numbers) -> Array:
        """Return G, 1/rad, at ``angle`` from the mean, rad; of period 2 pi."""
        turned = np.remainder(np.asarray(angle) + math.pi, math.tau) - math.pi
        half = self.power / 2.0
        scale = math.exp(math.lgamma(half + 1.0) - math.lgamma(half + 0.5))
        scale /= self.divisor * math.sqrt(math.pi)
        cosine = np.maximum(np.cos(turned / self.divisor), 0.0)
        return np.asarray(scale * cosine**self.power)

    def angle(self, share: Numbers) -> Array:
        """Return D, rad, below which the ``share``, 0 to 1, of the energy is."""
        centred = 2.0 * np.asarray(share, dtype=float) - 1.0
        from scipy.special import betaincinv  # slow to import, and few runs have a sea

        square = betaincinv(0.5, 0.5 * self.power + 0.5, np.abs(centred))
        return np.asarray(np.sign(centred) * self.divisor * np.arcsin(np.sqrt(square)))


def cos_2s(s: float) -> Spreading:
    """Return cos^2s(D/2): 5 to 15 for a wind sea, 25 and more for swell.

    Raises InputError for s that is not above 0.
    """
    require_positive(s=s)
    return Spreading(2.0 * s, 2.0)


def cos_n(n: float) -> Spreading:
    """Return cos^n D: 2 to 4 for a wind sea, 10 and more for swell.

    Raises InputError for n that is not above 0.
    """
    require_positive(n=n)
    return Spreading(n, 1.0)
