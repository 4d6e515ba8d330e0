"""Inertial measurement unit with an attitude solution."""

from __future__ import annotations

import math
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..model.unit_table import STANDARD_GRAVITY
from ..physics.craft.kinematics import specific_force
from .sensor import ALWAYS_THERE, Measured, Sensor

_DEG = math.radians(1.0)


class Imu(Sensor):
    """Gyro, accelerometer and roll/pitch solution at the body origin, axes along the body's.

        gyro          = rates                               (p, q, r), rad/s
        accelerometer = acceleration - R^T (0, 0, gravity)  specific force, m/s2
        roll_pitch    = (phi, theta)                        rad

    in body axes x bow, y starboard, z down, with the errors of `Sensor` on each. At rest and
    level the accelerometer reads (0, 0, -gravity). ``acceleration`` is the inertial
    acceleration of the body origin in body axes, dv/dt + omega x v.

    Defaults: a MEMS unit of the autopilot class at 100 Hz, as data sheets of the InvenSense
    ICM-20689/42688 kind give it: gyro noise 0.005 deg/s/sqrt(Hz) and accelerometer noise
    100 ug/sqrt(Hz), hence 0.035 deg/s and 0.007 m/s2 in 50 Hz; bias instability some 10 deg/h
    (0.003 deg/s) and 0.05 mg; 16 bits of +-250 deg/s and +-4 g; attitude solution 0.1 deg rms
    noise and 0.3 deg of slow error. Biases are 0: a calibrated unit.

    Not modelled: lever arm, misalignment, scale factor, saturation, vibration; the attitude
    solution is truth with errors, not a filter that accelerations could mislead.
    """

    exercised: ClassVar = {"delay": 0.013, "dropout": 0.2}

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)

    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    acceleration = Input(
        "m/s2", "inertial acceleration of the body origin, body axes", axes="xyz", frame="b"
    )

    gyro = Measured(
        "rad/s",
        "angular velocity, body axes",
        axes="xyz",
        frame="b",
        span=(-250.0 * _DEG, 250.0 * _DEG),
        noise=0.035 * _DEG,
        instability=0.003 * _DEG,
        resolution=250.0 / 32768 * _DEG,
    )
    accelerometer = Measured(
        "m/s2",
        "specific force, body axes",
        axes="xyz",
        frame="b",
        span=(-4 * STANDARD_GRAVITY, 4 * STANDARD_GRAVITY),
        noise=0.007,
        instability=0.0005,
        resolution=4 * STANDARD_GRAVITY / 32768,
    )
    roll_pitch = Measured(
        "rad",
        "roll and pitch of the attitude solution",
        axes=("phi", "theta"),
        span=((-math.pi, -math.pi / 2), (math.pi, math.pi / 2)),
        noise=0.1 * _DEG,
        instability=0.3 * _DEG,
    )

    terminals: ClassVar = {
        "motion": terminal("attitude", "rates", "acceleration"),
        "reading": terminal(
            "gyro",
            "accelerometer",
            "roll_pitch",
            imu_valid="valid",
            gyro_valid="valid",
            heel="roll_pitch__phi",
            pitch="roll_pitch__theta",
            roll_rate="gyro__x",
            yaw_rate="gyro__z",
        ),
    }
    feedthrough: ClassVar = {
        **ALWAYS_THERE,
        "gyro": ("rates", "fault"),
        "accelerometer": ("attitude", "acceleration", "fault"),
        "roll_pitch": ("attitude", "fault"),
    }

    def measure(self) -> list[float]:
        """Return rates, specific force, roll and pitch."""
        force = specific_force(self.attitude, self.acceleration, self.gravity)
        return [*self.rates, *force, *self.attitude[:2]]
