"""Motion of the water at one point, evaluated often: what `Waves.motion` says, in less time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .numbers import Array
from .waves import Waves

_DEEPEST = 600.0
"""Of k z: below there is no motion, and exp(k z) would overflow further down."""


class Phases:
    """Cosines and sines of all components at a place, into one array that is used again."""

    def __init__(self, waves: Waves) -> None:
        north, east = np.cos(waves.direction), np.sin(waves.direction)
        count = len(waves.omega)
        self._by = np.stack([waves.omega, -waves.k * north, -waves.k * east, waves.phase], 1)
        self._at = np.array([0.0, 0.0, 0.0, 1.0])
        self._theta = np.empty(count)
        self.both = np.empty(2 * count)
        """cos theta of all components, then sin theta."""
        self.cosines, self.sines = self.both[:count], self.both[count:]

    def move(self, t: float, x: float, y: float) -> Array:
        """Evaluate at ``t``, s, and ``x`` north, ``y`` east, m; return ``both``."""
        at = self._at
        at[0], at[1], at[2] = t, x, y
        self._by.dot(at, out=self._theta)
        np.cos(self._theta, out=self.cosines)
        np.sin(self._theta, out=self.sines)
        return self.both


class Orbital:
    """Elevation, velocity and acceleration of the water at a point, with Wheeler stretching."""

    def __init__(self, waves: Waves) -> None:
        self._phases = Phases(waves)
        self._depth = waves.depth
        self._k = waves.k
        self._a = waves.amplitude
        aw = waves.amplitude * waves.omega
        aww = aw * waves.omega
        north, east = np.cos(waves.direction), np.sin(waves.direction)
        none = np.zeros_like(aw)
        # Velocity north, east, down, then acceleration: of the cosine and of the sine.
        cosine = np.stack([aw * north, aw * east, none, none, none, aww])
        sine = np.stack([none, none, aw, -aww * north, -aww * east, none])
        self._rows = np.concatenate([cosine, sine], 1)
        self._flat = np.empty((2, len(aw)))
        self._shallow = not math.isinf(waves.depth)
        if self._shallow:
            self._back = np.exp(-2.0 * waves.k * waves.depth)
            self._below = -np.expm1(-2.0 * waves.k * waves.depth)

    def at(self, t: float, x: float, y: float, z: float) -> tuple[float, Any]:
        """Return the elevation, m, and velocity, m/s, and acceleration, m/s2, in {n} (6,).

        At ``t``, s, and ``x`` north, ``y`` east, ``z`` below the mean surface, m. Above the water
        the values are those of the surface below.
        """
        both = self._phases.move(t, x, y)
        cosines = self._phases.cosines
        elevation = float(self._a.dot(cosines))
        # Wheeler: the surface is where the theory has z = 0; short waves would explode above it.
        z = max(z + elevation, 0.0)
        if self._shallow:
            return elevation, self._in_depth(z * self._depth / (self._depth + elevation))
        np.multiply(both.reshape(2, -1), np.exp(self._k * -z), out=self._flat)
        return elevation, self._rows.dot(self._flat.reshape(-1))

    def _in_depth(self, z: float) -> Any:
        """Return velocity and acceleration where horizontal motion has cosh, vertical sinh."""
        decay = np.exp(-np.minimum(self._k * z, _DEEPEST))
        rise = self._back / decay
        both = self._phases.both.reshape(2, -1)
        level = self._rows.dot((both * ((decay + rise) / self._below)).reshape(-1))
        upright = self._rows.dot((both * ((decay - rise) / self._below)).reshape(-1))
        level[2], level[5] = upright[2], upright[5]
        return level
