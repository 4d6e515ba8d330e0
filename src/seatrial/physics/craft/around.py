"""Waves, current and wind around a craft at a time, stacked as its equations take them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...model.expressions import Vector
from ..sea.currents import CurrentState
from ..sea.loads import WaveLoads
from ..sea.numbers import Array
from ..sea.orbital import Orbital
from ..sea.winds import WindState
from .kinematics import rotation
from .windage import WindLoad

ELEVATION, VELOCITY, ACCELERATION = 0, slice(1, 4), slice(4, 7)
SHEAR = slice(7, 9)
WAVE, WIND = slice(9, 15), slice(15, 21)
SIZE = 21
"""Without the parts of a craft, which come behind."""


class Places(NamedTuple):
    """Where a craft's stacked state has what its surroundings depend on."""

    x: int
    y: int
    z: int | None
    """None of a craft that keeps to the surface."""
    psi: int
    u: int
    v: int


@dataclass(frozen=True)
class WavesAtParts:
    """The velocity that waves give the water at parts of a craft, beyond that at its origin.

    A part at r, in {b}, meets the velocity of the waves at x + R r, with stretching, where it is
    below the surface, and that of the surface above it; a submerged craft's own ``water_velocity``
    has that at its origin already, which is taken off, a surface craft's has none.
    """

    orbital: Orbital | None
    """None without waves."""
    rows: tuple[int, ...]
    """Which of the parts that there can be these are."""
    positions: Array
    """Their places, body axes (n, 3), m."""
    size: int
    """Number of parts that there can be."""

    def at(self, t: float, state: Vector, places: Places, own: Array) -> Array:
        """Return the velocities (size, 3), m/s in {n}, 0 where there is no part."""
        found = np.zeros((self.size, 3))
        if self.orbital is None:
            return found
        x, psi = places.x, places.psi
        origin = state[x : x + 3].tolist()
        R = rotation(*state[psi - 2 : psi + 1].tolist())
        for row, (a, b, c) in zip(self.rows, self.positions.tolist(), strict=True):
            point = [o + (r[0] * a + r[1] * b + r[2] * c) for o, r in zip(origin, R, strict=True)]
            found[row] = self.orbital.at(t, *point)[1][:3] - own
        return found


@dataclass(frozen=True)
class Around:
    """Surroundings of a craft by the time and its stacked state; see `seaway.PORTS`.

    Native code has the same, operation by operation, of the same tables.
    """

    places: Places
    loads: WaveLoads | None = None
    orbital: Orbital | None = None
    current: CurrentState | None = None
    wind: tuple[WindState, WindLoad, float] | None = None
    """Wind, its load, and the height of it, m."""
    parts: WavesAtParts | None = None

    @property
    def size(self) -> int:
        """How many values there are."""
        return SIZE + (0 if self.parts is None else 3 * self.parts.size)

    def at(self, t: float, state: Vector) -> Vector:
        """Return all, stacked."""
        around = np.zeros(self.size)
        x, y, z, psi, u, v = self.places
        at = state.tolist()
        north, east, heading = at[x], at[y], at[psi]
        depth = 0.0 if z is None else at[z]
        if self.loads is not None:
            around[WAVE] = self.loads.at(t, north, east, heading)
        if self.orbital is not None:
            around[ELEVATION], around[1:7] = self.orbital.at(t, north, east, depth)
        if self.parts is not None:
            around[SIZE:] = self.parts.at(t, state, self.places, around[VELOCITY]).ravel()
        if self.current is not None:
            velocity, rate, slope = self.current.at(t, depth)
            around[1:3] += velocity
            around[4:6] += rate
            around[SHEAR] = slope
        if self.wind is not None:
            around[WIND] = self._load_of_wind(t, heading, at[u], at[v])
        return around

    def _load_of_wind(self, t: float, heading: float, u: float, v: float) -> Vector:
        assert self.wind is not None
        wind, windage, height = self.wind
        north, east = wind.velocity(t, height).tolist()
        cos, sin = math.cos(heading), math.sin(heading)
        ahead, aside = u - (cos * north + sin * east), v - (cos * east - sin * north)
        X, Y, K, N = windage.loads(ahead, aside).tolist()
        return np.array([X, Y, 0.0, K, 0.0, N])
