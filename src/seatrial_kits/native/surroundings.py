"""Waves, current and wind around a plant in C, evaluated by its equal in Python."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from seatrial.fmi.components.source import ComponentSource
from seatrial.fmi.instance import Instance
from seatrial.physics.craft.surrounded import SurroundedPlant, Surroundings

_MET = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p)
"""`Surroundings` of ``component.h``."""


def surroundings_of(
    source: ComponentSource, values: Mapping[str, Any]
) -> tuple[Surroundings, int] | None:
    """Return the surroundings of a plant with ``values``, by port or scalar, and its states' number.

    None for another component, and with nothing around it. Raises InputError for a sea, a current
    or a wind that cannot be.
    """
    cls = source.component_class()
    if not issubclass(cls, SurroundedPlant):
        return None
    plant = cls(source.name)
    for name, value in values.items():
        plant.set(name, value)
    plant.setup(0.0)
    met = plant.met()
    return None if met is None else (met, sum(port.size for port in cls.state_ports))


def surround(instance: Instance, around: tuple[Surroundings, int]) -> None:
    """Let an FMU in C, built among surroundings, call `surroundings_of` where it is open."""
    met, states = around

    def called(t: float, state: int, to: int) -> int:
        x = np.frombuffer((ctypes.c_double * states).from_address(state))
        found = met(t, x)
        ctypes.memmove(to, found.ctypes.data, found.nbytes)
        return 1  # an exception, which ctypes shows, is 0

    slave: Any = instance
    slave.around = _MET(called)  # as long as the instance
    take = slave._slave.dll.seatrial_surround
    take.argtypes, take.restype = [ctypes.c_void_p, _MET], None
    take(slave.component, slave.around)
