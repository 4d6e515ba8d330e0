"""The attitude and acceleration of the VideoRay Pro 4 against [Paulino2015], table 7.1."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.devices.ahrs import Ahrs
from seatrial.devices.depth import Depth
from seatrial.system.profile.profile import load_profile
from tests.kit import needs_kits

from .running import run, started

DEG = math.radians(1.0)
angles = st.tuples(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-9, 9))
triples = st.tuples(*[st.floats(-10, 10)] * 3)
ERRORS = ("euler_noise", "euler_resolution", "accelerometer_noise", "accelerometer_resolution")
PERFECT = dict.fromkeys(ERRORS, 0.0)
pytestmark = needs_kits("videoray")


@cache
def profile():
    return load_profile("videoray")


def readings(attitudes, **values):
    """Return (attitude, minus specific force), the signs of [Paulino2015], as read at 10 Hz."""
    values = {**profile().parameters("sensors.ahrs"), **values}
    rows = run(
        started(Ahrs, **values),
        ["euler", "accelerometer"],
        100 * (len(attitudes) - 1),
        100,
        lambda t_ms: {"attitude": attitudes[t_ms // 100]},
    )
    return np.array([row[0] for row in rows]), -np.array([row[1] for row in rows])


@given(angles, triples)
def test_reading_is_the_acceleration_less_gravity(attitude, acceleration):
    phi, theta, psi = attitude
    gravity = Rotation.from_euler("ZYX", [psi, theta, phi]).inv().apply([0, 0, 9.81])
    ahrs = started(Ahrs, **PERFECT, attitude=attitude, acceleration=acceleration)
    expected = np.array(acceleration) - gravity
    np.testing.assert_allclose(ahrs.get("accelerometer"), expected, rtol=0, atol=1e-13)


def test_free_fall_reads_nothing():
    fall = {"attitude": (0.0, 0.0, 1.0), "acceleration": (0.0, 0.0, 9.81)}
    assert started(Ahrs, **PERFECT, **fall).get("accelerometer") == [0.0, 0.0, 0.0]


@given(angles)
def test_attitude_is_sent_with_a_compass_card_and_half_circles_of_roll(attitude):
    phi, theta, psi = started(Ahrs, **PERFECT, attitude=attitude).get("euler")
    assert theta == attitude[1]
    assert 0.0 <= psi < math.tau
    assert -math.pi < phi <= math.pi
    for found, true in ((phi, attitude[0]), (psi, attitude[2])):
        assert math.cos(found - true) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("turns", [-2, 0, 1])
@pytest.mark.parametrize(
    ("psi", "tenths"), [(-0.04, 0), (359.96, 0), (359.94, 3599), (0.04, 0), (0.06, 1), (180, 1800)]
)
def test_heading_counts_tenths_of_a_degree_from_0_to_3599(psi, tenths, turns):
    attitude = (0.0, 0.0, (psi + 360 * turns) * DEG)
    heading = started(Ahrs, euler_noise=0.0, attitude=attitude).get("euler")[2]
    assert heading / (0.1 * DEG) == pytest.approx(tenths, abs=1e-6)


# ---------------------------------------------------------------------- table 7.1

N = 4000
# Of an estimate from N samples: five times its standard error.
MEAN_OF, DEVIATION_OF = 5 / math.sqrt(N), 5 / math.sqrt(2 * N)
# Angles in degrees, accelerations in cm/s2: (mean, standard deviation) as printed.
DRY = {"phi": (3.68, 0.1342), "theta": (-1.2, 0.0), "u": (21.0, 0.0), "v": (64.1, 1.789)}
POOL = {
    "phi": (4.74, 0.5404),
    "theta": (-0.07, 0.4393),
    "u": (1.2, 7.906),
    "v": (82.3, 9.386),
    "w": (988.8, 4.266),
}


def rocking(statistics):
    """Return attitudes of a vehicle that rolls and pitches at random about a mean."""
    rng = np.random.default_rng(71)
    phi, theta = (
        rng.normal(*statistics[axis], size=N) * DEG if axis in statistics else np.zeros(N)
        for axis in ("phi", "theta")
    )
    return np.column_stack([phi, theta, np.full(N, 46.11 * DEG)]).tolist()


@pytest.mark.slow
def test_a_dry_vehicle_reads_gravity_as_what_the_source_took_for_offsets():
    attitude = (DRY["phi"][0] * DEG, DRY["theta"][0] * DEG, 193.96 * DEG)
    euler, acceleration = readings([attitude] * N)
    u, v, w = 100 * acceleration.mean(axis=0)
    # 20.5 and 63.0 cm/s2 of gravity for the 21 and 64.1 of the table: its attitude is read to
    # 0.1 degrees, which is 1.7 cm/s2.
    assert u == pytest.approx(20.5, abs=0.1)
    assert v == pytest.approx(63.0, abs=0.1)
    assert abs(u - DRY["u"][0]) < 1.7
    assert abs(v - DRY["v"][0]) < 1.7
    assert w == pytest.approx(987.4, rel=0.01)  # 978.8; the table's scale is 0.9 % high
    # Noise and quantum; one sample in 3 of pitch falls on the next tenth.
    noise = np.array(profile().parameters("sensors.ahrs")["euler_noise"]) / DEG
    expected = np.hypot(noise, 0.1 / math.sqrt(12))
    np.testing.assert_allclose(euler.std(axis=0) / DEG, expected, rtol=0.1)


@pytest.mark.slow
def test_a_rocking_vehicle_reads_gravity_as_what_the_source_took_for_a_disturbance():
    _, acceleration = readings(rocking(POOL))
    found_mean, found = 100 * acceleration.mean(axis=0), 100 * acceleration.std(axis=0)
    leak = np.array([981 * math.sin(POOL[axis][1] * DEG) for axis in ("theta", "phi")])
    np.testing.assert_allclose(leak, [7.52, 9.25], rtol=0, atol=0.005)
    for axis, name in enumerate("uvw"):
        mean, deviation = POOL[name]
        # What the table has, within the error of an estimate and 2 % of its own.
        assert found[axis] == pytest.approx(deviation, rel=DEVIATION_OF + 0.02), name
        # 1.1 to 1.5 % between the table's scale and 981 cm/s2.
        assert abs(found_mean[axis] - mean) < 0.015 * mean + deviation * MEAN_OF, name


@pytest.mark.slow
def test_gravity_taken_off_with_the_measured_attitude_leaves_the_noise():
    euler, acceleration = readings(rocking(POOL))
    gravity = np.array(
        [Rotation.from_euler("ZYX", row[::-1]).inv().apply([0, 0, 9.81]) for row in euler]
    )
    left = 100 * (acceleration - gravity).std(axis=0)
    # Noise of the accelerometer, its quantum, and gravity's share of the attitude's errors.
    attitude_error = 981 * np.hypot([0.05, 0.134], 0.1 / math.sqrt(12)) * DEG
    expected = np.sqrt(np.array([2.4, 1.6]) ** 2 + 1 / 12 + attitude_error**2)
    np.testing.assert_allclose(left[:2], expected, rtol=DEVIATION_OF)
    assert left[1] < 0.35 * POOL["v"][1]


def test_depth_of_a_vehicle_at_rest_has_the_noise_of_the_table():
    values = profile().parameters("sensors.depth")
    assert values["depth_noise"] == pytest.approx(0.122e-2, rel=0.02)
    sensor = started(Depth, **values)
    rows = run(sensor, ["depth"], 100 * (N - 1), 100, lambda _: {"position": (0, 0, 2.005)})
    centimetres = np.array(rows).ravel() * 100
    np.testing.assert_allclose(centimetres, np.round(centimetres), rtol=0, atol=1e-9)
    # Half-way between two readings noise takes the one or the other.
    assert set(np.round(centimetres)) == {200.0, 201.0}
    assert centimetres.mean() == pytest.approx(200.5, abs=0.5 * MEAN_OF)
