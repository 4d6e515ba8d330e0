"""Sea, current and wind of a component: groups of parameters, the same in all that meet them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any, TypeVar

from ...errors import InputError
from ...model.component import Component, Parameter
from .current import TIDES
from .currents import LAYERS, CurrentState
from .currents import PROFILES as CURRENT_PROFILES
from .seastate import AMPLITUDES, NONE, SPECTRA, SPREADINGS, SWELLS, SeaState
from .winds import PROFILES as WIND_PROFILES
from .winds import SPECTRA as WIND_SPECTRA
from .winds import WindState

_SEED_MAX = 2.0**53
_State = TypeVar("_State", SeaState, CurrentState, WindState)
_AXES = [f"l{i}" for i in range(1, LAYERS + 1)]
_SWELL_AXES = [f"s{i}" for i in range(1, SWELLS + 1)]
_Declared = Callable[..., Any]
_sea: _Declared = partial(Parameter, role="sea")
_current: _Declared = partial(Parameter, role="current")
_wind: _Declared = partial(Parameter, role="wind")


class MeetsWaves(Component):
    """Mix-in: the waves of a trial, by parameters.

    Everything that meets them takes the same parameters and makes the same waves of them, so
    that there is one sea and no connection.
    """

    sea_spectrum = _sea(NONE, "1", "spectrum of the waves; none: calm", choices=SPECTRA)
    sea_height = _sea(0.0, "m", "significant wave height; of a regular wave its height", min=0.0)
    sea_period = _sea(0.0, "s", "period of the spectrum's peak, or of a regular wave", min=0.0)
    sea_direction = _sea(0.0, "rad", "where the waves go to, clockwise from north")
    sea_gamma = _sea(3.3, "1", "peak enhancement (jonswap, tma)", min=1.0)
    sea_spreading = _sea(0.0, "1", "exponent s or n of the spreading; 0: one direction", min=0.0)
    sea_spreading_form = _sea(
        "cos-2s", "1", "cos^2s of half the angle, or cos^n of the angle", choices=SPREADINGS
    )
    sea_seed = _sea(1.0, "1", "seed of the waves (a whole number)", min=0.0, max=_SEED_MAX)
    sea_components_per_octave = _sea(
        0.0, "1", "waves per octave; 0: such that hours vary as at sea", min=0.0, max=200.0
    )
    sea_highest = _sea(
        0.0, "rad/s", "highest frequency; 0: 2 Hz, or 5 times the peak's if more", min=0.0
    )
    sea_depth = _sea(0.0, "m", "depth of the water under the waves; 0: deep", min=0.0)
    sea_amplitudes = _sea(
        "fixed", "1", "of the spectrum, or Rayleigh-distributed about it", choices=AMPLITUDES
    )
    sea_swell_height = _sea(
        0.0, "m", "significant wave height of swells beside the sea", axes=_SWELL_AXES, min=0.0
    )
    sea_swell_period = _sea(0.0, "s", "their peak periods", axes=_SWELL_AXES, min=0.0)
    sea_swell_direction = _sea(0.0, "rad", "where they go to", axes=_SWELL_AXES)
    sea_swell_gamma = _sea(7.0, "1", "their peak enhancement", axes=_SWELL_AXES, min=1.0)
    sea_swell_spreading = _sea(
        0.0, "1", "their exponents s of cos-2s; 0: one direction", axes=_SWELL_AXES, min=0.0
    )

    def sea_state(self) -> SeaState:
        """Return the sea that the parameters say. Raises InputError for a sea that cannot be."""
        state = _state(self, SeaState, "sea")
        _explained(self, "sea", state.waves)
        return state


class MeetsCurrent(Component):
    """Mix-in: the current of a trial, by parameters, the same in all that meet it."""

    current_speed = _current(0.0, "m/s", "speed of the stream at the surface", min=0.0)
    current_direction = _current(0.0, "rad", "where the stream goes to, clockwise from north")
    current_profile = _current("uniform", "1", "profile over depth", choices=CURRENT_PROFILES)
    current_reach = _current(0.0, "m", "depth at which power and linear profiles end", min=0.0)
    current_layers = _current(0.0, "1", "number of layers in use", min=0.0, max=float(LAYERS))
    current_layer_depths = _current(0.0, "m", "depths of the layers, rising", axes=_AXES, min=0.0)
    current_layer_speeds = _current(0.0, "m/s", "speeds at these depths", axes=_AXES, min=0.0)
    current_layer_directions = _current(0.0, "rad", "where they go to there", axes=_AXES)
    current_tide = _current(0.0, "m/s", "greatest speed of the tidal stream", min=0.0)
    current_tide_axis = _current(0.0, "rad", "where the tidal stream goes to at its greatest")
    current_tide_minor = _current(
        0.0, "m/s", "tidal stream across that axis, to starboard; its sign is the sense of turning"
    )
    current_tide_period = _current(TIDES["M2"], "s", "period of the tide", min=1e-3)
    current_tide_phase = _current(0.0, "rad", "phase of the tide at t = 0")
    current_variation = _current(0.0, "m/s", "standard deviation of the speed", min=0.0)
    current_turning = _current(0.0, "rad", "standard deviation of the direction", min=0.0)
    current_variation_time = _current(600.0, "s", "correlation time of both", min=1e-3)
    current_seed = _current(1.0, "1", "seed of both (a whole number)", min=0.0, max=_SEED_MAX)

    def current_state(self) -> CurrentState:
        """Return the current of the parameters. Raises InputError for one that cannot be."""
        return _state(self, CurrentState, "current")


class MeetsWind(Component):
    """Mix-in: the wind of a trial, by parameters, the same in all that meet it."""

    wind_speed = _wind(0.0, "m/s", "mean speed of the wind at 10 m", min=0.0)
    wind_direction = _wind(0.0, "rad", "where the wind blows to, clockwise from north")
    wind_profile = _wind("uniform", "1", "mean speed by height", choices=tuple(WIND_PROFILES))
    wind_spectrum = _wind(
        NONE, "1", "spectrum of gusts; none: steady", choices=(NONE, *WIND_SPECTRA)
    )
    wind_gust = _wind(0.0, "m/s", "peak of a single gust over the mean")
    wind_gust_start = _wind(60.0, "s", "time at which the single gust begins")
    wind_gust_duration = _wind(10.0, "s", "duration of the single gust", min=1e-6)
    wind_seed = _wind(1.0, "1", "seed of the gusts (a whole number)", min=0.0, max=_SEED_MAX)

    def wind_state(self) -> WindState:
        """Return the wind of the parameters. Raises InputError for one that cannot be."""
        return _state(self, WindState, "wind")


def _state(component: Component, kind: type[_State], group: str) -> _State:
    values: dict[str, Any] = {}
    for field in fields(kind):
        value = getattr(component, f"{group}_{field.name}")
        if field.name in ("seed", "layers", "components_per_octave"):
            if value % 1.0:
                raise InputError(
                    f"{component.name}.{group}_{field.name} is {value!r}, a whole number is needed"
                )
            value = int(value)
        values[field.name] = tuple(value) if isinstance(value, list) else value
    return _explained(component, group, lambda: kind(**values))


_T = TypeVar("_T")


def _explained(component: Component, group: str, make: Callable[[], _T]) -> _T:
    try:
        return make()
    except InputError as error:
        raise InputError(f"{component.name}: {group}: {error}") from None
