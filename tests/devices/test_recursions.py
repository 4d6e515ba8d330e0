"""Sensors and wind over random inputs, settings all unequal, beside the recursion of their equations."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.devices.compass import Compass
from seatrial.devices.depth import Depth
from seatrial.devices.gnss import Gnss
from seatrial.devices.imu import Imu
from seatrial.devices.marks import Marks
from seatrial.physics.environment.wind import Wind

from .ideal import ideal
from .probe import Probe
from .running import over, run, started

STEPS = 40


def test_a_measurement_is_the_truth_with_its_errors():
    noise, bias, slow, step = (
        np.array(v) for v in ([0.3, 0.7], [0.5, -0.2], [0.4, 0.9], [0.05, 0.2])
    )
    probe = started(
        Probe, period=0.1, y_noise=noise, y_bias=bias, y_instability=slow, y_resolution=step,
        correlation_time=0.6, dropout=0.25, seed=3.0,
    )  # fmt: skip
    truth = np.random.default_rng(1).normal(size=(STEPS, 2))
    found = over(probe, ["y", "count", "valid"], 0.1, [{"truth": each} for each in truth])
    kept, walk, shown, count = math.exp(-0.1 / 0.6), None, np.zeros(2), 0
    for k, x in enumerate(truth):
        drawn = probe.generator(k)
        lost, white, fresh = drawn.random() < 0.25, drawn.normal(size=2), drawn.normal(size=2)
        walk = slow * fresh if walk is None else kept * walk + slow * math.sqrt(1 - kept**2) * fresh
        if not lost:
            count, shown = count + 1, step * np.round((x + bias + walk + noise * white) / step)
        np.testing.assert_allclose(found[k], [*shown, count, not lost], atol=1e-12)
    assert 0 < count < STEPS


def test_a_unit_off_the_origin_differs_its_rates_from_the_first_sample_on():
    h, place = 0.02, np.array([0.4, -0.3, 0.2])
    rates = np.random.default_rng(2).normal(size=(6, 3))
    unit = ideal(Imu, period=h, place=place, gravity=0.0, rates=rates[0])
    found = over(unit, ["accelerometer"], h, [{"rates": each} for each in rates])
    slopes = [np.zeros(3), (rates[1] - rates[0]) / h]
    # Of the parabola through three samples.
    slopes += [
        (3 * c - 4 * b + a) / (2 * h) for a, b, c in zip(rates, rates[1:], rates[2:], strict=False)
    ]
    expected = [
        np.cross(slope, place) + np.cross(w, np.cross(w, place))
        for slope, w in zip(slopes, rates, strict=True)
    ]
    np.testing.assert_allclose(found, expected, atol=1e-10)


def test_an_attitude_solution_turns_with_the_gyro_and_leans_on_gravity():
    h, T, draw = 0.05, 1.7, np.random.default_rng(3)
    rates, attitudes = draw.normal(0, 0.6, (STEPS, 3)), draw.uniform(-0.9, 0.9, (STEPS, 3))
    pushes = draw.normal(0, 2.0, (STEPS, 3))
    unit = ideal(Imu, period=h, attitude_time=T, attitude=attitudes[0])
    rows = [
        {"rates": w, "attitude": a, "acceleration": f}
        for w, a, f in zip(rates, attitudes, pushes, strict=True)
    ]
    found = over(unit, ["roll_pitch"], h, rows)
    phi, theta = attitudes[0][:2]
    for k, (w, attitude, push) in enumerate(zip(rates, attitudes, pushes, strict=True)):
        np.testing.assert_allclose(found[k], [phi, theta], atol=1e-12)
        x, y, z = push - 9.81 * Rotation.from_euler("ZYX", attitude[::-1]).as_matrix()[2]
        turn = np.array(
            [[1, math.sin(phi) * math.tan(theta), math.cos(phi) * math.tan(theta)],
             [0, math.cos(phi), -math.sin(phi)]]
        ) @ w  # fmt: skip
        phi, theta = np.array([phi, theta]) + h * turn
        lean = 1 - math.exp(-h / T)
        phi += lean * math.remainder(math.atan2(-y, -z) - phi, math.tau)
        theta += lean * (math.atan2(x, math.hypot(y, z)) - theta)


def test_reflections_are_a_slow_error_of_the_position():
    size, h, T = np.array([0.5, 0.9, 1.3]), 0.2, 1.1
    gnss = ideal(Gnss, period=h, multipath=size, multipath_time=T, reception="everywhere", seed=7.0)
    found = over(gnss, ["position_n"], h, [{}] * STEPS)
    kept, off = math.exp(-h / T), None
    for k, shown in enumerate(found):
        drawn = size * gnss.generator(k, 3).normal(size=3)
        off = drawn if off is None else kept * off + math.sqrt(1 - kept**2) * drawn
        np.testing.assert_allclose(shown, off, atol=1e-12)


def test_an_antenna_swings_and_is_wet_where_it_is():
    attitude, antenna = np.array([0.4, -0.3, 2.0]), np.array([0.6, -0.4, -0.5])
    R = Rotation.from_euler("ZYX", attitude[::-1]).as_matrix()
    velocity, rates, below = (
        np.array([1.2, -0.4, 0.3]),
        np.array([0.2, -0.5, 0.7]),
        (R @ antenna)[2],
    )
    for depth, wet in ((-below - 0.01, False), (-below + 0.01, True)):
        gnss = ideal(
            Gnss, antenna=antenna, attitude=attitude, velocity=velocity, rates=rates,
            position=[5.0, -8.0, depth],
        )  # fmt: skip
        assert gnss.get("valid") is not wet
        if not wet:
            place = np.array([5.0, -8.0, depth]) + R @ antenna
            np.testing.assert_allclose(gnss.get("position_n"), place, atol=1e-12)
            swung = R @ (velocity + np.cross(rates, antenna))
            np.testing.assert_allclose(gnss.get("velocity_n"), swung, atol=1e-12)


@pytest.mark.parametrize("psi", [0.3, 2.0, 3.9, 5.7])
def test_a_needle_is_turned_by_variation_and_four_coefficients(psi):
    B, C, D, E = deviation = 0.03, -0.05, 0.02, 0.04
    compass = ideal(Compass, variation=0.11, deviation=deviation, attitude=(0.0, 0.0, psi))
    m = psi - 0.11
    off = np.imag(B * np.exp(1j * m) + D * np.exp(2j * m))
    off += np.real(C * np.exp(1j * m) + E * np.exp(2j * m))
    assert compass.get("heading") == pytest.approx((m - off) % math.tau, rel=1e-12)


def test_pressure_is_read_with_another_density_where_the_sensor_is():
    attitude, place = np.array([0.4, -0.3, 2.0]), np.array([0.6, -0.4, 0.5])
    arm = (Rotation.from_euler("ZYX", attitude[::-1]).as_matrix() @ place)[2]
    values = {"density": 1030.0, "assumed_density": 990.0, "place": place, "attitude": attitude}
    for z, below in ((2.0, 2.0 + arm), (-2.0, 0.0)):
        depth = ideal(Depth, **values, position=[3.0, 4.0, z])
        assert depth.get("depth") == pytest.approx(1030 / 990 * below)


@pytest.mark.parametrize(("age", "off"), [(9.5, 3.8), (10.5, 0.0)])
def test_a_track_is_remembered_for_ten_seconds(age, off):
    marks = started(Marks, count=1.0, radius=2.0, estimated=True, period=0.5)
    rows = [
        {
            "position": (3.0 * t, -2.0 * t, 1.0),
            "estimate_time": t - age,
            "estimate": (3.0 * (t - age) + 3.8, -2.0 * (t - age), 0.0),
        }
        for t in 0.5 * np.arange(60)
    ]
    assert over(marks, ["error"], 0.5, rows)[-1, 0] == pytest.approx(off)


def test_gusts_are_two_sequences_of_gauss_and_markov():
    wind = started(
        Wind, mean_speed=7.0, mean_direction=0.4, intensity=0.3, direction_deviation=0.2,
        period=0.5, correlation_time=2.0, gust_size=0.6, gust_start=3.2, gust_duration=5.0, seed=5.0,
    )  # fmt: skip
    found = run(wind, ["speed", "direction", "velocity"], 10_000, 500)
    kept, gust = math.exp(-0.25), None
    for k, (speed, direction, velocity) in enumerate(found):
        drawn = wind.generator(k).normal(size=2)
        gust = drawn if gust is None else kept * gust + math.sqrt(1 - kept**2) * drawn
        passed = (0.5 * k - 3.2) / 5.0
        bump = 0.3 * (1 - math.cos(math.tau * passed)) if 0 < passed < 1 else 0.0
        expected = 7.0 * max(0.0, 1 + 0.3 * gust[0] + bump)
        assert speed == pytest.approx(expected, rel=1e-12)
        assert direction == pytest.approx(0.4 + 0.2 * gust[1], rel=1e-12)
        assert complex(*velocity) == pytest.approx(speed * np.exp(1j * direction), rel=1e-12)


def test_a_wind_of_the_trial_is_met_at_its_height():
    trial = {"wind_speed": 9.0, "wind_direction": 2.5, "wind_profile": "power"}
    wind = started(Wind, **trial, height=3.0, intensity=0.5)
    speed = 9.0 * 0.3**0.12
    assert wind.get("speed") == pytest.approx(speed)
    assert wind.get("direction") == 2.5
    assert complex(*wind.get("velocity")) == pytest.approx(speed * np.exp(2.5j))


def test_noise_that_is_stated_for_a_bandwidth_is_a_share_of_it_in_samples():
    unit = ideal(Imu, period=0.02, gyro_noise=(0.1, 0.2, 0.4), gyro_bandwidth=8.0, seed=4.0)
    found = over(unit, ["gyro"], 0.02, [{}] * 20)
    share = 1 / math.sqrt(2 * 0.02 * 8.0)
    for k, shown in enumerate(found):
        drawn = unit.generator(k)
        drawn.random()  # whether the measurement is lost
        np.testing.assert_allclose(shown, [0.1, 0.2, 0.4] * drawn.normal(size=8)[:3] * share)


def test_an_intermittent_sensor_loses_what_its_draw_says():
    probe = started(Probe, period=0.1, fault="intermittent", truth=(3.0, 4.0))
    found = over(probe, ["valid"], 0.1, [{}] * 30)[:, 0]
    drawn = [probe.generator(k, 1).random() for k in range(30)]
    np.testing.assert_array_equal(found, np.array(drawn) >= 0.5)


def test_a_fault_of_one_output_knows_the_time_of_a_run_that_began_late():
    probe = Probe("probe")
    probe.set("period", 0.1)
    probe.set("fault", "drift of=y rate=2.0 at=5.25")
    probe.setup(5.0)
    probe.initialise()
    probe.begin()
    found = []
    for k in range(8):
        found.append(probe.get("y")[0])
        probe.advance(5.0 + 0.1 * k, 0.1)
    t = 5.0 + 0.1 * np.arange(8)
    # It is there from the first measurement on: its time is that of its beginning.
    expected = 2.0 * np.maximum(t - 5.25, 0.0)
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize(("surfacing", "samples"), [(0.75, 4), (0.6, 3)])
def test_a_fix_comes_a_time_after_surfacing(surfacing, samples):
    gnss = ideal(Gnss, period=0.2, reacquisition=surfacing, position=(0.0, 0.0, 1.0))
    rows = [{"position": (0.0, 0.0, 1.0 if k < 3 else -1.0)} for k in range(12)]
    found = over(gnss, ["valid"], 0.2, rows)[:, 0]
    np.testing.assert_array_equal(found, np.arange(12) >= 3 + samples)


@pytest.mark.parametrize("name", ["gyro", "accelerometer", "roll_pitch"])
def test_a_fault_of_one_output_leaves_the_others(name):
    motion = {"rates": (0.1, 0.2, 0.3), "attitude": (0.2, -0.1, 1.0), "period": 0.1}
    values = "0.5,0.25" if name == "roll_pitch" else "0.5,0.25,0.125"
    plain, faulty = ideal(Imu, **motion), ideal(Imu, **motion)
    faulty.set("fault", f"bias of={name} value={values} at=0.0")
    for unit in (plain, faulty):
        unit.advance(0.0, 0.1)
    for each in ("gyro", "accelerometer", "roll_pitch"):
        off = np.subtract(faulty.get(each), plain.get(each))
        expected = np.array([0.5, 0.25, 0.125][: len(off)]) * (each == name)
        np.testing.assert_allclose(off, expected, atol=1e-12, err_msg=each)
