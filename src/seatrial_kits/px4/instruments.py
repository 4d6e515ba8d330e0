"""Instruments of the simulated firmware: true motion to HIL_SENSOR, HIL_GPS, HIL_STATE_QUATERNION.

Equations of the instruments, with their noise w standard normal:

    rates            = omega + noise w                                             rad/s
    specific force   = f + d omega/dt x r + omega x (omega x r) + noise w          m/s2
    magnetic field   = R^T B + noise w, B of the World Magnetic Model at the home  T
    pressure         = 101325 (1 - 0.0065 h / 288.15)^5.25588 + noise w            Pa
    position         = x + R a + noise w, velocity = R (v + omega x a) + noise w   m, m/s

with r and a the places of inertial unit and antenna, f the specific force at the body origin, h
the altitude, of the International Standard Atmosphere (ISO 2533). Below the surface too: PX4
takes heights from pressures as in air, so that it reads its depth right. d omega/dt is the change
over the step before.

Of the instruments that ``measured`` names the vehicle's own sensors have the errors, delays, and
outages: rates and specific force are theirs, so are position and velocity of a fix, and B is
turned by the measured heading in the place of the true one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.atmosphere import LAPSE, SEA_LEVEL_K, standard_pressure
from seatrial.links.earth_field import earth_field
from seatrial.links.geodesy import Ned, Origin
from seatrial.links.parameter_validation import start_us
from seatrial.links.truth import Truth
from seatrial.model.component import NS
from seatrial.model.unit_table import STANDARD_GRAVITY
from seatrial.physics.craft.kinematics import cross, to_body, to_ned
from seatrial_kits.mavlink.codec import Message
from seatrial_kits.mavlink.scaling import compass_degrees, deg_e7, int16, int32, quaternion, uint16

from .ports import Px4Ports, read_measured

ACCELEROMETER, GYRO, FIELD, PRESSURE = 0x7, 0x38, 0x1C0, 0x1A00
"""What a HIL_SENSOR has new, in its ``fields_updated``."""
_GAUSS_PER_TESLA, _PA_PER_HPA = 1e4, 100.0
_CELSIUS = 273.15
_FIX_3D = 3
_NORMALS = 16
"""Random numbers of a sample: 3 of each inertial quantity and of the field, 1, 3 and 3."""


class Clock:
    """Instants every ``period_ns``, counted from the start; ``take`` is true once for each."""

    def __init__(self, period: float) -> None:
        self._period_ns = round(period * NS)
        self._taken = -1

    def take(self, passed_ns: int) -> bool:
        """Return whether an instant has come since the last one that was taken."""
        number = passed_ns // self._period_ns
        due, self._taken = number > self._taken, number
        return due


class Instruments:
    """The sensors of the component ``of``; noise is keyed by its seed and the sample's time."""

    def __init__(self, of: Px4Ports, start_ns: int) -> None:
        self._of, self._start_ns = of, start_ns
        self._origin = Origin(of.latitude, of.longitude, of.altitude)
        self._start_us = start_us(of.date)
        self._measured = read_measured(of.measured)
        place = of.latitude, of.longitude, of.altitude
        self._field_n = earth_field(*place, self._start_us * 1e-6)
        self._clocks = {
            FIELD: Clock(of.field_period),
            PRESSURE: Clock(of.pressure_period),
            _FIX_3D: Clock(of.gnss_period),
        }
        self._rates: Ned | None = None
        self._at_ns = start_ns

    def messages(self, now_ns: int, truth: Truth) -> list[Message]:
        """Return what is measured at ``now_ns``; the last message sets the firmware's clock."""
        us = microseconds(now_ns)
        normal = self._of.generator(us).standard_normal(_NORMALS).tolist()
        sensor = self._sensor(now_ns, us, truth, normal)
        found = [self._truth(us, truth)]
        if self._clocks[_FIX_3D].take(now_ns - self._start_ns) and self._receives(truth):
            found.append(self._fix(now_ns, truth, normal[10:]))
        return [*found, sensor]

    # ------------------------------------------------------------------ inside

    def _sensor(self, now_ns: int, us: int, truth: Truth, normal: Sequence[float]) -> Message:
        of, passed = self._of, now_ns - self._start_ns
        updated = 0 if "imu" in self._measured and not of.imu_valid else ACCELEROMETER | GYRO
        works = of.heading_valid or "compass" not in self._measured
        if self._clocks[FIELD].take(passed) and works and not of.without[1]:
            updated |= FIELD
        if self._clocks[PRESSURE].take(passed) and not of.without[2]:
            updated |= PRESSURE
        force, rates = of.accelerometer, of.gyro
        if "imu" not in self._measured:
            force = _noisy(self._specific_force(now_ns, truth), of.accelerometer_noise, normal)
            rates = _noisy(truth.rates, of.gyro_noise, normal[3:])
        if "compass" in self._measured:
            field = to_body((*truth.attitude[:2], of.heading), self._field_n)
        else:
            field = _noisy(to_body(truth.attitude, self._field_n), of.field_noise, normal[6:])
        altitude = of.altitude - truth.position_n[2]
        pressure = standard_pressure(altitude) + of.pressure_noise * normal[9]
        celsius = SEA_LEVEL_K - _CELSIUS - LAPSE * altitude
        gauss = [_GAUSS_PER_TESLA * each for each in field]
        hpa = pressure / _PA_PER_HPA
        return mavlink.MAVLink_hil_sensor_message(
            us, *force, *rates, *gauss, hpa, 0.0, altitude, celsius, updated, 0
        )

    def _specific_force(self, now_ns: int, truth: Truth) -> Ned:
        """Return the specific force where the inertial unit is."""
        before, self._rates = self._rates or truth.rates, truth.rates
        h, self._at_ns = (now_ns - self._at_ns) / NS, now_ns
        if not any(self._of.imu):
            return truth.specific_force
        turn = [(new - old) / h if h else 0.0 for new, old in zip(truth.rates, before, strict=True)]
        tangential = cross(turn, self._of.imu)
        central = cross(truth.rates, cross(truth.rates, self._of.imu))
        x, y, z = (sum(p) for p in zip(truth.specific_force, tangential, central, strict=True))
        return x, y, z

    def _receives(self, truth: Truth) -> bool:
        if self._of.without[0]:
            return False
        if "gnss" in self._measured:
            return bool(self._of.position_valid)
        height = -truth.position_n[2] - to_ned(truth.attitude, self._of.antenna)[2]
        return self._of.reception == "everywhere" or height >= 0.0

    def _fix(self, now_ns: int, truth: Truth, normal: Sequence[float]) -> Message:
        of = self._of
        if "gnss" in self._measured:
            return self._located(now_ns, of.position_n, of.velocity_n)
        lever = to_ned(truth.attitude, of.antenna)
        swing = to_ned(truth.attitude, cross(truth.rates, of.antenna))
        north, east, down = (
            x + arm + noise * w
            for x, arm, noise, w in zip(
                truth.position_n, lever, of.position_noise, normal[:3], strict=True
            )
        )
        velocity = [
            v + extra + of.velocity_noise * w
            for v, extra, w in zip(truth.velocity_n, swing, normal[3:6], strict=True)
        ]
        return self._located(now_ns, (north, east, down), velocity)

    def _located(self, now_ns: int, position: Ned, velocity: Sequence[float]) -> Message:
        of = self._of
        latitude, longitude, altitude = self._origin.geodetic(position)
        speed = math.hypot(velocity[0], velocity[1])
        course = round(100.0 * compass_degrees(math.atan2(velocity[1], velocity[0]))) % 36_000
        accuracy = math.hypot(*of.position_noise[:2]), of.position_noise[2]
        return mavlink.MAVLink_hil_gps_message(
            self._start_us + (now_ns - self._start_ns) // 1000, _FIX_3D,
            deg_e7(latitude), deg_e7(longitude), int32(1e3 * altitude),
            *(uint16(100.0 * each) for each in (*accuracy, speed)),
            *(int16(100.0 * each) for each in velocity), course, round(of.satellites),
        )  # fmt: skip

    def _truth(self, us: int, truth: Truth) -> Message:
        latitude, longitude, altitude = self._origin.geodetic(truth.position_n)
        milli_g = [int16(1e3 * each / STANDARD_GRAVITY) for each in truth.specific_force]
        return mavlink.MAVLink_hil_state_quaternion_message(
            us, quaternion(truth.attitude), *truth.rates,
            deg_e7(latitude), deg_e7(longitude), int32(1e3 * altitude),
            *(int16(100.0 * v) for v in truth.velocity_n), 0, 0, *milli_g,
        )  # fmt: skip


def microseconds(now_ns: int) -> int:
    """Return the firmware's time: simulated time, but never 0, which stands for none there."""
    return max(1, now_ns // 1000)


def _noisy(values: Sequence[float], noise: float, normal: Sequence[float]) -> Ned:
    x, y, z = (v + noise * w for v, w in zip(values, normal[:3], strict=True))
    return x, y, z
