"""The current of a trial as plain numbers and words: what every component makes the same one of."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import InputError
from .current import TIDES, GaussMarkov, Layers, Tide, power_profile, towards, wind_driven
from .numbers import Array

PROFILES = ("uniform", "power", "linear", "layers")
LAYERS = 8
"""Greatest number of layers."""
SLOPE = 1e-3
"""m and s: of the differences that slopes over depth and time are taken from."""


@dataclass(frozen=True, eq=False)
class CurrentState:
    """A current by its parameters; those of two craft are equal, and so the currents are.

    Its stream is ``speed`` towards ``direction``, with a slow variation of both, times the
    profile; a tidal stream, the same at all depths, is added. Raises InputError for what is
    missing or contradicts itself.
    """

    speed: float = 0.0
    """m/s at the surface."""
    direction: float = 0.0
    """Direction to which the current goes, rad from north."""
    profile: str = "uniform"
    """One of `PROFILES`: power V (1 - z/reach)^(1/7), linear V (1 - z/reach)."""
    reach: float = 0.0
    """Depth at which the profile ends, m."""
    layers: int = 0
    layer_depths: tuple[float, ...] = ()
    layer_speeds: tuple[float, ...] = ()
    layer_directions: tuple[float, ...] = ()
    tide: float = 0.0
    """Greatest speed of the tidal stream, m/s."""
    tide_axis: float = 0.0
    """Direction to which the greatest current goes, rad from north."""
    tide_minor: float = 0.0
    tide_period: float = TIDES["M2"]
    tide_phase: float = 0.0
    variation: float = 0.0
    """Standard deviation of the speed, m/s."""
    turning: float = 0.0
    """Standard deviation of the direction, rad."""
    variation_time: float = 600.0
    seed: int = 1

    def __post_init__(self) -> None:
        if self.profile not in PROFILES:
            raise InputError(f"profile is {self.profile!r}, allowed {', '.join(PROFILES)}")
        if self.profile in ("power", "linear") and not self.reach > 0.0:
            raise InputError(f"reach is {self.reach!r} m, more than 0 is needed: where it ends")
        if self.profile == "layers":
            if not 2 <= self.layers <= LAYERS:
                raise InputError(f"layers: {self.layers} are given, 2 to {LAYERS} are needed")
            _ = self.layered_stream

    @property
    def is_absent(self) -> bool:
        """Say that there is no current."""
        layered = self.profile == "layers"
        return not (layered or self.speed or self.tide or self.tide_minor or self.variation)

    @property
    def is_steady(self) -> bool:
        """Say that it does not change with time."""
        return not (self.tide or self.tide_minor or self.variation or self.turning)

    def velocity(self, t: float, z: float) -> Array:
        """Return the velocity, m/s north and east, at ``t``, s, and depth ``z``, m."""
        stream = self._stream(t, z)
        if self.tidal_stream is None:
            return stream
        return np.asarray(stream + self.tidal_stream.at(t))

    def at(self, t: float, z: float) -> tuple[Array, Array, Array]:
        """Return velocity, its rate at that place, m/s2, and its slope over depth, 1/s.

        Rate and slope by differences over 1 ms and 1 mm, on both sides of the place.
        """
        velocity, none = self.velocity(t, z), np.zeros(2)
        rate = none
        if not self.is_steady:
            before = max(0.0, t - SLOPE)
            span = t + SLOPE - before
            rate = (self.velocity(t + SLOPE, z) - self.velocity(before, z)) / span
        slope = none
        if self.profile != "uniform":
            below, above = self.velocity(t, z + SLOPE), self.velocity(t, z - SLOPE)
            slope = (below - above) / (2.0 * SLOPE)
        return velocity, rate, slope

    def _stream(self, t: float, z: float) -> Array:
        speed, direction = self.speed, self.direction
        if self.slow_variation is not None:
            t, (fast, turned) = max(t, 0.0), self.slow_variation
            # A stream that stops runs on: below 0 the speed is reflected.
            speed = abs(speed + fast.at(t))
            direction += turned.at(t)
        if self.profile == "layers":
            stream = self.layered_stream.at(z)
            if self.slow_variation is None:
                return stream
            north, east = stream.tolist()
            turned_by, grown = direction - self.direction, speed - self.speed
            cos, sin = math.cos(turned_by), math.sin(turned_by)
            turned_stream = np.array([cos * north - sin * east, sin * north + cos * east])
            size = math.sqrt(north * north + east * east)
            return turned_stream * (1.0 + grown / size) if size else turned_stream
        surface = towards(speed, direction)
        if self.profile == "power":
            # No faster above the mean surface, where a wave carries a craft.
            return power_profile(surface, max(z, 0.0), self.reach)
        return wind_driven(surface, z, self.reach) if self.profile == "linear" else surface

    @cached_property
    def layered_stream(self) -> Layers:
        """The stream by depth, of the profile "layers" alone."""
        n = self.layers
        velocities = [
            towards(speed, direction)
            for speed, direction in zip(
                self.layer_speeds[:n], self.layer_directions[:n], strict=True
            )
        ]
        return Layers(np.array(self.layer_depths[:n]), np.array(velocities))

    @cached_property
    def tidal_stream(self) -> Tide | None:
        """The tide's part of it, None without one."""
        if not (self.tide or self.tide_minor):
            return None
        return Tide(self.tide_period, self.tide, self.tide_axis, self.tide_minor, self.tide_phase)

    @cached_property
    def slow_variation(self) -> tuple[GaussMarkov, GaussMarkov] | None:
        """What comes on top of speed and direction, None if nothing does."""
        if not (self.variation or self.turning):
            return None
        seed, time = int(self.seed), self.variation_time
        return (
            GaussMarkov(self.variation, time, seed, "current speed"),
            GaussMarkov(self.turning, time, seed, "current direction"),
        )
