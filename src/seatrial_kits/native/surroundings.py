"""Waves, current and wind around a plant in C."""

from __future__ import annotations

import ctypes
import threading
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.instance import Instance
from seatrial.model.ports import Port
from seatrial.physics.craft.around import Around
from seatrial.physics.craft.surrounded import SurroundedPlant, Surroundings

from .weather import WeatherInC, weather_at

MET = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p
)


@dataclass(frozen=True, eq=False)
class Met:
    """What surrounds a plant, as C calls it: `Surroundings` of ``component.h``, and of what."""

    function: int | None = None
    of: int | None = None
    kept: Any = None
    """What C needs as long as it calls."""


NOTHING = Met()
"""Around a plant."""


def is_surrounded(source: ComponentSource) -> bool:
    """Return whether a component is a plant that can meet waves, current and wind."""
    return issubclass(source.component_class(), SurroundedPlant)


def surroundings_of(source: ComponentSource, values: Mapping[str, Any]) -> Met | None:
    """Return what surrounds a plant with ``values``, by port or scalar, as C calls it.

    None for another component, and with nothing around it. Raises InputError for a sea, a current
    or a wind that cannot be.
    """
    if not is_surrounded(source):
        return None
    plant = plant_of(source)
    met = met_with(plant, values)
    if met is None:
        return None
    around = getattr(met, "__self__", None)
    if type(around) is Around and around.size == _size(plant.surrounding_ports):
        weather = WeatherInC(around)
        return Met(weather_at(), weather.address, weather)
    called = _called(met, _size(plant.state_ports))
    return Met(ctypes.cast(called, ctypes.c_void_p).value, None, called)


def plant_of(source: ComponentSource) -> SurroundedPlant:
    """Return a plant of a class that `is_surrounded`, as it is without values."""
    plant = source.component_class()(source.name)
    assert isinstance(plant, SurroundedPlant)
    return plant


def met_with(plant: SurroundedPlant, values: Mapping[str, Any]) -> Surroundings | None:
    """Return what surrounds a plant once ``values`` are set, None: nothing. Raises InputError."""
    for name, value in values.items():
        plant.set(name, value)
    plant.setup(0.0)
    return plant.met()


def _size(ports: Sequence[Port]) -> int:
    return sum(port.size for port in ports)


def _called(met: Surroundings, states: int) -> Any:
    """Return surroundings of somebody's own in Python, as a function of C."""
    alone = threading.Lock()  # copies share it, and NumPy lets other threads run amid a product

    def call(_: None, t: float, state: int, to: int) -> int:
        x = np.ctypeslib.as_array((ctypes.c_double * states).from_address(state))
        try:
            with alone:
                found = met(t, x)
        except BaseException:  # C knows none: ctypes would return what is not there
            traceback.print_exc()
            return 0
        ctypes.memmove(to, found.ctypes.data, found.nbytes)
        return 1

    return MET(call)


def surround(instance: Instance, met: Met) -> None:
    """Let an FMU in C, built to be surrounded, meet what `surroundings_of` returned."""
    slave: Any = instance
    slave.around = met  # as long as the instance
    take = slave._slave.dll.seatrial_surround
    take.argtypes, take.restype = [ctypes.c_void_p] * 3, None
    take(slave.component, met.function, met.of)
