"""Waves, current and wind around a plant in C, evaluated by its equal in Python."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np

from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.instance import Instance
from seatrial.physics.craft.surrounded import SurroundedPlant, Surroundings

MET = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p)
"""`Surroundings` of ``component.h``."""


Met = Callable[[float, int, int], int]
NOTHING: Met = MET()
"""Around a plant: C's null."""


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
    return None if met is None else _called(met, sum(port.size for port in plant.state_ports))


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


def _called(met: Surroundings, states: int) -> Met:
    alone = threading.Lock()  # copies share it, and NumPy lets other threads run amid a product

    def call(t: float, state: int, to: int) -> int:
        x = np.ctypeslib.as_array((ctypes.c_double * states).from_address(state))
        with alone:
            found = met(t, x)
        ctypes.memmove(to, found.ctypes.data, found.nbytes)
        return 1  # an exception, which ctypes shows, is 0

    return cast("Met", MET(call))


def surround(instance: Instance, met: Met) -> None:
    """Let an FMU in C, built to be surrounded, meet what `surroundings_of` returned."""
    slave: Any = instance
    slave.around = met  # as long as the instance
    take = slave._slave.dll.seatrial_surround
    take.argtypes, take.restype = [ctypes.c_void_p, MET], None
    take(slave.component, met)
