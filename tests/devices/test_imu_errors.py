"""Errors of inertial sensors that have a closed form: place, axes, noise, vibration, levelling."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.devices.ahrs import Ahrs
from seatrial.devices.imu import Imu

from .ideal import ideal
from .running import run, started

G = 9.81
PLACE = np.array([0.4, -0.3, 0.2])


def read(imu, seconds, inputs, outputs=("gyro", "accelerometer", "roll_pitch"), step_ms=10):
    rows = run(imu, list(outputs), round(1000 * seconds), step_ms, inputs)
    return tuple(np.array(column, dtype=float) for column in zip(*rows, strict=True))


def test_a_unit_off_the_origin_reads_its_own_acceleration():
    # w = (a t^2, b t, c): a difference of second order is exact where rates are quadratic.
    a, b, c = 0.3, -0.2, 0.5

    def rates(t):
        return np.array([a * t**2, b * t, c])

    imu = ideal(Imu, place=PLACE)
    _, force, _ = read(imu, 1.0, lambda ms: {"rates": rates(ms / 1000)})
    for ms in (20, 500, 1000):
        t = ms / 1000
        w, turning = rates(t), np.array([2 * a * t, b, 0.0])
        expected = np.cross(turning, PLACE) + np.cross(w, np.cross(w, PLACE)) - [0, 0, G]
        np.testing.assert_allclose(force[ms // 10], expected, rtol=0, atol=1e-11)


def test_scale_and_axes_of_the_chip():
    # Of a small rotation, x - e x x is what turned axes read, to the second order.
    turned, scale = np.array([2e-4, -3e-4, 1e-4]), np.array([0.01, -0.02, 0.005])
    rates, acceleration = np.array([0.3, -0.5, 0.7]), np.array([1.0, 2.0, -3.0])
    values = {
        f"{each}_{what}": value
        for each in ("gyro", "accelerometer")
        for what, value in (("scale", scale), ("misalignment", turned))
    }
    imu = ideal(Imu, rates=rates, acceleration=acceleration, **values)
    into_chip = Rotation.from_rotvec(turned).inv()
    for name, true in (("gyro", rates), ("accelerometer", acceleration - [0, 0, G])):
        expected = into_chip.apply(true) + scale * true
        np.testing.assert_allclose(imu.get(name), expected, rtol=0, atol=2e-6)


def test_biases_drift_with_the_temperature():
    drifts = {
        "gyro_temperature_drift": (1e-4, 0, -2e-4),
        "accelerometer_temperature_drift": (0, 3e-3, 0),
    }
    imu = ideal(Imu, **drifts, temperature=308.15)
    np.testing.assert_allclose(imu.get("gyro"), (1e-3, 0, -2e-3), atol=1e-15)
    np.testing.assert_allclose(imu.get("accelerometer"), (0, 0.03, -G), atol=1e-12)


def test_readings_end_at_the_range():
    imu = started(Imu, rates=(9.0, -9.0, 0.0), acceleration=(90.0, 0, -90.0))
    assert imu.get("gyro")[:2] == [math.radians(250), -math.radians(250)]
    assert imu.get("accelerometer")[::2] == [4 * 9.80665, -4 * 9.80665]


@pytest.mark.parametrize("period", [0.0025, 0.04])
def test_noise_has_one_density_whatever_the_period(period):
    # Allan deviation of white noise of one-sided density N: N / sqrt(2 tau).
    tau, spans, density = 0.4, 60, math.radians(0.005)
    imu = started(
        Imu, period=period, gyro_noise=density, gyro_bandwidth=1.0,
        gyro_instability=0.0, gyro_resolution=0.0,
    )  # fmt: skip
    step_ms = 1000 * period
    rows = []
    for k in range(round(spans * tau / period)):
        rows.append(imu.get("gyro"))
        imu.advance(k * step_ms / 1000, step_ms / 1000)
    means = np.array(rows).reshape(spans, -1, 3).mean(axis=1)
    deviation = np.sqrt(0.5 * np.mean(np.diff(means, axis=0) ** 2))
    # 177 differences, each correlated with its neighbours: 6 % is the standard error.
    assert deviation == pytest.approx(density / math.sqrt(2 * tau), rel=0.2)


def test_the_default_noise_is_that_of_its_data_sheet():
    assert started(Imu)._noise[0] == math.radians(0.035)
    assert started(Imu, period=0.0025)._noise[0] == pytest.approx(math.radians(0.07), rel=1e-12)
    assert started(Imu, gyro_bandwidth=0.0, period=0.0025)._noise[0] == math.radians(0.035)


def test_what_is_out_of_balance_shakes_with_the_square_of_its_speed():
    speed, reference, size = 2 * math.pi * 13.0, 100.0, np.array([0.5, 0.2, 1.0])
    imu = ideal(Imu, vibration=size, vibration_reference=reference, vibration_speed=speed)
    _, force, _ = read(imu, 9.99, lambda ms: {})
    spectrum = 2 * np.abs(np.fft.rfft(force - force.mean(axis=0), axis=0)) / len(force)
    assert np.fft.rfftfreq(len(force), 0.01)[spectrum[:, 0].argmax()] == pytest.approx(13.0)
    np.testing.assert_allclose(spectrum.max(axis=0), size * (speed / reference) ** 2, rtol=1e-9)


# ------------------------------------------------------------------ attitude solution


def test_a_long_turn_tilts_the_horizon():
    # A flat turn at speed U and rate r has the specific force (0, U r, -g). For small angles
    # phi' = r theta + (e - phi) / T and theta' = -r phi - theta / T, e = -U r / g, which ends at
    # phi = e / (1 + (r T)^2) and theta = -r T phi.
    U, r, T = 0.5, 0.2, 4.0
    imu = ideal(Imu, attitude_time=T, rates=(0, 0, r), acceleration=(0, U * r, 0))
    (solution,) = read(imu, 40.0, lambda ms: {}, ["roll_pitch"])
    assert solution[0].tolist() == [0.0, 0.0]
    phi = -U * r / G / (1 + (r * T) ** 2)
    # Steps of 10 ms: h / (2 T) of it.
    np.testing.assert_allclose(solution[-1], [phi, -r * T * phi], rtol=3e-3)


def test_a_bias_of_the_gyro_tilts_it_by_bias_times_time_constant():
    b, T = 0.002, 5.0
    imu = ideal(Imu, attitude_time=T, gyro_bias=(b, 0, 0))
    (solution,) = read(imu, 40.0, lambda ms: {}, ["roll_pitch"])
    # A step of 10 ms: b h / (1 - exp(-h / T)) exp(-h / T), b T to the first order of h / T.
    assert solution[-1][0] == pytest.approx(b * T, rel=2e-3)


def test_slow_rolling_is_followed_and_a_true_tilt_kept():
    T, w, a = 3.0, 0.8, 0.3

    def rolling(ms):
        t = ms / 1000
        return {"attitude": (a * math.sin(w * t), 0.1, 0), "rates": (a * w * math.cos(w * t), 0, 0)}

    imu = ideal(Imu, attitude_time=T, attitude=(0, 0.1, 0), rates=(a * w, 0, 0))
    (solution,) = read(imu, 30.0, rolling, ["roll_pitch"])
    times = np.arange(len(solution)) * 0.01
    np.testing.assert_allclose(solution[:, 0], a * np.sin(w * times), atol=2e-3)
    np.testing.assert_allclose(solution[:, 1], 0.1, atol=1e-3)


def test_a_tumbling_unit_knows_its_attitude_by_its_gyro():
    attitude, rates = np.array([0.5, -0.6, 1.0]), np.array([0.4, 0.3, -0.5])
    imu = ideal(Imu, period=1e-3, attitude_time=1e9, attitude=attitude, rates=rates)
    (solution,) = read(imu, 2.0, lambda ms: {}, ["roll_pitch"], step_ms=1)
    turned = Rotation.from_euler("ZYX", attitude[::-1]) * Rotation.from_rotvec(2.0 * rates)
    # Steps of Euler: h of it.
    np.testing.assert_allclose(solution[-1], turned.as_euler("ZYX")[:0:-1], atol=2e-3)


@pytest.mark.parametrize("attitude", [(0.7, 0.5, 1.0), (-2.5, -1.2, 0.0), (2.8, 0.3, -2.0)])
def test_any_tilt_at_rest_is_that_of_gravity(attitude):
    imu = ideal(Imu, attitude_time=1.0, attitude=attitude)
    (solution,) = read(imu, 3.0, lambda ms: {}, ["roll_pitch"])
    np.testing.assert_allclose(solution[-1], attitude[:2], atol=1e-12)


@pytest.mark.parametrize("kind", [Imu, Ahrs])
def test_members_of_one_axis_are_of_the_axis_that_their_name_says(kind):
    motion = {"rates": (0.1, 0.2, 0.3), "attitude": (0.4, 0.5, 0.6)}
    unit = ideal(kind, **{name: v for name, v in motion.items() if name in kind.ports})
    axes = {"roll_rate": 0.1, "yaw_rate": 0.3, "heel": 0.4, "pitch": 0.5, "heading": 0.6}
    for member, name in kind.terminals["reading"].members.items():
        if member in axes:
            port, _, axis = name.partition(".")
            value = unit.get(port)[kind.ports[port].axes.index(axis)]
            assert value == pytest.approx(axes[member]), member


def test_a_dead_gyro_does_not_reach_the_solution():
    imu = ideal(Imu, attitude_time=2.0, attitude=(0.2, 0, 0))
    (solution,) = read(
        imu, 3.0, lambda ms: {"fault": "off" if ms > 500 else "none"}, ["roll_pitch"]
    )
    np.testing.assert_allclose(solution[:, 0], 0.2, atol=1e-12)
