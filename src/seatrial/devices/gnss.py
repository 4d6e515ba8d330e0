"""Satellite positioning receiver."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..physics.craft.kinematics import cross, to_ned
from .sensor import Measured, Sensor, Value

_NED = ("north", "east", "down")


class Gnss(Sensor):
    """GNSS receiver: position and velocity of its antenna, north-east-down from the origin.

        position_n = position + R antenna                 m
        velocity_n = R (velocity + rates x antenna)       m/s

    with the errors of `Sensor` on each; ``antenna`` is the lever arm from the body origin in
    body axes (x bow, y starboard, z down), R the rotation body to NED. The receiver does not
    correct for the lever arm. Position on a flat earth: latitude and
    longitude are for links to convert. An antenna below the surface receives nothing:
    measurements are lost. With ``reception`` = "everywhere" it is a fix of position and velocity
    from elsewhere, which water does not hinder.

    Defaults: a single-frequency receiver as the u-blox NEO-M8 data sheet gives it: position
    accuracy 2.5 m CEP, that is 2.1 m per horizontal axis, nearly all of it slow (correlation
    time 600 s, assumed), 0.1 m of white noise (assumed); height 1.5 times worse (assumed);
    velocity 0.05 m/s; 5 Hz; delay 0.15 s (assumed, usual for such receivers).
    """

    exercised: ClassVar = {"dropout": 0.2, "antenna": [0.2, 0.1, -0.3]}

    period = Parameter(0.2, "s", "sample period", min=1e-6)
    delay = Parameter(0.15, "s", "time from measurement to output", min=0.0)
    correlation_time = Parameter(600.0, "s", "correlation time of the varying bias", min=1e-6)
    reception = Parameter("air", "1", "where the antenna receives", choices=("air", "everywhere"))
    antenna = Parameter(0.0, "m", "antenna from the body origin, body axes", axes="xyz")

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    velocity = Input("m/s", "velocity of the body origin, body axes", axes=("u", "v", "w"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))

    position_n = Measured(
        "m",
        "position of the antenna, north-east-down",
        axes=_NED,
        span=(-500.0, 500.0),
        noise=(0.1, 0.1, 0.15),
        instability=(2.1, 2.1, 3.2),
        resolution=0.001,
    )
    velocity_n = Measured(
        "m/s",
        "velocity of the antenna, north-east-down",
        axes=_NED,
        span=(-10.0, 10.0),
        noise=0.05,
        resolution=0.001,
    )

    terminals: ClassVar = {
        "motion": terminal("position", "velocity", "attitude", "rates"),
        "reading": terminal("position_n", "velocity_n", position_valid="valid"),
    }
    feedthrough: ClassVar = dict.fromkeys(
        ("position_n", "valid", "count"), ("position", "attitude", "fault")
    )

    def measure(self) -> Sequence[Value]:
        """Return the antenna's position and velocity."""
        attitude, antenna = self.attitude, self.antenna
        arm = to_ned(attitude, antenna)
        if self.reception == "air" and self.position[2] + arm[2] > 0.0:
            return [None] * 6
        swing = cross(self.rates, antenna)
        velocity = to_ned(attitude, [v + s for v, s in zip(self.velocity, swing, strict=True)])
        return [*(p + a for p, a in zip(self.position, arm, strict=True)), *velocity]
