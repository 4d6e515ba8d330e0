"""Anemometer with a wind vane."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..physics.craft.kinematics import cross, to_body
from .sensor import ALWAYS_THERE, Measured, Sensor, half_circle

_DEG = math.radians(1.0)


class Anemometer(Sensor):
    """Cups and vane on a boat: speed of the apparent wind, and where it blows to from the bow.

        (a, b, .) = R^T (north, east, 0) - velocity - rates x place          m/s
        speed     = sqrt(a^2 + b^2)                                          m/s
        angle     = atan2(b, a), to starboard positive, in (-pi, pi]         rad

    with the errors of `Sensor` on top; R is the rotation body to {n} and ``place`` the lever
    arm from the body origin in body axes (x bow, y starboard, z down), m. Vane and cups heel
    with the boat: they see the flow in the plane across the mast. An angle of 180 deg is wind
    from ahead.

    Defaults, all assumed: a small cup and vane unit, its vane accurate to 2 degrees (here 1 of
    noise and 1 of slow error) with a resolution of 1 degree, its cups to 0.1 m/s; 10 Hz.

    Not modelled: inertia of cups and vane, least speed at which they turn, upwash of the sail.
    """

    exercised: ClassVar = {"dropout": 0.2, "place": [0.2, 0.1, -0.9]}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    place = Parameter(0.0, "m", "sensor from the body origin, body axes", axes="xyz")

    wind = Input(
        "m/s", "velocity of the air over ground: where it blows to, {n}", axes=("north", "east")
    )
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    velocity = Input("m/s", "velocity of the body origin, body axes", axes=("u", "v", "w"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))

    speed = Measured(
        "m/s", "speed of the apparent wind", span=(0.0, 50.0), noise=0.1, resolution=0.1
    )
    angle = Measured(
        "rad",
        "direction that the apparent wind blows to from the bow, to starboard positive",
        span=(-math.pi, math.pi),
        noise=_DEG,
        instability=_DEG,
        resolution=_DEG,
    )

    _ACTING = ("wind", "attitude", "velocity", "rates")
    terminals: ClassVar = {
        "motion": terminal("attitude", "velocity", "rates"),
        "reading": terminal(wind_speed="speed", wind_angle="angle", wind_valid="valid"),
    }
    feedthrough: ClassVar = ALWAYS_THERE

    def measure(self) -> list[float]:
        """Return speed and direction of the flow across the mast."""
        air = to_body(self.attitude, (*self.wind, 0.0))
        swing = cross(self.rates, self.place)
        a, b = (w - v - s for w, v, s in zip(air[:2], self.velocity, swing, strict=False))
        return [math.hypot(a, b), math.atan2(b, a)]

    def finish(self, values: list[float]) -> list[float]:
        """Return a speed that is not negative and an angle in (-pi, pi]."""
        speed, angle = values
        return [max(0.0, speed), half_circle(angle)]
