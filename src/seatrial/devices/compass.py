"""Magnetic compass."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from .sensor import ALWAYS_THERE, Measured, Sensor, full_circle

_DEG = math.radians(1.0)


class Compass(Sensor):
    """Tilt-compensated magnetic compass: heading in [0, 2 pi), as on a compass card.

        magnetic = psi - variation
        heading  = magnetic - deviation(magnetic),
        deviation(m) = B sin m + C cos m + D sin 2m + E cos 2m

    with the errors of `Sensor` on top; rad, clockwise from north. Variation and deviation are
    positive east, so that true heading = heading + deviation + variation, the mariner's rule;
    B and C stand for hard iron, D and E for soft iron, and coefficient A is the bias.
    ``variation`` is what the instrument does not correct: 0 for a unit that knows where it is.

    Defaults: a strapped-down MEMS compass, data sheets of the Honeywell HMC5883L and CMPS14
    kind: accuracy 1 to 2 degrees (here 1 degree of B and 0.5 of slow error), noise 0.3 degrees
    rms, resolution 0.1 degree, 20 Hz.
    """

    exercised: ClassVar = {"delay": 0.03, "dropout": 0.2}

    period = Parameter(0.05, "s", "sample period", min=1e-6)
    variation = Parameter(0.0, "rad", "magnetic variation left in the heading, positive east")
    deviation = Parameter(
        (_DEG, 0.0, 0.0, 0.0), "rad", "coefficients of deviation, positive east", axes="BCDE"
    )

    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    heading = Measured(
        "rad",
        "heading, clockwise from north, 0 to 2 pi",
        span=(0.0, math.tau),
        noise=0.3 * _DEG,
        instability=0.5 * _DEG,
        resolution=0.1 * _DEG,
    )

    terminals: ClassVar = {
        "motion": terminal("attitude"),
        "reading": terminal("heading", heading_valid="valid"),
    }
    feedthrough: ClassVar = ALWAYS_THERE

    def measure(self) -> list[float]:
        """Return the heading as the deviated needle shows it."""
        magnetic = self.attitude[2] - self.variation
        b, c, d, e = self.deviation
        once = b * math.sin(magnetic) + c * math.cos(magnetic)
        return [magnetic - once - d * math.sin(2.0 * magnetic) - e * math.cos(2.0 * magnetic)]

    def finish(self, values: list[float]) -> list[float]:
        """Return the heading in [0, 2 pi)."""
        return [full_circle(values[0])]
