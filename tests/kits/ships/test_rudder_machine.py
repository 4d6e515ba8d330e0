import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.ships.devices.rudder_machine import RudderMachine
from tests.devices.running import run, started

DEG = math.radians(1.0)


def angles(command, stop_ms, step_ms=100, **values):
    machine = started(RudderMachine, command=command, **values)
    return np.array([a for (a,) in run(machine, ["angle"], stop_ms, step_ms)])


def test_small_commands_are_followed_with_the_lag():
    t = np.arange(51) * 0.1
    exact = 4 * DEG * (1 - np.exp(-t))  # 4 deg/s at first: below the limit of the rate
    np.testing.assert_allclose(angles(4 * DEG, 5000), exact, atol=1e-7)


def test_large_commands_are_followed_at_the_limited_rate():
    # 5 deg/s until 5 degrees are left, at 5 s; then the lag
    t = np.arange(101) * 0.1
    exact = np.where(t < 5.0, 5 * DEG * t, 30 * DEG - 5 * DEG * np.exp(-(t - 5.0)))
    np.testing.assert_allclose(angles(30 * DEG, 10000), exact, atol=1e-7)


@pytest.mark.parametrize(("limit", "command"), [(35, 60), (40, 60), (35, -90)])
def test_stops_at_its_limit(limit, command):
    end = angles(command * DEG, 40000, limit=limit * DEG)
    assert np.abs(end).max() <= limit * DEG * (1 + 1e-12)
    assert end[-1] == pytest.approx(math.copysign(limit * DEG, command), rel=1e-9)


def test_lag_is_a_parameter():
    t = np.arange(51) * 0.1
    exact = DEG * (1 - np.exp(-t / 2.5))
    np.testing.assert_allclose(angles(DEG, 5000, time_constant=2.5), exact, atol=1e-9)


def test_a_command_to_starboard_is_turned_round_in_one_place():
    port = angles(0.2, 3000)
    np.testing.assert_array_equal(angles(0.2, 3000, positive="starboard"), -port)
    assert port[-1] > 0.1


def test_starts_at_its_start_value():
    assert angles(0.0, 100, angle_start=0.3)[0] == 0.3
    with pytest.raises(InputError, match=r"angle_start is 0\.7 rad, allowed"):
        started(RudderMachine, angle_start=0.7)
