"""Inclinometer."""

from __future__ import annotations

from typing import ClassVar

from seatrial.devices.sensor import ALWAYS_THERE, Measured, Sensor
from seatrial.model.component import Input, Parameter, terminal


class Inclinometer(Sensor):
    """Heel and trim of a craft, rad, with the errors of `Sensor`; 10 Hz.

    Not modelled: an instrument that takes accelerations for gravity.
    """

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    tilt = Measured(
        "rad",
        "heel and trim",
        axes=("heel", "trim"),
        span=(-1.0, 1.0),
        noise=0.002,
        resolution=0.001,
    )

    terminals: ClassVar = {"motion": terminal("attitude")}
    feedthrough: ClassVar = ALWAYS_THERE

    def measure(self) -> list[float]:
        """Return heel and trim."""
        return [self.attitude[0], self.attitude[1]]
