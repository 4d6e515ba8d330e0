"""Motion of the water at one point, evaluated often: what `Waves.motion` says, in less time."""

from __future__ import annotations

import math

import numpy as np

from .in_order import cosines, exponentials, sines, summed
from .numbers import Array
from .waves import Waves

_DEEPEST = 600.0
"""Of k z: below there is no motion, and exp(k z) would overflow further down."""
_ORDER = [0, 1, 3, 4, 5, 2]


class Phases:
    """Cosines and sines of all components of ``waves`` at a place."""

    def __init__(self, waves: Waves) -> None:
        north, east = np.cos(waves.direction), np.sin(waves.direction)
        self.rates = np.stack([waves.omega, -waves.k * north, -waves.k * east, waves.phase])
        """Phase per second, per metre north and east, rad, and that at the origin (4, n)."""

    def at(self, t: float, x: float, y: float) -> tuple[Array, Array]:
        """Return cosines and sines at ``t``, s, and ``x`` north, ``y`` east, m."""
        omega, north, east, phase = self.rates
        theta = omega * t + north * x + east * y + phase
        return cosines(theta), sines(theta)


class Orbital:
    """Elevation, velocity and acceleration of the water at a point, with Wheeler stretching."""

    def __init__(self, waves: Waves) -> None:
        self.phases = Phases(waves)
        self.depth, self.k, self.amplitude = waves.depth, waves.k, waves.amplitude
        aw = waves.amplitude * waves.omega
        aww = aw * waves.omega
        north, east = np.cos(waves.direction), np.sin(waves.direction)
        columns = [aw * north, aw * east, aww, aw, -aww * north, -aww * east]
        self.motions = np.stack(columns, -1)
        """Of each component (n, 6) velocity north and east and acceleration down, by its cosine,
        velocity down and acceleration north and east, by its sine."""
        self.back = np.exp(-2.0 * waves.k * waves.depth)
        self.below = -np.expm1(-2.0 * waves.k * waves.depth)

    def at(self, t: float, x: float, y: float, z: float) -> tuple[float, Array]:
        """Return the elevation, m, and velocity, m/s, and acceleration, m/s2, in {n} (6,).

        At ``t``, s, and ``x`` north, ``y`` east, ``z`` below the mean surface, m. Above the water
        the values are those of the surface below.
        """
        c, s = self.phases.at(t, x, y)
        elevation = float(summed(self.amplitude * c))
        # Wheeler: the surface is where the theory has z = 0; short waves would explode above it.
        level, upright = self._decays(max(z + elevation, 0.0), elevation)
        shares = np.stack(
            [c * level, c * level, c * upright, s * upright, s * level, s * level], -1
        )
        return elevation, summed(self.motions * shares)[_ORDER]

    def _decays(self, z: float, elevation: float) -> tuple[Array, Array]:
        """Return what is left of each component's horizontal and vertical motion at a depth."""
        if math.isinf(self.depth):
            decay = exponentials(self.k * -z)
            return decay, decay
        z = z * self.depth / (self.depth + elevation)
        decay = exponentials(-np.minimum(self.k * z, _DEEPEST))
        rise = self.back / decay
        # Horizontal motion has cosh, vertical sinh.
        return (decay + rise) / self.below, (decay - rise) / self.below
