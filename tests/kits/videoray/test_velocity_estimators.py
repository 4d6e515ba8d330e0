"""Estimates of velocity against closed forms, and the filter against least squares over all data."""

import math

import numpy as np
import pytest

from seatrial.physics.craft.kinematics import to_body
from seatrial_kits.videoray.tracking.integrated_velocity import IntegratedVelocity
from seatrial_kits.videoray.tracking.velocity_filter import VelocityFilter

T, GRAVITY = 0.1, 9.81
LEVEL = (0.0, 0.0, -GRAVITY)


def estimates(component, rows, outputs, **values):
    """Return the outputs at samples with a dict of inputs each, flat."""
    for name, value in values.items():
        component.set(name, value)
    for name, value in rows[0].items():
        component.set(name, value)
    component.setup(0.0)
    component.initialise()
    component.begin()
    found = []
    for k, row in enumerate(rows):
        for name, value in row.items():
            component.set(name, value)
        found.append(np.hstack([component.get(name) for name in outputs]))
        component.advance(k * T, T)
    return np.array(found)


def integrated(rows, **values):
    return estimates(IntegratedVelocity("estimator"), rows, ["nu"], **{"average": T} | values)


def test_an_even_acceleration_of_a_tilted_vehicle_is_integrated():
    attitude, acceleration, offset = (0.1, -0.2, 0.7), (0.03, -0.02, 0.0), (0.4, 0.1, -0.2)
    gravity = to_body(attitude, (0.0, 0.0, GRAVITY))
    force = np.add(acceleration, offset) - gravity
    row = {"accelerometer": list(force), "euler": list(attitude)}
    found = integrated([row] * 50, offset=list(offset))
    t = T * np.arange(1, 51)
    np.testing.assert_allclose(found[:, 0], 0.03 * t, atol=1e-12)
    np.testing.assert_allclose(found[:, 1], -0.02 * t, atol=1e-12)
    assert not found[:, 2].any()


def test_a_velocity_over_ground_turns_back_as_the_axes_turn_across_north():
    """One push north, then none: in body axes (cos psi, -sin psi)."""
    rate = 0.3
    headings = np.remainder(-1.0 + rate * T * np.arange(60), math.tau)
    first = np.array([math.cos(headings[0]), -math.sin(headings[0])]) / T
    rows = [{"euler": [0.0, 0.0, psi], "accelerometer": list(LEVEL)} for psi in headings]
    rows[0]["accelerometer"] = [*first, -GRAVITY]
    found = integrated(rows)
    np.testing.assert_allclose(found[:, 0], np.cos(headings), atol=1e-12)
    np.testing.assert_allclose(found[:, 1], -np.sin(headings), atol=1e-12)
    np.testing.assert_allclose(found[1:, 2], rate, rtol=1e-12)


@pytest.mark.slow
def test_noise_of_the_acceleration_walks_away():
    """Standard deviation s sqrt(period t): 1,000 walks estimate it within 10 % (4.5 sigma)."""
    noise, steps, random = 0.024, 100, np.random.default_rng(5)
    ends = []
    for _ in range(500):
        rows = [
            {"euler": [0.0] * 3, "accelerometer": [*row, -GRAVITY]}
            for row in random.normal(0.0, noise, (steps, 2))
        ]
        ends.extend(integrated(rows)[-1, :2])
    assert np.std(ends) == pytest.approx(noise * math.sqrt(T * steps * T), rel=0.1)


def test_an_average_is_of_the_last_samples_and_invalid_readings_hold():
    row = {"accelerometer": [1.0, 0.0, -GRAVITY], "euler": [0.0] * 3, "imu_valid": True}
    found = integrated([row] * 10, average=0.3)
    each = T * np.arange(1, 11)
    wanted = [each[max(0, k - 2) : k + 1].mean() for k in range(10)]
    np.testing.assert_allclose(found[:, 0], wanted, rtol=1e-12)
    held = integrated([row] * 3 + [row | {"imu_valid": False}] * 3 + [row])
    np.testing.assert_allclose(held[:, 0], [0.1, 0.2, 0.3, 0.3, 0.3, 0.3, 0.4], rtol=1e-12)


NOISES = {
    "acceleration_noise": 0.05, "depth_noise": 0.02, "velocity_noise": 0.03,
    "acceleration_bias": 0.2, "acceleration_walk": 0.01, "heading_noise": 1e-7,
    "gyro_noise": 1e-7, "gyro_bias": 1e-7, "gyro_walk": 0.0,
}  # fmt: skip
"""With a heading that is known the filter is linear: its best estimate is least squares."""


def least_squares(force, depths, velocities):
    """Return velocity of the last instant and deviations: unknown are v, z, b of all instants."""
    steps, rows, values = len(depths), [], []

    def known(entries, value, deviation):
        row = np.zeros(7 * steps)
        for (k, i), factor in entries:
            row[7 * k + i] = factor / deviation
        rows.append(row)
        values.append(value / deviation)

    for i, (start, deviation) in enumerate(
        [(0.0, 0.1)] * 3 + [(depths[0], NOISES["depth_noise"])] + [(0.0, 0.2)] * 3
    ):
        known([((0, i), 1.0)], start, deviation)
    for k in range(steps):
        # The first depth is the start; it is a measurement from the second instant on.
        if k:
            known([((k, 3), 1.0)], depths[k], NOISES["depth_noise"])
        if velocities[k] is not None:
            for i in range(3):
                known([((k, i), 1.0)], velocities[k][i], NOISES["velocity_noise"])
        if k + 1 == steps:
            break
        a = np.add(force[k], (0.0, 0.0, GRAVITY))
        for i in range(3):
            of_velocity = [((k + 1, i), 1.0), ((k, i), -1.0), ((k, 4 + i), T)]
            known(of_velocity, T * a[i], T * NOISES["acceleration_noise"])
            of_bias = [((k + 1, 4 + i), 1.0), ((k, 4 + i), -1.0)]
            known(of_bias, 0.0, math.sqrt(T) * NOISES["acceleration_walk"])
        of_depth = [((k + 1, 3), 1.0), ((k, 3), -1.0), ((k, 2), -T), ((k, 6), T**2 / 2)]
        known(of_depth, T**2 / 2 * a[2], 1e-9)
    A = np.array(rows)
    x = np.linalg.lstsq(A, np.array(values), rcond=None)[0]
    root = np.linalg.inv(np.linalg.qr(A, mode="r"))
    return x[-7:-4], np.linalg.norm(root[-7:-5], axis=1)


@pytest.mark.parametrize("every", [1, 4])
def test_the_filter_is_least_squares_over_all_that_was_measured(every):
    random = np.random.default_rng(2)
    steps = 25
    force = np.add(LEVEL, random.normal(0.0, 0.05, (steps, 3)))
    depths = 3.0 + random.normal(0.0, 0.02, steps)
    log = [random.normal(0.0, 0.03, 3) if k % every == 0 else None for k in range(steps)]
    rows = [
        {
            "accelerometer": list(force[k]), "gyro": [0.0] * 3, "euler": [0.0] * 3,
            "depth": depths[k], "velocity_b": list(log[k - k % every]),
            "velocity_valid": True, "velocity_count": 1 + k // every,
        }
        for k in range(steps)
    ]  # fmt: skip
    found = estimates(VelocityFilter("filter"), rows, ["nu", "deviation"], **NOISES)
    velocity, deviation = least_squares(force, depths, log)
    np.testing.assert_allclose(found[-1, :2], velocity[:2], atol=2e-7)
    np.testing.assert_allclose(found[-1, 3:], deviation, rtol=1e-4)


def test_the_yaw_rate_loses_the_gyro_s_bias_across_north():
    bias, rate = 0.01, 0.2
    rows = [
        {
            "accelerometer": list(LEVEL), "gyro": [0.0, 0.0, rate + bias],
            "euler": [0.0, 0.0, (6.0 + rate * T * k) % math.tau], "depth": 3.0,
        }
        for k in range(600)
    ]  # fmt: skip
    found = estimates(VelocityFilter("filter"), rows, ["nu", "heading"], gyro_bias=0.02)
    assert found[0, 2] == pytest.approx(rate + bias)
    assert found[-1, 2] == pytest.approx(rate, abs=1e-4)
    off = np.remainder(found[:, 3] - [row["euler"][2] for row in rows] + math.pi, math.tau)
    assert np.abs(off - math.pi).max() < 5e-3


@pytest.mark.slow
def test_a_model_brings_the_velocity_to_where_thrust_is_drag():
    """At rest for the accelerometer: E (t1 + t2) = d u + q u^2 has u, and no sway comes of it."""
    row = {
        "accelerometer": list(LEVEL), "gyro": [0.0] * 3, "euler": [0.0, 0.0, 1.0], "depth": 3.0,
        "command": [0.06, 0.05], "model_valid": True,
    }  # fmt: skip
    model = {"mass": [8.0, 12.0], "damping": [1.0, 6.0], "quadratic_damping": [12.0, 30.0]}
    found = estimates(VelocityFilter("filter"), [row] * 3000, ["nu"], thrust=[40.0, 50.0], **model)
    u = (-1.0 + math.sqrt(1.0 + 4.0 * 12.0 * (0.06 * 40.0 + 0.05 * 50.0))) / (2.0 * 12.0)
    assert found[-1, 0] == pytest.approx(u, abs=2e-3)
    assert found[-1, 1] == pytest.approx(0.0, abs=1e-9)


def test_without_log_and_model_the_filter_says_that_it_does_not_know():
    """b t of an unknown bias: the deviation grows beyond it."""
    row = {
        "accelerometer": [0.05, 0.0, -GRAVITY], "gyro": [0.0] * 3, "euler": [0.0] * 3, "depth": 3.0
    }  # fmt: skip
    found = estimates(VelocityFilter("filter"), [row] * 300, ["nu", "deviation"])
    assert found[-1, 0] == pytest.approx(0.05 * 29.9, rel=1e-6)
    assert found[-1, 0] / 2 < found[-1, 3] < 2 * found[-1, 0]


def test_it_begins_with_the_first_valid_readings():
    rows = [
        {
            "accelerometer": list(LEVEL), "gyro": [0.0] * 3, "euler": [0.0, 0.0, 2.0 * (k >= 5)],
            "depth": 3.0 * (k >= 5), "imu_valid": k >= 5, "depth_valid": k >= 5,
        }
        for k in range(20)
    ]  # fmt: skip
    found = estimates(VelocityFilter("filter"), rows, ["nu", "heading"])
    assert not found[:, :3].any()
    np.testing.assert_allclose(found[5:, 3], 2.0, atol=1e-12)
