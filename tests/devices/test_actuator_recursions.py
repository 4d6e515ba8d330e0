"""Actuators and a battery over random inputs, settings all unequal, beside the recursion of their equations."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.devices.actuators import t200
from seatrial.devices.actuators.angle_servo import AngleServo
from seatrial.devices.actuators.motor import Motor
from seatrial.devices.actuators.polynomial_thruster import PolynomialThruster
from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.devices.actuators.servo import Servo
from seatrial.devices.actuators.shaft_propeller import ShaftPropeller
from seatrial.devices.actuators.thruster import Thruster
from seatrial.devices.battery import Battery

from .running import over, started

STEPS = 40


def shares(seed, low=-1.3, high=1.3):
    return np.random.default_rng(seed).uniform(low, high, STEPS)


@pytest.mark.parametrize("reverse", [0.0, 1.0])
@pytest.mark.parametrize(("fault", "slower"), [("none", 1), ("slow", 10)])
def test_a_servo_turns_from_frame_to_frame(reverse, fault, slower):
    low, neutral, high, band, rate, h = 1.02e-3, 1.45e-3, 2.01e-3, 3e-5, 17.0, 0.025
    servo = started(
        Servo, pulse_min=low, pulse_neutral=neutral, pulse_max=high, dead_band=band, rate=rate,
        angle_min=-0.4, angle_max=1.1, angle_start=0.2, period=h, reversed=reverse,
    )  # fmt: skip
    pulses = np.repeat(1.5e-3 + 0.6e-3 * shares(4, -1, 1), 3)
    found = over(servo, ["angle"], h, [{"pulse": each, "fault": fault} for each in pulses])[:, 0]
    angle = 0.2
    for k, width in enumerate(pulses):
        assert found[k] == pytest.approx(angle, abs=1e-12)
        share = (width - neutral) / (high - neutral if width > neutral else neutral - low)
        share = min(max(share, -1), 1) * (-1 if reverse else 1)
        off = 0.35 + 0.75 * share - angle
        rest = max(0.0, abs(off) - band * 1.5 / (high - low))
        angle += math.copysign(min(rest, rate * h / slower), off)
    assert slower > 1 or (found.min() < -0.25 and found.max() > 0.95)


@pytest.mark.parametrize(
    ("fault", "slower", "off"), [("none", 1, 0), ("slow", 10, 0), ("wrong", 1, 0.15)]
)
def test_an_angle_servo_moves_at_once_as_far_as_it_can(fault, slower, off):
    servo = started(
        AngleServo, angle_min=-0.4, angle_max=1.1, angle_start=0.2, rate=3.0, period=0.05
    )
    servo.set("fault", fault)
    commands = 0.3 + shares(5)
    found = over(servo, ["angle", "speed"], 0.05, [{"command": each} for each in commands])
    angle = 0.2
    for k, command in enumerate(commands):
        wanted = min(min(max(command, -0.4), 1.1) + off, 1.1)
        move = min(max(wanted - angle, -0.15 / slower), 0.15 / slower)
        angle += move
        assert found[k] == pytest.approx((angle, move / 0.05), abs=1e-12)


SHAFT = {"time_constant": 0.3, "thrust_coefficient_ahead": 0.02}
SHAFT |= {"thrust_coefficient_astern": 0.013, "speed_ahead": 70.0, "speed_astern": 45.0}


@pytest.mark.parametrize(
    ("fault", "slower", "left"), [("none", 1, 1), ("slow", 10, 1), ("wrong", 1, 0.5)]
)
def test_a_shaft_follows_and_its_propeller_pushes_by_the_square(fault, slower, left):
    propeller, h = started(ShaftPropeller, **SHAFT, speed_start=12.0), 0.07
    commands, n = shares(6), 12.0
    rows = [{"command": each, "fault": fault} for each in commands]
    found = over(propeller, ["speed", "thrust"], h, rows)
    for k, command in enumerate(commands):
        thrust = (0.02 if n > 0 else 0.013) * n * abs(n) * (left if k else 1)
        np.testing.assert_allclose(found[k], [n, thrust], atol=1e-10)
        goal = min(max(command, -1), 1) * (70.0 if command > 0 else 45.0)
        n = goal + (n - goal) * math.exp(-h / (0.3 * slower))


@pytest.mark.parametrize(
    ("fault", "lag", "left"), [("none", 0.25, 1), ("slow", 2.5, 1), ("wrong", 0.25, 0.5)]
)
def test_a_motor_follows_its_limited_command(fault, lag, left):
    motor, h, y = started(Motor, time_constant=0.25), 0.06, 0.0
    commands = shares(7)
    found = over(motor, ["order"], h, [{"command": each, "fault": fault} for each in commands])
    for k, command in enumerate(commands):
        assert found[k, 0] == pytest.approx(y, abs=1e-12)
        goal = left * min(max(command, -1), 1)
        y = goal + (y - goal) * math.exp(-h / lag)


def test_a_motor_without_lag_is_at_once_and_a_slow_one_has_a_second():
    motor = started(Motor, command=0.7)
    assert motor.get("order") == 0.7
    motor.set("fault", "slow")
    motor.advance(0.0, 0.5)
    assert motor.get("order") == pytest.approx(0.7 * (1 - math.exp(-0.5)))


@pytest.mark.parametrize(
    ("fault", "slower", "left"), [("none", 1, 1), ("slow", 10, 1), ("wrong", 1, 0.5)]
)
def test_a_polynomial_thruster_is_its_transfer_function(fault, slower, left):
    poles, zero, curve, h = (9000.0, 1900.0, 60.0), 70.0, (8.0, 150.0, -310.0, 290.0, -99.0), 0.02
    thruster = started(PolynomialThruster, lag_poles=poles, lag_zero=zero, thrust_curve=curve)
    commands = shares(8)
    rows = [{"command": each, "fault": fault} for each in commands]
    found = over(thruster, ["thrust"], h, rows)[:, 0]
    # z''' + a2 z'' + a1 z' + a0 z = T, thrust = a0 z + b z'.
    A = np.zeros((4, 4))
    A[0, 1] = A[1, 2] = A[2, 3] = 1.0
    A[2, :3] = -np.array(poles)
    kept, state = expm(A * h / slower), np.zeros(3)
    for k, command in enumerate(commands):
        assert found[k] == pytest.approx(left * (poles[0] * state[0] + zero * state[1]), abs=1e-8)
        V = min(max(command, -1), 1)
        steady = sum(c * V**power for c, power in zip(curve, (1, 3, 5, 7, 9), strict=True))
        state = (kept @ [*state, steady])[:3]


@pytest.mark.parametrize(
    ("fault", "slower", "left"), [("none", 1, 1), ("slow", 10, 1), ("wrong", 1, 0.5)]
)
@pytest.mark.parametrize("reverse", [0.0, 1.0])
def test_a_t200_follows_its_table_at_its_voltage(fault, slower, left, reverse):
    low, neutral, high, h = 1.15e-3, 1.46e-3, 1.97e-3, 0.05
    thruster = started(
        Thruster, pulse_min=low, pulse_neutral=neutral, pulse_max=high, reversed=reverse,
        time_constant=0.2,
    )  # fmt: skip
    draw = np.random.default_rng(9)
    pulses, volts = 1.5e-3 + 0.75e-3 * shares(9, -1, 1), draw.uniform(-2, 20, STEPS)
    rows = [
        {"pulse": p, "supply_voltage": v, "fault": fault}
        for p, v in zip(pulses, volts, strict=True)
    ]
    found = over(thruster, ["thrust", "current", "speed", "power"], h, rows)
    y, power = np.zeros(3), 0.0
    for k, (width, voltage) in enumerate(zip(pulses, volts, strict=True)):
        np.testing.assert_allclose(found[k], [*y, power], atol=1e-10)
        away = (width - neutral) / (high - neutral if width > neutral else neutral - low)
        there = 1.5e-3 + 0.4e-3 * away * (-1 if reverse else 1)
        if not 0.8e-3 <= width <= 2.2e-3:
            there = 1.5e-3
        supply = (max(voltage, 0) / 16) ** 1.15
        scale = np.array([left * supply, supply, math.sqrt(supply)])
        goal = scale * [
            np.interp(there, t200.PULSE, v) for v in (t200.FORCE, t200.CURRENT, t200.SPEED)
        ]
        y = goal + (y - goal) * math.exp(-h / (0.2 * slower))
        power = max(voltage, 0) * y[1]


def test_thrusters_push_at_their_places():
    draw = np.random.default_rng(10)
    places, directions, thrusts = (
        draw.normal(size=(4, 3)),
        draw.normal(size=(4, 3)),
        draw.normal(size=4),
    )
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    values = {"thrust": [*thrusts, *[3.0] * 12]}
    for number, (place, direction) in enumerate(zip(places, directions, strict=True), 1):
        values |= {f"position_{number}": place, f"direction_{number}": direction}
    made = started(Propulsion, **values)
    forces = thrusts[:, None] * directions
    np.testing.assert_allclose(made.get("force"), forces.sum(0), atol=1e-12)
    np.testing.assert_allclose(made.get("moment"), np.cross(places, forces).sum(0), atol=1e-12)


def test_a_battery_of_any_loads_solves_its_circuit():
    curve = np.array([3.0, 3.3, 3.35, 3.5, 3.6, 3.7, 3.72, 3.8, 3.9, 4.0, 4.2])
    battery = started(
        Battery, open_circuit=curve.tolist(), cells=5.0, resistance=0.17, capacity=2900.0,
        electronics=11.0, cut_off=0.0, charge_start=0.83,
    )  # fmt: skip
    draw, h, q = np.random.default_rng(11), 1.5, 0.83
    loads, powers = draw.uniform(0, 9, (STEPS, 3)), draw.uniform(0, 40, (STEPS, 2))
    rows = [
        {"load_1": a, "load_7": b, "load_16": c, "power_2": d, "power_4": e}
        for (a, b, c), (d, e) in zip(loads, powers, strict=True)
    ]
    found = over(battery, ["voltage", "current", "charge"], h, rows)

    def circuit(charge, drawn, P):
        E = 5 * np.interp(10 * charge, range(11), curve)
        # R I'^2 - (E - R drawn) I' + P = 0 of the current I' of the power: the smaller root.
        own = min(np.roots([0.17, -(E - 0.17 * drawn), P]).real)
        return E - 0.17 * (drawn + own), drawn + own

    for k, (drawn, P) in enumerate(zip(loads.sum(1), powers.sum(1) + 11.0, strict=True)):
        np.testing.assert_allclose(found[k], [*circuit(q, drawn, P), q], rtol=1e-9)
        middle = q - h / 2 * circuit(q, drawn, P)[1] / 2900
        q -= h * circuit(middle, drawn, P)[1] / 2900


def test_loads_beyond_a_short_circuit_leave_no_voltage():
    battery = started(Battery, open_circuit=[4.0] * 11, cells=4.0, resistance=0.5, cut_off=0.0)
    for power in (0.0, 50.0):
        battery.set("power_1", power)
        battery.set("load_3", 40.0)  # 32 A is the short circuit
        assert (battery.get("voltage"), battery.get("current")) == (0.0, 40.0)
