"""Inertial measurement unit where it is mounted, with an attitude solution of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..model.unit_table import STANDARD_GRAVITY
from ..physics.craft.kinematics import cross, specific_force
from .sensor import ALWAYS_THERE, Measured, Sensor, half_circle

_DEG = math.radians(1.0)
_STATED_AT = 298.15
"""Temperature at which biases are stated, K."""
_STEEPEST = math.radians(89.0)
"""Pitch at which the attitude solution is held: beyond it roll has no meaning."""


class Imu(Sensor):
    """Gyro, accelerometer and roll/pitch solution, in body axes x bow, y starboard, z down.

        gyro          = rates                                     (p, q, r), rad/s
        accelerometer = a_r - R^T (0, 0, gravity) + vibration     specific force, m/s2
        roll_pitch    = (phi, theta)                              rad

    with the errors of `Sensor` on each. At rest and level the accelerometer reads (0, 0,
    -gravity). ``acceleration`` is the inertial acceleration of the body origin in body axes,
    dv/dt + omega x v; at ``place`` r it is a_r = acceleration + omega' x r + omega x (omega x r),
    with omega' by a second-order difference of the rates at three samples.

    **Axes and scale.** Of x in body axes both read x + scale x - misalignment x x, the
    ``misalignment`` a small rotation from the body's axes to those of the chip, and beyond 25 degC
    temperature_drift (temperature - 298.15 K) more.

    **Vibration** of a rotor, propeller or engine out of balance, which turns at the speed W
    ``vibration_speed``: ``vibration`` (W / vibration_reference)^2 cos(integral of W), per axis.

    **Attitude solution.** ``attitude_time`` T = 0: the truth with errors. Else a complementary
    filter of the unit's own readings, the gyro's (p, q, r), the accelerometer's f:

        phi'   = p + tan(theta) (q sin(phi) + r cos(phi)) + (atan2(-f_y, -f_z) - phi) / T
        theta' = q cos(phi) - r sin(phi) + (atan2(f_x, |(f_y, f_z)|) - theta) / T

    by steps of ``period``, levelled at the start. So it is misled as real ones are: a bias b of
    the gyro tilts it by b T, a long turn at speed U and rate r by -U r / (gravity (1 + (r T)^2)) in
    roll and -r T times that in pitch, and waves shake it. What was lost or failed is not taken.

    Defaults: a MEMS unit of the autopilot class at 100 Hz, as data sheets of the InvenSense
    ICM-20689/42688 kind give it: gyro noise 0.005 deg/s/sqrt(Hz) and accelerometer noise
    100 ug/sqrt(Hz), hence 0.035 deg/s and 0.007 m/s2 in 50 Hz; bias instability some 10 deg/h
    (0.003 deg/s) and 0.05 mg; 16 bits of +-250 deg/s and +-4 g; attitude solution 0.1 deg rms
    noise and 0.3 deg of slow error. Biases are 0: a calibrated unit.

    Not modelled: sensitivity of the gyro to acceleration, hysteresis of temperature, angular
    vibration.
    """

    exercised: ClassVar = {
        "delay": 0.013,
        "dropout": 0.2,
        "place": [0.3, -0.2, 0.1],
        "gyro_scale": [0.01, -0.02, 0.03],
        "gyro_misalignment": [0.01, 0.02, -0.03],
        "gyro_temperature_drift": [1e-4, 2e-4, -1e-4],
        "accelerometer_scale": [0.01, -0.02, 0.03],
        "accelerometer_misalignment": [0.01, 0.02, -0.03],
        "accelerometer_temperature_drift": [1e-3, 2e-3, -1e-3],
        "vibration": [0.1, 0.2, 0.3],
        "temperature": 310.0,
        "vibration_speed": 60.0,
    }

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    place = Parameter(0.0, "m", "sensor from the body origin, body axes", axes="xyz")
    gyro_scale = Parameter(0.0, "1", "error of the gyro's scale, share", axes="xyz")
    gyro_misalignment = Parameter(0.0, "rad", "rotation of the gyro's axes", axes="xyz")
    gyro_temperature_drift = Parameter(0.0, "rad/(s.K)", "drift of the gyro's bias", axes="xyz")
    accelerometer_scale = Parameter(
        0.0, "1", "error of the accelerometer's scale, share", axes="xyz"
    )
    accelerometer_misalignment = Parameter(
        0.0, "rad", "rotation of the accelerometer's axes", axes="xyz"
    )
    accelerometer_temperature_drift = Parameter(
        0.0, "m/(s2.K)", "drift of the accelerometer's bias", axes="xyz"
    )
    vibration = Parameter(
        0.0, "m/s2", "amplitude of the vibration at its reference speed, body axes", axes="xyz"
    )
    vibration_reference = Parameter(
        100.0, "rad/s", "speed for which the vibration is given", min=1e-6
    )
    attitude_time = Parameter(
        0.0, "s", "time constant of levelling by the accelerometer, 0: truth with errors", min=0.0
    )

    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    acceleration = Input(
        "m/s2", "inertial acceleration of the body origin, body axes", axes="xyz", frame="b"
    )
    temperature = Input("K", "temperature of the unit", start=_STATED_AT, optional=True)
    vibration_speed = Input("rad/s", "speed of what vibrates", optional=True)

    gyro = Measured(
        "rad/s",
        "angular velocity, body axes",
        axes="xyz",
        frame="b",
        span=(-250.0 * _DEG, 250.0 * _DEG),
        noise=0.035 * _DEG,
        instability=0.003 * _DEG,
        resolution=250.0 / 32768 * _DEG,
        bandwidth=50.0,
        limit=250.0 * _DEG,
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
        bandwidth=50.0,
        limit=4 * STANDARD_GRAVITY,
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
        "gyro": ("rates", "temperature", "fault"),
        "accelerometer": (
            *("attitude", "acceleration", "rates", "temperature", "vibration_speed", "fault"),
        ),
        "roll_pitch": ("attitude", "fault"),
    }

    def reset(self, t: float) -> None:
        """Start with nothing published, the attitude solution level with the vehicle."""
        self._last_rates, self._first_rates, self._known = [0.0] * 3, [0.0] * 3, 0
        self._turned = 0.0
        self._solution = list(self.attitude[:2])
        super().reset(t)

    def update(self, t: float, k: int) -> None:
        """Take what was measured into the attitude solution, and remember the rates."""
        super().update(t, k)
        if self.attitude_time and self._arrived:
            readings = [0.0 if y is None else y for y in self._last]
            self._solution = self._levelled(readings[:3], readings[3:6])
        self._first_rates, self._last_rates = self._last_rates, list(self.rates)
        self._known += 1
        self._turned = (self._turned + self.period * self.vibration_speed) % math.tau

    def measure(self) -> list[float]:
        """Return rates, specific force, roll and pitch."""
        warmer = self.temperature - _STATED_AT
        gyro = _read(
            self.rates, self.gyro_scale, self.gyro_misalignment, self.gyro_temperature_drift, warmer
        )
        force = _read(
            self._force(),
            self.accelerometer_scale,
            self.accelerometer_misalignment,
            self.accelerometer_temperature_drift,
            warmer,
        )
        return [*gyro, *force, *(self._solution if self.attitude_time else self.attitude[:2])]

    def _force(self) -> list[float]:
        """Return the specific force at the unit, vibration included."""
        force = list(specific_force(self.attitude, self.acceleration, self.gravity))
        if any(self.place):
            turning = cross(self._angular_acceleration(), self.place)
            inwards = cross(self.rates, cross(self.rates, self.place))
            force = [f + a + b for f, a, b in zip(force, turning, inwards, strict=True)]
        if any(self.vibration):
            now = (self.vibration_speed / self.vibration_reference) ** 2 * math.cos(self._turned)
            force = [f + now * v for f, v in zip(force, self.vibration, strict=True)]
        return force

    def _angular_acceleration(self) -> list[float]:
        """Return omega', rad/s2, from the rates now and at the two samples before."""
        if self._known == 0:
            return [0.0, 0.0, 0.0]
        if self._known == 1:
            return [
                (a - b) / self.period for a, b in zip(self.rates, self._last_rates, strict=True)
            ]
        return [
            (3.0 * a - 4.0 * b + c) / (2.0 * self.period)
            for a, b, c in zip(self.rates, self._last_rates, self._first_rates, strict=True)
        ]

    def _levelled(self, gyro: list[float], force: list[float]) -> list[float]:
        """Return the attitude solution at the next sample."""
        (phi, theta), (p, q, r), (x, y, z) = self._solution, gyro, force
        sin, cos = math.sin(phi), math.cos(phi)
        share = 1.0 - math.exp(-self.period / self.attitude_time)
        phi += self.period * (p + math.tan(theta) * (q * sin + r * cos))
        theta += self.period * (q * cos - r * sin)
        phi += share * half_circle(math.atan2(-y, -z) - phi)
        theta += share * (math.atan2(x, math.hypot(y, z)) - theta)
        return [half_circle(phi), min(max(theta, -_STEEPEST), _STEEPEST)]


def _read(
    x: Sequence[float],
    scale: Sequence[float],
    turned: Sequence[float],
    drift: Sequence[float],
    warmer: float,
) -> list[float]:
    """Return what a triad of axes reads of ``x``, before noise and bias."""
    across = cross(turned, x)
    return [a + s * a - c + d * warmer for a, s, c, d in zip(x, scale, across, drift, strict=True)]
