"""Attitude and heading reference with accelerometers."""

from __future__ import annotations

import math
from typing import ClassVar

from ..component import Input, Parameter, terminal
from ..craft.kinematics import to_body
from ..errors import InputError
from .sensor import Measured, Sensor, full_circle, half_circle

_DEG = math.radians(1.0)


class Ahrs(Sensor):
    """Attitude and linear acceleration as an inspection ROV reports them, gravity included.

        attitude      = (phi, theta, psi)                             rad
        accelerometer = R^T (0, 0, gravity) + acc_sign acceleration   m/s2

    in body axes x bow, y starboard, z down, with the errors of `Sensor` on each; phi is in
    (-pi, pi], psi in [0, 2 pi) as on a compass card. ``acceleration`` is the inertial
    acceleration of the body origin in body axes, dv/dt + omega x v. At rest and level the
    accelerometer reads (0, 0, +gravity), and tilted a share of gravity on every axis: who wants
    the acceleration of the vehicle must take R^T (0, 0, gravity) off with the attitude.

    ``acc_sign`` = -1 is minus the specific force, what a device gives that reads +gravity on a
    z axis that points down; 1 adds the acceleration. Source 000, table 7.1, has the mean
    readings at rest, from which the gravity follows; the sign of the other part is inferred.

    Defaults are the VideoRay Pro 4's: 0.1 s; attitude in 0.1 degrees with the noise of the dry
    vehicle; acceleration in cm/s2 with the noise that is left in the pool when gravity is taken
    off. Its angular accelerations are raw counts (-25088 with a deviation of 0 in table 7.1):
    nobody could use them, and they are not here.

    Not modelled: drift, magnetic deviation, an attitude that accelerations mislead, lever arm,
    saturation.

    Raises InputError at the start if ``acc_sign`` is neither -1 nor 1.
    """

    exercised: ClassVar = {"delay": 0.13, "dropout": 0.2}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    acc_sign = Parameter(
        -1.0, "1", "sign of the acceleration in the reading: -1 or 1", min=-1.0, max=1.0
    )

    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    acceleration = Input("m/s2", "inertial acceleration of the body origin, body axes", axes="xyz")

    euler = Measured(
        "rad",
        "Euler angles, ZYX; psi from 0 to 2 pi",
        axes=("phi", "theta", "psi"),
        span=((-math.pi, -math.pi / 2, 0.0), (math.pi, math.pi / 2, math.tau)),
        noise=(0.134 * _DEG, 0.05 * _DEG, 0.195 * _DEG),
        resolution=0.1 * _DEG,
    )
    accelerometer = Measured(
        "m/s2",
        "gravity and acceleration, body axes",
        axes="xyz",
        span=(-20.0, 20.0),
        noise=(0.024, 0.016, 0.043),
        resolution=0.01,
    )

    terminals: ClassVar = {
        "motion": terminal("attitude", "acceleration"),
        "reading": terminal(
            "euler",
            "accelerometer",
            imu_valid="valid",
            heading="euler__psi",
            heading_valid="valid",
            heel="euler__phi",
            pitch="euler__theta",
        ),
    }
    feedthrough: ClassVar = {
        "euler": ("attitude",),
        "accelerometer": ("attitude", "acceleration"),
    }

    def reset(self, t: float) -> None:
        """Start with nothing published; raises InputError for an ``acc_sign`` between the two."""
        if abs(self.acc_sign) != 1.0:
            raise InputError(f"{self.name}.acc_sign is {self.acc_sign!r}, allowed -1.0 or 1.0")
        super().reset(t)

    def measure(self) -> list[float]:
        """Return the attitude, and gravity with the acceleration added or taken off."""
        attitude, sign = self.attitude, self.acc_sign
        gravity = to_body(attitude, (0.0, 0.0, self.gravity))
        return [*attitude, *(g + sign * a for g, a in zip(gravity, self.acceleration, strict=True))]

    def finish(self, values: list[float]) -> list[float]:
        """Return phi in (-pi, pi] and psi in [0, 2 pi)."""
        phi, theta, psi, *acceleration = values
        return [half_circle(phi), theta, full_circle(psi), *acceleration]
