"""Satellite positioning receiver."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..physics.craft.kinematics import cross, to_ned
from .sensor import Measured, Sensor, Value

_NED = ("north", "east", "down")


class Gnss(Sensor):
    """GNSS receiver: position and velocity of its antenna, north-east-down from the origin.

        position_n = position + R antenna + multipath     m
        velocity_n = R (velocity + rates x antenna)       m/s

    with the errors of `Sensor` on each; ``antenna`` is the lever arm from the body origin in
    body axes (x bow, y starboard, z down), R the rotation body to NED. The receiver does not
    correct for the lever arm. Position on a flat earth: latitude and
    longitude are for links to convert. An antenna below the surface receives nothing:
    measurements are lost, and for the time ``reacquisition`` after it has come up. With
    ``reception`` = "everywhere" it is a fix of position and velocity from elsewhere, which water
    does not hinder.

    Reflections at superstructure, quay and sea move the position by ``multipath``, the standard
    deviation of a first-order Gauss-Markov process of ``multipath_time`` for each axis, beside the
    slow error of satellites and ionosphere, which is the ``instability`` of `Sensor`.

    Defaults: a single-frequency receiver as the u-blox NEO-M8 data sheet gives it: position
    accuracy 2.5 m CEP, that is 2.1 m per horizontal axis, nearly all of it slow (correlation
    time 600 s, assumed), 0.1 m of white noise (assumed); height 1.5 times worse (assumed);
    velocity 0.05 m/s; 5 Hz; delay 0.15 s (assumed, usual for such receivers). No multipath: an
    open sky, where that is in the slow error.
    """

    exercised: ClassVar = {
        "dropout": 0.2,
        "antenna": [0.2, 0.1, -0.3],
        "multipath": [0.5, 0.4, 0.8],
        "multipath_time": 20.0,
        "reacquisition": 1.0,
    }

    period = Parameter(0.2, "s", "sample period", min=1e-6)
    delay = Parameter(0.15, "s", "time from measurement to output", min=0.0)
    correlation_time = Parameter(600.0, "s", "correlation time of the varying bias", min=1e-6)
    reception = Parameter("air", "1", "where the antenna receives", choices=("air", "everywhere"))
    antenna = Parameter(0.0, "m", "antenna from the body origin, body axes", axes="xyz")
    multipath = Parameter(
        0.0, "m", "error by reflections, standard deviation, north-east-down", axes=_NED, min=0.0
    )
    multipath_time = Parameter(30.0, "s", "correlation time of reflections", min=1e-6)
    reacquisition = Parameter(0.0, "s", "time from surfacing to the first fix", min=0.0)

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

    def reset(self, t: float) -> None:
        """Start with nothing published, as if the antenna had been above water for long."""
        self._stays = math.exp(-self.period / self.multipath_time)
        self._waiting = 0
        self._reflected = self._reflections(0, 1.0)
        super().reset(t)

    def update(self, t: float, k: int) -> None:
        """Remember whether the antenna is below water, and go on to the next reflections."""
        super().update(t, k)
        least = math.ceil(self.reacquisition / self.period - 1e-9)
        self._waiting = least if self._is_under_water() else max(0, self._waiting - 1)
        drawn = self._reflections(k + 1, math.sqrt(1.0 - self._stays**2))
        self._reflected = [self._stays * a + b for a, b in zip(self._reflected, drawn, strict=True)]

    def measure(self) -> Sequence[Value]:
        """Return the antenna's position and velocity."""
        if self._waiting or self._is_under_water():
            return [None] * 6
        attitude, antenna = self.attitude, self.antenna
        swing = cross(self.rates, antenna)
        velocity = to_ned(attitude, [v + s for v, s in zip(self.velocity, swing, strict=True)])
        places = zip(self.position, to_ned(attitude, antenna), self._reflected, strict=True)
        return [*(p + a + m for p, a, m in places), *velocity]

    def _is_under_water(self) -> bool:
        arm = to_ned(self.attitude, self.antenna)
        return bool(self.reception == "air" and self.position[2] + arm[2] > 0.0)

    def _reflections(self, k: int, share: float) -> list[float]:
        """Return a share of the error by reflections, drawn for measurement ``k``."""
        if not any(self.multipath):
            return [0.0, 0.0, 0.0]
        normal = self.generator(k, 3).standard_normal(3).tolist()
        return [share * s * v for s, v in zip(self.multipath, normal, strict=True)]
