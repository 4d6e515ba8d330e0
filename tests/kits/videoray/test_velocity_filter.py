"""The velocity filter at random attitudes beside an extended Kalman filter by differences."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.videoray.tracking.velocity_filter import VelocityFilter
from tests.devices.running import over, started

T, G, STEPS = 0.1, 9.7, 40
NOISE = {
    "acceleration_noise": 0.07, "gyro_noise": 0.004, "heading_noise": 0.006, "depth_noise": 0.03,
    "velocity_noise": 0.02, "model_noise": 0.05, "model_time": 1.7, "acceleration_bias": 0.11,
    "acceleration_walk": 0.013, "gyro_bias": 0.02, "gyro_walk": 0.003,
}  # fmt: skip
MODEL = {
    "mass": (11.0, 14.0), "damping": (2.0, 5.0), "quadratic_damping": (7.0, 13.0),
    "thrust": (6.0, 4.0),
}  # fmt: skip


def into_ned(euler, psi):
    return Rotation.from_euler("ZYX", [psi, euler[1], euler[0]]).as_matrix()


def slopes(function, x):
    """Return the Jacobian by central differences."""
    h = 1e-6
    columns = [(function(x + h * e) - function(x - h * e)) / (2 * h) for e in np.eye(len(x))]
    return np.array(columns).T


class Filter:
    """Textbook extended Kalman filter of v in {n}, z, psi and the biases."""

    def __init__(self, depth, psi):
        self.x = np.array([0, 0, 0, depth, psi, 0, 0, 0, 0], dtype=float)
        spread = [0.1] * 3 + [NOISE["depth_noise"], NOISE["heading_noise"]]
        spread += [NOISE["acceleration_bias"]] * 3 + [NOISE["gyro_bias"]]
        self.P = np.diag(np.square(spread))

    def measure(self, function, value, deviation, wrap=False):
        H, off = slopes(function, self.x), value - function(self.x)
        if wrap:
            off = np.array([math.remainder(off[0], math.tau)])
        V = deviation**2 * np.eye(len(off))
        gain = self.P @ H.T @ np.linalg.inv(H @ self.P @ H.T + V)
        self.x, self.P = self.x + gain @ off, (np.eye(9) - gain @ H) @ self.P

    def go_on(self, euler, force, gyro):
        def later(x):
            a = into_ned(euler, x[4]) @ (force - x[5:8]) + [0, 0, G]
            turn = gyro[1] * math.sin(euler[0]) + (gyro[2] - x[8]) * math.cos(euler[0])
            sink = x[3] + T * x[2] + T**2 / 2 * a[2]
            return np.array([*(x[:3] + T * a), sink, x[4] + T * turn / math.cos(euler[1]), *x[5:]])

        self.predict(later)

    def wait(self):
        self.predict(lambda x: x + T * np.array([0, 0, 0, x[2], 0, 0, 0, 0, 0]))

    def predict(self, later):
        walks = T * np.square([NOISE["acceleration_walk"]] * 3 + [NOISE["gyro_walk"]])
        shaken, turned = (T * NOISE[f"{n}_noise"] for n in ("acceleration", "gyro"))
        F = slopes(later, self.x)
        self.x = later(self.x)
        self.P = F @ self.P @ F.T + np.diag([*[shaken**2] * 3, 0, turned**2, *walks])


@pytest.mark.parametrize("modelled", [False, True])
def test_a_filter_at_random_attitudes_is_an_extended_kalman_filter(modelled):
    draw = np.random.default_rng(4)
    euler = np.array([0.3, -0.4, 3.0]) + np.cumsum(draw.normal(0, 0.05, (STEPS, 3)), axis=0)
    gyro, depth = draw.normal(0, 0.3, (STEPS, 3)), 5.0 + draw.normal(0, 0.05, STEPS)
    force = np.array([into_ned(e, e[2]).T @ [0, 0, -G] for e in euler])
    force += draw.normal(0, 0.5, (STEPS, 3))
    log, commands = draw.normal(0, 0.5, (STEPS, 3)), draw.uniform(-1, 1, (STEPS, 2))
    readings, lost = np.cumsum(draw.random(STEPS) < 0.4), draw.random(STEPS) < 0.15
    sunk = draw.random(STEPS) < 0.8
    rows = [
        {
            "euler": [*euler[k, :2], math.remainder(euler[k, 2], math.tau)], "gyro": gyro[k],
            "accelerometer": force[k], "depth": depth[k], "velocity_b": log[k],
            "velocity_valid": True, "velocity_count": int(readings[k]), "command": commands[k],
            "imu_valid": bool(k == 0 or not lost[k]), "depth_valid": bool(k == 0 or sunk[k]),
            "model_valid": modelled,
        }
        for k in range(STEPS)
    ]  # fmt: skip
    found = over(
        started(VelocityFilter, period=T, gravity=G, **NOISE, **MODEL, **rows[0]),
        ["nu", "deviation", "heading"], T, rows,
    )  # fmt: skip
    kalman, seen, u, v = Filter(depth[0], rows[0]["euler"][2]), 0, 0.0, 0.0
    for k, row in enumerate(rows):

        def body(x, e=euler[k]):
            return into_ned(e, x[4]).T @ x[:3]

        if k and row["imu_valid"]:
            kalman.measure(lambda x: x[4:5], euler[k, 2:], NOISE["heading_noise"], wrap=True)
        if k and row["depth_valid"]:
            kalman.measure(lambda x: x[3:4], depth[k : k + 1], NOISE["depth_noise"])
        if readings[k] != seen:
            kalman.measure(body, log[k], NOISE["velocity_noise"])
        if modelled:
            spread = NOISE["model_noise"] * math.sqrt(NOISE["model_time"] / T)
            kalman.measure(lambda x, b=body: b(x)[:2], np.array([u, v]), spread)
        seen, r = readings[k], (gyro[k, 2] if row["imu_valid"] else 0.0) - kalman.x[8]
        J = slopes(body, kalman.x)[:2, :3]
        spread = np.sqrt(np.diag(J @ kalman.P[:3, :3] @ J.T))
        expected = [*body(kalman.x)[:2], r, *spread, kalman.x[4] % math.tau]
        np.testing.assert_allclose(found[k], expected, atol=2e-7)
        if modelled:
            turn = r if row["imu_valid"] else 0.0
            X = 6.0 * commands[k, 0] + 4.0 * commands[k, 1]
            ahead = (X - 2.0 * u - 7.0 * abs(u) * u + 14.0 * v * turn) / 11.0
            abeam = (-5.0 * v - 13.0 * abs(v) * v - 11.0 * u * turn) / 14.0
            u, v = u + T * ahead, v + T * abeam
        if row["imu_valid"]:
            kalman.go_on(euler[k], force[k], gyro[k])
        else:
            kalman.wait()
