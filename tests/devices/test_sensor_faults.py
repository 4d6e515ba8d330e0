"""Failures of sensors. Statistical bounds are 3.9 sigma, as in test_sensor."""

import math

import numpy as np
import pytest

from seatrial.devices.compass import Compass
from seatrial.errors import InputError
from seatrial.model.faults.catalogue import FAILURES as FAULTS

from .probe import Probe
from .running import run, started
from .test_sensor import ROUGH, SIGMAS

BROKEN_MS, REPAIRED_MS = 500, 1000
OUTPUTS = ["y", "valid", "count"]


def failing(fault, step_ms=10, stop_ms=1500, cls=Probe, outputs=OUTPUTS, **values):
    """Return the outputs at each point of a run in which it fails for half a second."""

    def inputs(t_ms):
        fails = BROKEN_MS <= t_ms < REPAIRED_MS
        return {"truth": [t_ms, -t_ms], "fault": fault if fails else "none"}

    probe = started(cls, period=0.01, **values)
    return run(probe, outputs, stop_ms, step_ms, inputs)


def broken(rows):
    """Return (t_ms, row) of the points at which it was broken, of rows every 10 ms."""
    return [(10 * k, row) for k, row in enumerate(rows)][BROKEN_MS // 10 : REPAIRED_MS // 10]


@pytest.mark.parametrize("fault", FAULTS)
def test_until_it_fails_nothing_is_different(fault):
    healthy, failed = failing("none", **ROUGH), failing(fault, **ROUGH)
    assert failed[: BROKEN_MS // 10] == healthy[: BROKEN_MS // 10]
    assert failed[BROKEN_MS // 10 + 1 :] != healthy[BROKEN_MS // 10 + 1 :]


@pytest.mark.parametrize("fault", FAULTS)
def test_repaired_it_shows_the_same_values_again(fault):
    # Noise belongs to a measurement, not to how many arrived before.
    healthy, failed = failing("none", **ROUGH), failing(fault, **ROUGH)
    assert [row[:2] for row in failed[REPAIRED_MS // 10 :]] == [
        row[:2] for row in healthy[REPAIRED_MS // 10 :]
    ]


def test_off_publishes_nothing():
    for _, row in broken(failing("off")):
        assert row == [[490.0, -490.0], False, 50]


def test_stuck_publishes_the_last_measurement_again_and_again():
    for t, row in broken(failing("stuck")):
        assert row == [[490.0, -490.0], True, t // 10 + 1]


def test_stuck_before_the_first_measurement_has_nothing_to_publish():
    probe = started(Probe, fault="stuck", truth=[1.0, 1.0])
    assert run(probe, OUTPUTS, 50, 10) == [[[0.0, 0.0], False, 0]] * 6


def test_wrong_is_a_tenth_of_the_span_too_much():
    for t, row in broken(failing("wrong")):
        assert row == [pytest.approx([t + 0.2, 1.0 - t]), True, t // 10 + 1]


def test_garbage_is_uniform_over_the_span():
    n = 4000
    values = np.array([row[0] for row in run(started(Probe, fault="garbage"), ["y"], 10 * n, 10)])
    for column, (low, high) in zip(values.T, [(-1.0, 1.0), (0.0, 10.0)], strict=True):
        share = np.sort((column - low) / (high - low))
        distance = np.abs(share - (np.arange(len(share)) + 0.5) / len(share)).max()
        assert distance < 2.2 / math.sqrt(n)  # Kolmogorov, 1 in 10 000
    assert abs(np.corrcoef(values.T)[0, 1]) < SIGMAS / math.sqrt(n)
    assert abs(np.corrcoef(values[1:, 0], values[:-1, 0])[0, 1]) < SIGMAS / math.sqrt(n)


def test_garbage_of_another_seed_is_other_garbage():
    assert failing("garbage") == failing("garbage")
    assert failing("garbage") != failing("garbage", seed=2.0)


def test_garbage_of_a_compass_is_on_its_card():
    rows = run(started(Compass, fault="garbage"), ["heading"], 5000, 10)
    assert all(0.0 <= heading < math.tau for (heading,) in rows)


def test_slow_is_due_every_tenth_time():
    for t, row in broken(failing("slow")):
        last = t // 100 * 100  # measurements 50, 60, ... are made
        assert row == [[float(last), -float(last)], True, 51 + (last - BROKEN_MS) // 100]


@pytest.mark.parametrize("delay_ms", [0, 30])
def test_delayed_is_ten_periods_later(delay_ms):
    rows = failing("delayed", delay=delay_ms / 1000)
    for t, row in broken(rows):
        # Those that were measured before are on time, the others 100 ms later.
        made = min(t - delay_ms, BROKEN_MS - 10)
        made = max(made, t - delay_ms - 100)
        assert row == [[float(made), -float(made)], True, made // 10 + 1]
    for k, row in enumerate(rows[REPAIRED_MS // 10 :]):
        t = REPAIRED_MS + 10 * k
        made = t - delay_ms
        if made < REPAIRED_MS:  # still those that are late, until a fresh one overtakes them
            made = t - delay_ms - 100
        assert row == [[float(made), -float(made)], True, made // 10 + 1]


def test_intermittent_loses_every_second_one_on_average():
    n = 4000
    probe = started(Probe, fault="intermittent", y_noise=1.0)
    healthy = started(Probe, y_noise=1.0)
    rows, good = (run(each, OUTPUTS, 10 * n, 10) for each in (probe, healthy))
    arrived = np.array([row[1] for row in rows], dtype=float)
    assert arrived.mean() == pytest.approx(0.5, abs=SIGMAS * 0.5 / math.sqrt(n))
    assert abs(np.corrcoef(arrived[1:], arrived[:-1])[0, 1]) < SIGMAS / math.sqrt(n)
    assert all(r[0] == g[0] for r, g in zip(rows, good, strict=True) if r[1])
    assert rows[-1][2] == arrived.sum()


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize("delay_ms", [0, 37])
def test_it_does_not_depend_on_the_communication_step(fault, delay_ms):
    # The truth moves with the step: it is held by what sets it, here every 50 ms.
    values = {"delay": delay_ms / 1000, "dropout": 0.2, **ROUGH}

    def at_50_ms(step_ms):
        def inputs(t_ms):
            fails = BROKEN_MS <= t_ms < REPAIRED_MS
            return {"truth": [t_ms // 50, 1.0], "fault": fault if fails else "none"}

        probe = started(Probe, period=0.007, **values)
        return run(probe, OUTPUTS, 1500, step_ms, inputs)[:: 50 // step_ms]

    assert at_50_ms(1) == at_50_ms(10) == at_50_ms(50)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_failure_taken_back_at_the_same_instant_leaves_no_trace(fault):
    probe = started(Probe, truth=[3.0, 4.0])
    probe.advance(0.0, 0.01)
    before = [probe.get(name) for name in OUTPUTS]
    probe.set("fault", fault)
    [probe.get(name) for name in OUTPUTS]
    probe.set("fault", "none")
    assert [probe.get(name) for name in OUTPUTS] == before


def test_an_unknown_failure_is_refused_with_those_that_there_are():
    probe = started(Probe)
    probe.set("fault", "of")
    with pytest.raises(
        InputError, match=r"Probe.fault: unknown fault 'of'; did you mean 'off'.*garbage"
    ):
        probe.get("y")
