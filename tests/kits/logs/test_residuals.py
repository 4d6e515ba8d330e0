"""Residual, lag and coherence of a signal and a channel, against closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.logs.paired.resampling import Trace, unwrapped
from seatrial_kits.logs.paired.residuals import residual_of


def trace(time, values, unit="m", *, gap=math.inf, held=False):
    return Trace("x", unit, np.asarray(time, float), np.asarray(values, float), held, gap)


def test_a_constant_offset_in_another_unit():
    time = np.arange(0.0, 10.0, 0.1)
    found = residual_of(trace(time, np.sin(time)), trace(time, 100.0 * (np.sin(time) - 0.25), "cm"))
    assert found.bias == pytest.approx(0.25, abs=1e-12)
    assert found.rms == pytest.approx(0.25, abs=1e-12)
    assert found.lag is None


def test_the_worst_and_the_rms_of_a_ramp():
    time = np.linspace(0.0, 1.0, 101)
    found = residual_of(trace(time, time), trace(time, 0.0 * time))
    assert (found.worst, found.time[found.worst_row]) == (1.0, 1.0)
    assert found.rms == pytest.approx(math.sqrt(np.mean(time**2)))
    assert found.fit is None


@given(lag=st.floats(-3.0, 3.0), period=st.sampled_from([0.05, 0.1, 0.37]))
def test_a_log_that_is_late(lag, period):
    """Two sines that do not repeat within the record; an instrument late by ``lag``."""
    fine, coarse = np.arange(0.0, 120.0, 0.02), np.arange(5.0, 110.0, period)

    def signal(t):
        return np.sin(0.7 * t) + 0.4 * np.sin(1.3 * t + 1.0)

    found = residual_of(trace(fine, signal(fine)), trace(coarse, signal(coarse - lag)))
    if abs(lag) > 0.3:
        assert found.lag == pytest.approx(lag, abs=0.1 * period)
        assert found.rms_without_lag < 0.1 * found.rms
    assert found.interpolated == "run"
    assert found.period == pytest.approx(period)


@pytest.mark.parametrize("turns", [-3, 0, 2])
def test_whole_turns_are_no_residual(turns):
    time = np.arange(0.0, 60.0, 0.1)
    heading = 3.0 + 0.3 * np.sin(0.2 * time)
    log = np.degrees(heading + 0.01 + turns * math.tau)
    found = residual_of(trace(time, heading, "rad"), trace(time, log, "deg"))
    np.testing.assert_allclose(found.residual, -0.01, atol=1e-9)


@given(noise=st.floats(0.1, 2.0))
def test_coherence_with_white_noise(noise):
    """Of a signal and itself with independent noise it is 1 / (1 + noise power / signal power)."""
    generator = np.random.default_rng(3)
    time = np.arange(8192) * 0.1
    signal = generator.normal(size=8192)
    log = signal + noise * generator.normal(size=8192)
    found = residual_of(trace(time, signal), trace(time, log))
    # Eight half overlapping segments bias it upwards by about (1 - C)^2 / 5.
    expected = 1.0 / (1.0 + noise**2)
    assert found.coherence == pytest.approx(expected, abs=0.06 + (1.0 - expected) ** 2 / 4.0)


def test_gaps_and_what_is_outside_are_left_out():
    log_time = np.concatenate((np.arange(0.0, 10.0), np.arange(30.0, 40.0)))
    run_time = np.arange(-5.0, 50.0, 2.5)
    found = residual_of(trace(run_time, run_time), trace(log_time, log_time, gap=5.0))
    assert found.time.tolist() == [0.0, 2.5, 5.0, 7.5, 30.0, 32.5, 35.0, 37.5]
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-12)


def test_units_and_times_that_do_not_fit():
    time = np.arange(5.0)
    with pytest.raises(InputError, match="x and the log's x: unit 's' cannot be converted to 'm'"):
        residual_of(trace(time, time), trace(time, time, "s"))
    with pytest.raises(
        InputError, match=r"\(0 s to 4 s\) and the log's x \(10 s to 14 s\) have no"
    ):
        residual_of(trace(time, time), trace(time + 10.0, time))


def test_angles_go_on_over_their_jumps():
    np.testing.assert_allclose(
        unwrapped(np.array([350.0, 10.0, 30.0]), "deg"), [350.0, 370.0, 390.0]
    )
    assert unwrapped(np.array([350.0, 10.0]), "m").tolist() == [350.0, 10.0]
    angles = np.random.default_rng(3).uniform(-4.0, 4.0, 5000)
    np.testing.assert_allclose(unwrapped(angles, "rad"), np.unwrap(angles), rtol=0, atol=1e-9)
