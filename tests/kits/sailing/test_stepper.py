"""The stepper against closed forms of a rotor in a turning field, and of its driver's trapezium."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from seatrial.errors import InputError
from seatrial_kits.sailing.stepper import Stepper, slipped
from seatrial_kits.sailing.stepper_driver import StepperDriver
from tests.devices.running import started

DIRECT = {"gear": 1.0, "holding_torque": 1.0, "pull_out_rate": 30.0}
TURN = 1600  # pulses, of 200 full steps in 8


def turned(motor, rate, seconds, h=0.01):
    """Turn the field at ``rate``, rad/s; return the angles of the shaft at the end of each step."""
    begun, angles = motor.now, []
    for k in range(1, round(seconds / h) + 1):
        motor.set("steps", round((begun + k * h) * rate / math.tau * TURN))
        motor.advance(begun + (k - 1) * h, h)
        angles.append(motor.get("angle"))
    return angles


@settings(max_examples=60, deadline=None)
@given(*[st.floats(-30, 30)] * 2, st.floats(0, 30), st.floats(1e-3, 1))
def test_the_step_is_the_solution_of_its_equation(lag, drift, pull, h):
    solved = solve_ivp(
        lambda _, psi: drift - pull * np.sin(psi),
        (0, h),
        [lag],
        rtol=1e-10,
        atol=1e-11,
        method="DOP853",
    )
    # Near the unstable rest at pi both differ by what rounding grows to there.
    assert slipped(lag, drift, pull, h) == pytest.approx(solved.y[0, -1], abs=1e-5)


@pytest.mark.parametrize("share", [0.5, 0.99, -0.99])
def test_it_holds_less_than_its_torque_off_by_its_lag(share):
    motor = started(Stepper, **DIRECT, load=share)
    for k in range(2000):
        motor.advance(0.01 * k, 0.01)
    assert motor.get("angle") == pytest.approx(math.asin(share) / 50, abs=1e-6)
    assert motor.get("lost") == 0


def test_it_slips_under_more_at_the_rate_of_the_closed_form():
    load = 1.2
    motor = started(Stepper, **DIRECT, load=load)
    for k in range(1000):
        motor.advance(0.01 * k, 0.01)
    per_second = 50 * math.sqrt(load**2 - 1.0) / (1.0 / 30.0) / math.tau  # turns of psi
    assert motor.get("lost") == pytest.approx(-4 * per_second * 10, abs=5)
    assert motor.get("angle") == pytest.approx(per_second * 10 * math.tau / 50, rel=1e-3)
    assert motor.get("stalled")


@pytest.mark.parametrize(("share", "lost"), [(0.98, False), (1.02, True)])
@pytest.mark.parametrize("rate", [5.0, 15.0, 25.0])
def test_torque_falls_in_proportion_to_speed(rate, share, lost):
    """Pull-out at T - D omega, against the motion."""
    motor = started(Stepper, **DIRECT, load=-share * (1.0 - rate / 30.0))
    turned(motor, rate, 5.0)
    assert (motor.get("lost") != 0) is lost


def test_it_is_where_the_pulses_say_as_long_as_it_follows():
    motor = started(Stepper, gear=20.0, angle_start=0.3)
    turned(motor, 5.0, 3.0)
    pulses = motor.get("steps")
    for k in range(100):
        motor.advance(3.0 + 0.01 * k, 0.01)
    assert motor.get("angle") == pytest.approx(0.3 + math.tau * pulses / TURN / 20, abs=1e-9)


def test_what_is_lost_stays_lost():
    motor = started(Stepper, **DIRECT, load=-2.0)
    turned(motor, 5.0, 1.0)
    motor.set("load", 0.0)
    for k in range(200):
        motor.advance(1.0 + 0.01 * k, 0.01)
    lost, field = motor.get("lost"), math.tau * motor.get("steps") / TURN
    assert lost > 0
    assert motor.get("angle") == pytest.approx(field - lost * math.tau / 200, abs=1e-6)


def test_less_current_is_less_torque():
    held = {}
    for current in (2.8, 1.4):
        motor = started(Stepper, **DIRECT, current=current, load=0.6)
        for k in range(100):
            motor.advance(0.01 * k, 0.01)
        held[current] = motor.get("lost") == 0
    assert held == {2.8: True, 1.4: False}


def test_without_current_the_load_turns_it():
    motor = started(Stepper, **DIRECT, enabled=False, load=0.1)
    for k in range(100):
        motor.advance(0.01 * k, 0.01)
    assert motor.get("rate") == pytest.approx(0.1 * 30.0)
    assert motor.get("power") == 0.0


def test_the_communication_step_does_not_matter():
    ends = []
    for h in (0.05, 0.01, 0.002):
        motor = started(Stepper, **DIRECT, load=-0.7)
        angles = turned(motor, 5.0, 2.0, h)
        ends.append((motor.get("lost"), angles[-1]))
    assert ends[0] == pytest.approx(ends[1], abs=1e-3)
    assert ends[0] == pytest.approx(ends[2], abs=1e-3)


def test_power_is_heat_and_work():
    motor = started(Stepper, **DIRECT, load=-0.3, resistance=0.9, current=2.8)
    turned(motor, 10.0, 2.0)
    assert motor.get("power") == pytest.approx(2.8**2 * 0.9 + 0.3 * 10.0, rel=1e-2)


@pytest.mark.parametrize(
    ("fault", "share"), [("off", 0.0), ("stuck", 0.0), ("slow", 0.1), ("none", 1.0)]
)
def test_faults(fault, share):
    motor = started(Stepper, **DIRECT, fault=fault)
    turned(motor, 2.0, 2.0)
    assert motor.get("angle") == pytest.approx(4.0 * share, abs=0.02)


def driven(angle, seconds, **settings):
    driver = started(StepperDriver, **settings, angle=angle)
    rows = []
    for k in range(round(seconds / 0.005)):
        driver.advance(0.005 * k, 0.005)
        rows.append(driver.get("counted"))
    return np.array(rows), driver


@pytest.mark.parametrize("angle", [1.2, -0.7, 0.01])
def test_a_trapezium_of_speed(angle):
    rate, acceleration = 0.5, 2.0
    rows, _ = driven(angle, 5.0, rate=rate, acceleration=acceleration)
    pulse = math.tau / (200 * 8 * 20)
    speeds = np.diff(rows) / 0.005
    assert abs(rows[-1] - angle) <= pulse / 2 + 1e-12
    assert np.abs(speeds).max() <= rate + pulse / 0.005
    assert np.all(np.sign(angle) * rows <= abs(angle) + pulse)  # never beyond
    half = rate**2 / acceleration
    taken = (
        abs(angle) / rate + rate / acceleration
        if abs(angle) > half
        else 2 * math.sqrt(abs(angle) / acceleration)
    )
    arrived = 0.005 * int(np.argmax(np.abs(rows - angle) <= pulse))
    assert arrived == pytest.approx(taken, abs=0.03)


def test_it_keeps_to_its_range():
    rows, _ = driven(9.0, 8.0, angle_max=1.0)
    assert rows.max() == pytest.approx(1.0, abs=1e-3)
    with pytest.raises(InputError, match="angle_start"):
        started(StepperDriver, angle_start=2.0)
