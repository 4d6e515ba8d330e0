"""Waves, current and wind of a trial around a craft, as its equations take them."""

from __future__ import annotations

from typing import ClassVar

from ...model.ports import Port
from ..sea.loads import Drift, Response, WaveLoads
from ..sea.orbital import Orbital
from ..sea.parameters import MeetsCurrent, MeetsWaves, MeetsWind
from ..sea.winds import WindState
from .around import Around, Places
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

    def around(self) -> Around | None:
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
        return Around(self.places, loads, orbital, stream, wind)

    def met(self) -> Surroundings | None:
        """Return `around` as a function, or None. Raises InputError."""
        around = self.around()
        return None if around is None else around.at


class WindySeaway(Windage, WaveHull, MeetsWind, Seaway):
    """Base of craft that meet the wind of a trial too, by their windage."""

    def wind_over_it(self) -> tuple[WindState, WindLoad, float] | None:
        """Return wind, its load, and the height of it, m; None without wind."""
        wind = self.wind_state()
        if wind.is_absent:
            return None
        return wind, self.wind_load(), self.windage_height
