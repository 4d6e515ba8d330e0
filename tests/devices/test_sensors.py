"""Measurement of each sensor: IMU, compass, GNSS, depth."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from seatrial.devices.compass import Compass
from seatrial.devices.depth import Depth
from seatrial.devices.gnss import Gnss
from seatrial.devices.imu import Imu

from .ideal import ideal
from .running import run, started

DEG = math.radians(1.0)
angle = st.floats(-1.5, 1.5)
numbers = st.floats(-10, 10)
triples = st.tuples(numbers, numbers, numbers)
attitudes = st.tuples(angle, angle, st.floats(-7, 7))


def body_to_ned(attitude):
    """Another implementation of the rotation: SciPy's."""
    phi, theta, psi = attitude
    return Rotation.from_euler("ZYX", [psi, theta, phi])


@pytest.mark.parametrize("cls", [Imu, Compass, Gnss, Depth])
def test_defaults_publish_noisy_values_at_their_rate(cls):
    sensor = started(cls)
    rows = run(sensor, ["count", *(m.name for m in cls.measured)], 2000, 10)
    due = (2.0 - sensor.get("delay")) / sensor.get("period")
    assert rows[-1][0] == math.floor(due + 1e-9) + 1
    assert len({str(row[1:]) for row in rows}) > 4


# ------------------------------------------------------------------ IMU


def test_accelerometer_at_rest_reads_minus_gravity():
    assert ideal(Imu).get("accelerometer") == [0.0, 0.0, -9.81]


@given(attitudes, triples, triples)
def test_imu_against_an_independent_rotation(attitude, rates, acceleration):
    imu = ideal(Imu, attitude=attitude, rates=rates, acceleration=acceleration)
    weight = body_to_ned(attitude).inv().apply([0.0, 0.0, 9.81])
    assert imu.get("accelerometer") == pytest.approx(np.array(acceleration) - weight, abs=1e-12)
    assert imu.get("gyro") == list(rates)
    assert imu.get("roll_pitch") == list(attitude[:2])


def test_free_fall_is_weightless():
    attitude = (0.3, -0.4, 1.0)
    fall = body_to_ned(attitude).inv().apply([0.0, 0.0, 9.81])
    imu = ideal(Imu, attitude=attitude, acceleration=fall.tolist())
    assert imu.get("accelerometer") == pytest.approx([0, 0, 0], abs=1e-12)


def test_roll_to_starboard_tilts_the_specific_force_to_port():
    x, y, z = ideal(Imu, attitude=(0.1, 0.0, 0.0)).get("accelerometer")
    assert (x, y) == (0.0, pytest.approx(-9.81 * math.sin(0.1)))
    assert z == pytest.approx(-9.81 * math.cos(0.1))


# ------------------------------------------------------------------ compass


@given(st.floats(-50, 50))
def test_heading_is_a_compass_card(psi):
    heading = ideal(Compass, deviation=0.0, attitude=(0, 0, psi)).get("heading")
    assert 0.0 <= heading < math.tau
    assert math.cos(heading - psi) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("psi", [-1e-20, -1e-300, math.tau, -math.tau, 0.0])
def test_north_is_zero(psi):
    assert ideal(Compass, deviation=0.0, attitude=(0, 0, psi)).get("heading") == 0.0


def test_quantised_heading_just_west_of_north_is_north():
    compass = ideal(Compass, deviation=0.0, heading_resolution=DEG, attitude=(0, 0, -0.1 * DEG))
    assert compass.get("heading") == 0.0


@pytest.mark.parametrize("variation", [-15.0, 0.0, 10.0])
@pytest.mark.parametrize("magnetic", [0.0, 30.0, 90.0, 200.0, 315.0])
def test_mariners_rule(variation, magnetic):
    # true = compass + deviation + variation, deviation as of the magnetic heading
    b, c, d, e = 3.0, -2.0, 1.0, 0.5
    m = magnetic * DEG
    deviation = b * math.sin(m) + c * math.cos(m) + d * math.sin(2 * m) + e * math.cos(2 * m)
    true = (magnetic + variation) * DEG
    heading = ideal(
        Compass,
        variation=variation * DEG,
        deviation=[b * DEG, c * DEG, d * DEG, e * DEG],
        attitude=(0, 0, true),
    ).get("heading")
    back = heading + (deviation + variation) * DEG
    assert math.remainder(back - true, math.tau) == pytest.approx(0.0, abs=1e-12)


# ------------------------------------------------------------------ GNSS


@given(triples, attitudes, triples, triples, triples)
def test_gnss_reports_its_antenna(position, attitude, velocity, rates, antenna):
    gnss = ideal(
        Gnss,
        reception="everywhere",
        position=position,
        attitude=attitude,
        velocity=velocity,
        rates=rates,
        antenna=antenna,
    )
    R = body_to_ned(attitude)
    place = np.array(position) + R.apply(antenna)
    speed = R.apply(np.array(velocity) + np.cross(rates, antenna))
    assert gnss.get("position_n") == pytest.approx(place, abs=1e-11)
    assert gnss.get("velocity_n") == pytest.approx(speed, abs=1e-11)


def test_antenna_velocity_is_the_derivative_of_its_position():
    # Turning on the spot at 0.2 rad/s with the antenna 1 m ahead.
    def turned(t):
        return ideal(Gnss, antenna=(1, 0, 0), attitude=(0, 0, 0.2 * t), rates=(0, 0, 0.2))

    t, h = 0.7, 1e-3
    before, after = (np.array(turned(time).get("position_n")) for time in (t - h, t + h))
    assert turned(t).get("velocity_n") == pytest.approx((after - before) / (2 * h), abs=1e-8)


def test_data_sheet_accuracy_is_the_published_cep():
    # Half of all fixes within 2.5 m: CEP 50 %, over independent receivers.
    n = 1500
    inside = 0
    for seed in range(1, n + 1):
        north, east, _ = started(Gnss, seed=float(seed), delay=0.0).get("position_n")
        inside += math.hypot(north, east) < 2.5
    assert inside / n == pytest.approx(0.5, abs=3.9 * 0.5 / math.sqrt(n))


# ------------------------------------------------------------------ depth


@given(st.floats(0, 100), attitudes)
def test_depth_at_the_sensor(z, attitude):
    place = (0.5, -0.2, 0.3)
    depth = ideal(Depth, position=(7, 8, z), attitude=attitude, place=place).get("depth")
    below = z + body_to_ned(attitude).apply(place)[2]
    assert depth == pytest.approx(max(0.0, below), abs=1e-12)


def test_depth_in_lighter_water_than_assumed_reads_shallow():
    depth = ideal(Depth, density=1000.0, assumed_density=1025.0, position=(0, 0, 10.25))
    assert depth.get("depth") == pytest.approx(10.0)


def test_depth_out_of_the_water_is_zero():
    assert ideal(Depth, position=(0, 0, -3)).get("depth") == 0.0


@pytest.mark.parametrize("z", [0.3, 2.0, 10.0])
def test_depth_has_the_pressure_of_the_waves(z):
    height, period, direction = 0.4, 3.0, 0.7
    north, east = 5.0, -2.0
    values = {"sea_height": height, "sea_period": period, "sea_direction": direction}
    at = {"position": (north, east, z), "period": 0.1}
    one = ideal(Depth, sea_spectrum="regular", **values, **at)
    found = [row[0] for row in run(one, ["depth"], 4000, 100)]
    # Airy in deep water, with the depth from the surface there (Wheeler).
    omega = math.tau / period
    k = omega**2 / 9.81
    along = north * math.cos(direction) + east * math.sin(direction)
    wave = 0.5 * height * np.cos(omega * 0.1 * np.arange(41) - k * along)
    assert found == pytest.approx(z + wave * np.exp(-k * (z + wave)), abs=1e-9)


def test_depth_at_the_crest_and_in_the_trough_is_none():
    for t_ms, elevation in ((0, 0.2), (1500, -0.2)):
        at = {"position": (0.0, 0.0, -elevation), "period": 1.5}
        one = ideal(Depth, sea_spectrum="regular", sea_height=0.4, sea_period=3.0, **at)
        assert run(one, ["depth"], t_ms, 1500)[-1][0] == pytest.approx(0.0, abs=1e-9)


def test_reflections_are_correlated_over_their_time():
    period, T, size = 0.2, 1.0, 1.5
    gnss = ideal(Gnss, multipath=(size, 0, 0), multipath_time=T, seed=3.0)
    north = np.array([row[0][0] for row in run(gnss, ["position_n"], 800_000, 200)])
    # 800 s are some 400 independent values, each of variance s^2: 6 % of it.
    assert north.std() == pytest.approx(size, rel=0.2)
    lag = round(T / period)
    share = np.mean(north[:-lag] * north[lag:]) / north.var()
    assert share == pytest.approx(math.exp(-1), abs=0.12)
    assert [ideal(Gnss, multipath=(size, 0, 0)).get("position_n")[i] for i in (1, 2)] == [0.0, 0.0]


def test_a_receiver_that_has_surfaced_takes_its_time():
    gnss = ideal(Gnss, reacquisition=3.0)

    def diving(ms):
        return {"position": (0, 0, 1.0 if 1000 <= ms < 2000 else -1.0)}

    rows = run(gnss, ["valid"], 8000, 200, diving)
    lost = [200 * i for i, (valid,) in enumerate(rows) if not valid]
    assert lost == list(range(1000, 4801, 200))  # under water up to 1800 ms, then 3 s
