"""Leak sensor of a watertight enclosure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from .sensor import ALWAYS_THERE, Derived, Measured, Sensor, Value


class Leak(Sensor):
    """Probe on the bottom of an enclosure: whether it stands in water.

        wetness = 1 where volume >= probe_volume, else 0
        leaking = wetness > 0.5

    with the errors of `Sensor` on the wetness. ``volume`` is the water in the enclosure, m3: a
    trial's event lets it in, or a component of one's own.

    Defaults, assumed: 5 ml until the probe is wet, 2 Hz. Its data is a single bit.

    Not modelled: water that runs to and fro as the vehicle tilts.
    """

    exercised: ClassVar = {"probe_volume": 0.5}

    period = Parameter(0.5, "s", "sample period", min=1e-6)
    probe_volume = Parameter(5e-6, "m3", "water with which the probe is wet", min=0.0)

    volume = Input("m3", "water in the enclosure", optional=True)

    wetness = Measured("1", "1 where the probe is wet, else 0", span=(0.0, 1.0))
    leaking = Derived("1", "1 where there is water, else 0")

    terminals: ClassVar = {"reading": terminal("leaking", leaking_valid="valid")}
    feedthrough: ClassVar = ALWAYS_THERE

    def measure(self) -> list[float]:
        """Return whether the probe is wet."""
        return [1.0 if self.volume >= self.probe_volume else 0.0]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return whether there is water."""
        return [1.0 if (values[0] or 0.0) > 0.5 else 0.0]
