"""Currents: profiles over depth, tide, and a slow variation; vectors north and east."""

from __future__ import annotations

import bisect
import math
import zlib
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...errors import InputError
from .numbers import Array, fixed, require_positive

TIDES = {"M2": 44714.164, "S2": 43200.0, "K1": 86164.09, "O1": 92949.63}
"""Periods of constituents, s."""


def towards(speed: float, direction: float) -> Array:
    """Return the vector of ``speed``, m/s, going to ``direction``, rad from north."""
    return np.array([speed * math.cos(direction), speed * math.sin(direction)])


def power_profile(surface: Array, z: float, depth: float, exponent: float = 1.0 / 7.0) -> Array:
    """Return V0 ((h - z)/h)^(1/7): of a stream that friction at the bed slows; 0 below the bed."""
    return np.asarray(surface * max(0.0, (depth - z) / depth) ** exponent)


def wind_driven(surface: Array, z: float, reach: float = 50.0) -> Array:
    """Return Vw (1 - z/h0) to h0 = ``reach``, m; Vw is 0.015 to 0.03 of the wind at 10 m."""
    return np.asarray(surface * min(1.0, max(0.0, 1.0 - z / reach)))


@dataclass(frozen=True, eq=False)
class Layers:
    """A profile by depths: linear between them as vectors, with shear and turning.

    Above the first and below the last depth their values hold. Raises InputError if depths do
    not rise or velocities are not one vector each.
    """

    depths: Array
    """m, rising."""
    velocities: Array
    """(depths, 2), m/s north and east."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "depths", fixed(self.depths))
        object.__setattr__(self, "velocities", fixed(self.velocities))
        if (np.diff(self.depths) <= 0.0).any() or self.velocities.shape != (len(self.depths), 2):
            raise InputError("depths of a current must rise, with one velocity each")

    def at(self, z: float) -> Array:
        """Return the velocity at depth ``z``, m."""
        after = bisect.bisect_right(self.depths, z)
        if after in (0, len(self.depths)):
            return np.asarray(self.velocities[max(0, after - 1)])
        above, below = self.depths[after - 1 : after + 1].tolist()
        before = self.velocities[after - 1]
        share = (z - above) / (below - above)
        return np.asarray(before + share * (self.velocities[after] - before))


@dataclass(frozen=True)
class Tide:
    """An ellipse of tidal stream: major cos along its axis, minor sin across it.

    Raises InputError for a period that is not above 0.
    """

    period: float
    """s, as of `TIDES`."""
    major: float
    """m/s"""
    axis: float
    """Direction of the major axis, rad from north."""
    minor: float = 0.0
    """m/s, to starboard of the axis; its sign is the sense of rotation."""
    phase: float = 0.0
    """rad at t = 0."""

    def __post_init__(self) -> None:
        require_positive(period=self.period)

    def at(self, t: float) -> Array:
        """Return the velocity at ``t``, m/s north and east."""
        angle = math.tau * t / self.period + self.phase
        across = towards(self.minor * math.sin(angle), self.axis + 0.5 * math.pi)
        return towards(self.major * math.cos(angle), self.axis) + across


@dataclass
class GaussMarkov:
    """A slow variation x of standard deviation sigma: x' = -x/T + noise, sampled exactly.

    x_k+1 = c x_k + sigma sqrt(1 - c^2) n_k, c = exp(-P/T), stationary from the start, linear
    between the samples. n_k is keyed by seed, kind and k, so that it depends on no step.
    Raises InputError for a time or period that is not above 0.
    """

    sigma: float
    time: float
    """T, s."""
    seed: int
    kind: str
    """Kind of variation: two kinds of one seed are independent."""
    period: float = 1.0
    """P between samples, s."""

    def __post_init__(self) -> None:
        require_positive(time=self.time, period=self.period)
        self._samples = [self.sigma * self._drawn(0)]

    def at(self, t: float) -> float:
        """Return x at ``t`` >= 0, s."""
        k = math.floor(t / self.period)
        share = t / self.period - k
        before, after = self.samples(k, 2)
        return (1.0 - share) * before + share * after

    def samples(self, first: int, count: int) -> list[float]:
        """Return ``count`` samples from number ``first`` on, which is that of t = first P."""
        keep = math.exp(-self.period / self.time)
        while len(self._samples) < first + count:
            fresh = self.sigma * math.sqrt(1.0 - keep**2) * self._drawn(len(self._samples))
            self._samples.append(keep * self._samples[-1] + fresh)
        return self._samples[first : first + count]

    def _drawn(self, k: int) -> float:
        key = [self.seed, zlib.crc32(self.kind.encode())]
        return float(np.random.Generator(np.random.Philox(key=key, counter=[0, 0, 0, k])).normal())


def reflected(value: float, low: float, high: float) -> float:
    """Return ``value`` brought between ``low`` and ``high`` by reflection at them."""
    span = high - low
    return low + span - abs((value - low) % (2.0 * span) - span)


def rate_in_body(rotation: Array, omega: npt.ArrayLike, current: Array, rate: Array) -> Array:
    """Return d/dt of R^T V, m/s2 in {b}: R^T dV/dt - omega x R^T V.

    ``rotation`` R of {b} to {n}; V and dV/dt (with the craft's own change of depth) in {n};
    ``omega``, rad/s in {b}. Without the second part a turning craft feels a force that is not.
    """
    return np.asarray(rotation.T @ rate - np.cross(np.asarray(omega), rotation.T @ current))
