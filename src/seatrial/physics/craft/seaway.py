"""Waves, current and wind of a trial around a craft, as its equations take them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from ...model.expressions import Vector
from ...model.ports import Port
from ..sea.currents import CurrentState
from ..sea.loads import Drift, Response, WaveLoads
from ..sea.orbital import Orbital
from ..sea.parameters import MeetsCurrent, MeetsWaves, MeetsWind
from ..sea.winds import WindState
from .surrounded import SurroundedPlant, Surroundings, surrounding
from .wave_hull import WaveHull
from .windage import Windage, WindLoad

_NED = ("north", "east", "down")
_LOAD = tuple("XYZKMN")

PORTS: tuple[Port, ...] = (
    surrounding("water_elevation", "m", "elevation of the surface, positive up", ("up",)),
    surrounding("water_velocity", "m/s", "velocity of the water, {n}", _NED),
    surrounding("water_acceleration", "m/s2", "acceleration of the water where it is, {n}", _NED),
    surrounding("water_shear", "1/s", "velocity of the water over depth, {n}", ("north", "east")),
    surrounding("wave_load", "N", "load of the waves, N and N.m, body axes", _LOAD),
    surrounding("wind_load", "N", "load of the wind, N and N.m, body axes", _LOAD),
)
"""What a craft's equations find among their inputs while there is sea, current or wind."""

_WATER, _SHEAR = slice(1, 4), slice(7, 9)
_WAVE, _WIND = slice(9, 15), slice(15, 21)
_SIZE = 21


class Places(NamedTuple):
    """Where a craft's stacked state has what its surroundings depend on."""

    x: int
    y: int
    z: int | None
    """None of a craft that keeps to the surface."""
    psi: int
    u: int
    v: int


class Seaway(MeetsWaves, MeetsCurrent, SurroundedPlant):
    """Base of craft that meet the waves and the current of a trial.

    Surface craft have wave loads by strips (`wave_response`), submerged ones the motion of the
    water at the body origin, with stretching. Every craft is carried by the current.
    """

    surrounding_ports: ClassVar = PORTS
    places: ClassVar[Places]

    def wave_response(self) -> Response | None:
        """Return the loads per metre of amplitude, of a surface craft; None of a submerged one.

        Asked for in waves only. Raises InputError for a hull that is not given.
        """
        raise TypeError(f"{type(self).__name__} does not say what waves do to it")

    def drift(self) -> Drift | None:
        """Return the mean drift forces of a surface craft, None if it has no table of them."""
        return None

    def wind_over_it(self) -> tuple[WindState, WindLoad, float] | None:
        """Return wind, its load, and the height of it, m; None without wind."""
        return None

    def met(self) -> Surroundings | None:
        """Return sea, current and wind around the craft, or None. Raises InputError."""
        waves, current = self.sea_state().waves(), self.current_state()
        wind = self.wind_over_it()
        if waves is None and current.is_absent and wind is None:
            return None
        loads = orbital = None
        if waves is not None:
            response = self.wave_response()
            if response is None:
                orbital = Orbital(waves)
            else:
                loads = WaveLoads(waves, response, self.drift())
        stream = None if current.is_absent else current
        return _Around(self.places, loads, orbital, stream, wind).at


@dataclass
class _Around:
    """Surroundings of a craft by the time and its stacked state; see `PORTS`."""

    places: Places
    loads: WaveLoads | None
    orbital: Orbital | None
    current: CurrentState | None
    wind: tuple[WindState, WindLoad, float] | None

    def at(self, t: float, state: Vector) -> Vector:
        """Return all of `PORTS`, stacked."""
        around = np.zeros(_SIZE)
        x, y, z, psi, u, v = self.places
        at = state.tolist()
        north, east, heading = at[x], at[y], at[psi]
        depth = 0.0 if z is None else at[z]
        if self.loads is not None:
            around[_WAVE] = self.loads.at(t, north, east, heading)
        if self.orbital is not None:
            around[0], around[1:7] = self.orbital.at(t, north, east, depth)
        if self.current is not None:
            velocity, rate, slope = self.current.at(t, depth)
            around[1:3] += velocity
            around[4:6] += rate
            around[_SHEAR] = slope
        if self.wind is not None:
            state_of_it, load, height = self.wind
            blows = state_of_it.velocity(t, height)
            cos, sin = math.cos(heading), math.sin(heading)
            ahead = at[u] - float(cos * blows[0] + sin * blows[1])
            aside = at[v] - float(cos * blows[1] - sin * blows[0])
            X, Y, K, N = load(ahead, aside).tolist()
            around[_WIND] = X, Y, 0.0, K, 0.0, N
        return around


class WindySeaway(Windage, WaveHull, MeetsWind, Seaway):
    """Base of craft that meet the wind of a trial too, by their windage."""

    def wind_over_it(self) -> tuple[WindState, WindLoad, float] | None:
        """Return wind, its load, and the height of it, m; None without wind."""
        wind = self.wind_state()
        if wind.is_absent:
            return None
        return wind, self.wind_load(), self.windage_height
