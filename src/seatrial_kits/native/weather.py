"""Waves, current and wind around a craft in C: the tables of ``weather.h``, and its library."""

from __future__ import annotations

import ctypes
import hashlib
import math
import threading
import traceback
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from seatrial.fmi.cache import cache_folder, write_named
from seatrial.fmi.compiler import FLAGS, HERE, TARGETS, library_here
from seatrial.physics.craft.around import Around, WavesAtParts
from seatrial.physics.craft.windage import WindLoad
from seatrial.physics.sea.currents import PROFILES, CurrentState
from seatrial.physics.sea.loads import HEADINGS, WaveLoads
from seatrial.physics.sea.orbital import Orbital, Phases
from seatrial.physics.sea.wind_loads import BLENDERMANN, Areas, Isherwood
from seatrial.physics.sea.winds import WindState

_SOURCES = [Path(__file__).with_name(f"weather.{suffix}") for suffix in "ch"]
_WHOLE, _REAL, _TABLE = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
_MAKE = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)
_HEADING = 2
_AREAS, _ISHERWOOD, _BLENDERMANN = range(3)
_FIRST_BLOCK, _BLOCKS = 64, 48


class _Weather(ctypes.Structure):
    """``Weather`` of ``weather.h``, field by field."""

    _fields_: ClassVar = [
        *((name, _WHOLE) for name in ("x", "y", "z", "psi", "u", "v", "count")),
        *((name, _TABLE) for name in ("omega", "north", "east", "phase")),
        *((name, _WHOLE) for name in ("half", "headings")),
        ("loads", _TABLE),
        ("at_origin", _WHOLE),
        ("depth", _REAL),
        *((name, _TABLE) for name in ("amplitude", "k", "motions", "back", "below")),
        *((name, _WHOLE) for name in ("part_size", "part_count")),
        *((name, _TABLE) for name in ("part_rows", "part_positions")),
        *((name, _WHOLE) for name in ("has_current", "is_steady", "profile", "layers")),
        *((name, _REAL) for name in ("speed", "direction", "reach")),
        *((name, _TABLE) for name in ("layer_depths", "layer_velocities")),
        ("has_tide", _WHOLE),
        *((f"tide_{name}", _REAL) for name in ("period", "major", "axis", "minor", "phase")),
        ("sample_period", _REAL),
        ("samples", _TABLE * 2),
        *((name, _WHOLE) for name in ("has_wind", "gust_count")),
        *((f"wind_{name}", _REAL) for name in ("mean", "cos", "sin")),
        *((f"gust_{name}", _TABLE) for name in ("amplitude", "omega", "phase")),
        *((f"gust_{name}", _REAL) for name in ("peak", "start", "duration")),
        ("windage", _WHOLE),
        *((name, _TABLE) for name in ("windage_numbers", "windage_scales")),
        ("make", _MAKE),
    ]


class WeatherInC:
    """What surrounds a craft, for `weather_at` of the library; to be kept as long as C uses it."""

    def __init__(self, around: Around) -> None:
        self.around = around
        self._kept: dict[Any, npt.NDArray[Any]] = {}
        self._alone = threading.Lock()
        places = around.places
        z = -1 if places.z is None else places.z
        self._in_c = _Weather(places.x, places.y, z, places.psi, places.u, places.v)
        self._in_c.make = _MAKE(self._make)
        if around.loads is not None:
            self._take_loads(around.loads)
        if around.orbital is not None:
            self._take_motion(around.orbital)
            self._set(at_origin=1)
        if around.parts is not None:
            self._take_parts(around.parts)
        if around.current is not None:
            self._take_current(around.current)
        if around.wind is not None:
            self._take_wind(*around.wind)

    @property
    def address(self) -> int:
        """Where C has it."""
        return ctypes.addressof(self._in_c)

    # ------------------------------------------------------------------ tables

    def _keep(self, name: str, values: npt.ArrayLike, kind: type = np.float64) -> None:
        """Let a field be a table of ``values``."""
        self._kept[name] = np.ascontiguousarray(values, dtype=kind)
        setattr(self._in_c, name, self._kept[name].ctypes.data)

    def _set(self, **fields: float) -> None:
        for name, value in fields.items():
            setattr(self._in_c, name, value)

    def _make(self, kind: int, number: int) -> int | None:
        """Return where C finds a table that it needs, None if it cannot be made."""
        key = kind, number
        try:
            with self._alone:
                if key not in self._kept:
                    self._kept[key] = self._made(kind, number)
                return self._kept[key].ctypes.data
        except BaseException:  # C knows none: ctypes would return what is not there
            traceback.print_exc()
            return None

    def _made(self, kind: int, number: int) -> npt.NDArray[np.float64]:
        if kind == _HEADING:
            assert self.around.loads is not None
            return self.around.loads.table(number)
        assert self.around.current is not None
        slow = self.around.current.slow_variation
        assert slow is not None
        first = _FIRST_BLOCK * (2**number - 1)
        return np.array(slow[kind].samples(first, _FIRST_BLOCK * 2**number))

    def _take_phases(self, phases: Phases) -> None:
        self._set(count=phases.rates.shape[1])
        for name, rates in zip(("omega", "north", "east", "phase"), phases.rates, strict=True):
            self._keep(name, rates)

    def _take_loads(self, loads: WaveLoads) -> None:
        self._take_phases(loads.phases)
        self._set(half=10 if loads.drifts else 6, headings=HEADINGS)
        self._keep("loads", np.zeros(HEADINGS), np.uintp)

    def _take_motion(self, orbital: Orbital) -> None:
        self._take_phases(orbital.phases)
        self._set(depth=orbital.depth)
        for name in ("amplitude", "k", "motions", "back", "below"):
            self._keep(name, getattr(orbital, name))

    def _take_parts(self, parts: WavesAtParts) -> None:
        self._set(part_size=parts.size)
        if parts.orbital is not None:
            self._take_motion(parts.orbital)
            self._set(part_count=len(parts.rows))
            self._keep("part_rows", parts.rows, np.int64)
            self._keep("part_positions", parts.positions)

    def _take_current(self, current: CurrentState) -> None:
        self._set(has_current=1, is_steady=current.is_steady)
        self._set(profile=PROFILES.index(current.profile), reach=current.reach)
        self._set(speed=current.speed, direction=current.direction)
        if current.profile == "layers":
            self._set(layers=current.layers)
            self._keep("layer_depths", current.layered_stream.depths)
            self._keep("layer_velocities", current.layered_stream.velocities)
        if (tide := current.tidal_stream) is not None:
            self._set(has_tide=1, tide_period=tide.period, tide_phase=tide.phase)
            self._set(tide_major=tide.major, tide_axis=tide.axis, tide_minor=tide.minor)
        if current.slow_variation is not None:
            self._set(sample_period=current.slow_variation[0].period)
            blocks = self._kept["samples"] = np.zeros((2, _BLOCKS), np.uintp)
            self._in_c.samples[:] = [row.ctypes.data for row in blocks]

    def _take_wind(self, wind: WindState, windage: WindLoad, height: float) -> None:
        self._set(has_wind=1, wind_mean=wind.mean(height))
        self._set(wind_cos=math.cos(wind.direction), wind_sin=math.sin(wind.direction))
        self._set(gust_peak=wind.gust, gust_start=wind.gust_start)
        self._set(gust_duration=wind.gust_duration)
        if (gusts := wind.gusts) is not None:
            self._set(gust_count=len(gusts.omega))
            for name in ("amplitude", "omega", "phase"):
                self._keep(f"gust_{name}", getattr(gusts, name))
        kind, numbers, scales = _windage(windage)
        self._set(windage=kind)
        self._keep("windage_numbers", numbers)
        self._keep("windage_scales", scales)


def _windage(load: WindLoad) -> tuple[int, npt.ArrayLike, Sequence[float]]:
    """Return the kind of a wind load in ``weather.h``, its numbers and its scales."""
    if isinstance(load, Areas):
        areas = [load.frontal, load.lateral, load.ahead, load.height, load.along, load.across]
        return _AREAS, areas, []
    shape, form = load.shape, load.form
    if isinstance(form, Isherwood):
        return _ISHERWOOD, form.rows, shape.scales
    sizes = [shape.frontal, shape.lateral, shape.length, form.ahead, form.height]
    return _BLENDERMANN, [*BLENDERMANN[form.kind], *sizes], shape.scales


@cache
def weather_at() -> int:
    """Return where ``weather_at`` of the library is, compiled if the user's cache has it not.

    It is `Surroundings` of ``component.h``, of a `WeatherInC.address`. Raises InputError without a
    compiler.
    """
    sources = {path.name: path.read_bytes() for path in _SOURCES}
    digest = hashlib.sha256(repr((FLAGS, HERE, sources)).encode()).hexdigest()[:16]
    path = cache_folder("native") / f"weather-{digest}{TARGETS[HERE][1]}"
    if not path.is_file():
        write_named(path, library_here(sources, HERE))
    library = ctypes.CDLL(str(path))  # never unloaded
    library.weather_size.restype = ctypes.c_int64
    assert library.weather_size() == ctypes.sizeof(_Weather)
    return ctypes.cast(library.weather_at, ctypes.c_void_p).value or 0
