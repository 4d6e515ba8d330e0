"""Attitude and heading reference with accelerometers."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..physics.craft.kinematics import specific_force
from .sensor import ALWAYS_THERE, Measured, Sensor, full_circle, half_circle

_DEG = math.radians(1.0)


class Ahrs(Sensor):
    """Attitude and specific force as an inspection ROV reports them.

        euler         = (phi, theta, psi)                   rad
        accelerometer = acceleration - R^T (0, 0, gravity)  specific force, m/s2

    in body axes x bow, y starboard, z down, with the errors of `Sensor` on each; phi is in
    (-pi, pi], psi in [0, 2 pi) as on a compass card. ``acceleration`` is the inertial
    acceleration of the body origin in body axes, dv/dt + omega x v. At rest and level the
    accelerometer reads (0, 0, -gravity), and tilted a share of gravity on every axis: who wants
    the acceleration of the vehicle must add R^T (0, 0, gravity) with the attitude. [Paulino2015],
    table 7.1, has the mean readings at rest with the other sign.

    Defaults are the VideoRay Pro 4's: 0.1 s; attitude in 0.1 degrees with the noise of the dry
    vehicle; acceleration in cm/s2 with the noise that is left in the pool when gravity is taken
    off. Its angular accelerations are raw counts (-25088 with a deviation of 0 in table 7.1):
    nobody could use them, and they are not here.

    Not modelled: drift, magnetic deviation, an attitude that accelerations mislead, lever arm,
    saturation.
    """

    exercised: ClassVar = {"delay": 0.13, "dropout": 0.2}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)

    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    acceleration = Input(
        "m/s2", "inertial acceleration of the body origin, body axes", axes="xyz", frame="b"
    )

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
        "specific force, body axes",
        axes="xyz",
        frame="b",
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
    feedthrough: ClassVar = {**ALWAYS_THERE, "euler": ("attitude", "fault")}

    def measure(self) -> list[float]:
        """Return the attitude and the specific force."""
        force = specific_force(self.attitude, self.acceleration, self.gravity)
        return [*self.attitude, *force]

    def finish(self, values: list[float]) -> list[float]:
        """Return phi in (-pi, pi] and psi in [0, 2 pi)."""
        phi, theta, psi, *acceleration = values
        return [half_circle(phi), theta, full_circle(psi), *acceleration]
