"""Motor of a propulsor: limits, lag and the line of devices that it stands in."""

import math

import pytest

from seatrial.devices.actuators.esc import Esc
from seatrial.devices.actuators.esc_driver import EscDriver
from seatrial.devices.actuators.motor import Motor

from .running import run, started


@pytest.mark.parametrize("command", [-2.0, -1.0, -0.3, 0.0, 0.7, 1.0, 1e9])
def test_without_a_lag_the_order_is_the_limited_command_at_once(command):
    assert started(Motor, command=command).get("order") == min(max(command, -1.0), 1.0)


@pytest.mark.parametrize("step_ms", [1, 20, 250])
def test_with_a_lag_it_follows_exponentially_whatever_the_step(step_ms):
    orders = run(started(Motor, time_constant=0.4, command=0.8), ["order"], 1000, step_ms)
    for number, (order,) in enumerate(orders):
        expected = 0.8 * -math.expm1(-number * step_ms / 400)
        assert order == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_it_drives_what_a_share_asks_for_through_driver_and_speed_controller():
    for wanted in (-1.0, -0.25, 0.0, 0.6):
        pulse = started(EscDriver, share=wanted).get("pulse")
        command = started(Esc, pulse=pulse).get("share")
        assert started(Motor, command=command).get("order") == pytest.approx(wanted, abs=1e-12)
