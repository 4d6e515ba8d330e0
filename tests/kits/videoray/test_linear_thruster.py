"""The thruster of a command between -1 and 1 against its closed form."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.videoray.vessel.linear_thruster import LinearThruster
from tests.devices.running import run, started

PRO_4 = {"full_thrust": 46.7, "delay": 0.1, "time_constant": 0.15}


def thrusts(commands, stop_ms, step_ms, **values):
    """Return the thrust at each communication point under commands by time of change, ms."""

    def inputs(t_ms):
        return {"command": commands[max(c for c in commands if c <= t_ms)]}

    thruster = started(LinearThruster, **{**PRO_4, **values})
    rows = run(thruster, ["thrust"], stop_ms, step_ms, inputs)
    return np.array(rows).ravel()


def steps(changes, t, delay=0.1, time_constant=0.15, full=46.7):
    """Return the response to jumps of the command, (time in s, height) each: superposition."""
    total = np.zeros_like(t)
    for time, jump in changes:
        late = np.clip(t - time - delay, 0.0, None)
        total -= full * jump * np.expm1(-late / time_constant)
    return total


@pytest.mark.parametrize("step_ms", [1, 7, 10, 25, 100, 200])
def test_a_step_comes_late_and_with_a_lag_whatever_the_communication_step(step_ms):
    found = thrusts({0: 0.6}, 1400, step_ms)
    t = np.arange(len(found)) * step_ms / 1000
    np.testing.assert_allclose(found, steps([(0.0, 0.6)], t), rtol=0, atol=1e-12)


@pytest.mark.parametrize("delay", [0.0, 0.05, 0.1, 0.137, 0.3])
def test_commands_on_their_way_do_not_disturb_each_other(delay):
    commands = {0: 0.0, 40: 1.0, 60: -0.5, 70: -0.5, 80: 0.0, 300: 0.25}
    jumps = [(0.04, 1.0), (0.06, -1.5), (0.08, 0.5), (0.3, 0.25)]
    found = thrusts(commands, 1000, 10, delay=delay)
    t = np.arange(101) / 100
    np.testing.assert_allclose(found, steps(jumps, t, delay), rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("command", "share"),
    [(0.05, 0), (-0.05, 0), (0.051, 0.051), (-0.3, -0.3), (1, 1), (1.7, 1), (-4, -1)],
)
def test_dead_band_and_saturation(command, share):
    end = thrusts({0: command}, 10000, 100, dead_band=0.05)[-1]
    assert end == pytest.approx(46.7 * share, rel=1e-12)


def test_thrust_does_not_move_before_the_delay_is_over():
    found = thrusts({0: 1.0}, 200, 10)
    assert (found[:11] == 0.0).all()
    assert found[11] == pytest.approx(46.7 * -math.expm1(-0.01 / 0.15), rel=1e-12)


@pytest.mark.parametrize(
    "wrong", [{"delay": -0.1}, {"time_constant": 0.0}, {"dead_band": 1.2}, {"full_thrust": -1.0}]
)
def test_values_that_make_no_thruster_are_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        started(LinearThruster, **wrong)
