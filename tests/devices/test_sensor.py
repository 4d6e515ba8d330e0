"""Base of all sensors.

Statistical bounds are 3.9 sigma: with other seeds a right sensor fails each once in 10 000.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from .probe import Probe
from .running import run, started

SIGMAS = 3.9


ROUGH = {
    "y_noise": [1.0, 2.0],
    "y_bias": [0.5, -0.5],
    "y_instability": 0.3,
    "y_resolution": 0.25,
    "correlation_time": 0.1,
}


def series(n, **values):
    """Return n measurements of a truth of 0, (n, 2)."""
    probe = started(Probe, period=0.01, **values)
    return np.array([y for (y,) in run(probe, ["y"], 10 * (n - 1), 10)])


# ------------------------------------------------------------------ noise


def test_ideal_sensor_shows_the_truth_at_once():
    probe = started(Probe)
    rows = run(probe, ["y", "valid", "count"], 50, 10, lambda t: {"truth": [t, -t]})
    assert rows == [[[t, -t], True, t // 10 + 1] for t in range(0, 51, 10)]


def test_white_noise_has_its_standard_deviation_and_mean():
    n, sigmas = 10_000, [1.0, 2.0]
    y = series(n, y_noise=sigmas)
    for column, sigma in zip(y.T, sigmas, strict=True):
        assert column.std(ddof=1) == pytest.approx(sigma, rel=SIGMAS / math.sqrt(2 * n))
        assert abs(column.mean()) < SIGMAS * sigma / math.sqrt(n)


def test_white_noise_is_independent_of_axis_and_time():
    n = 10_000
    y = series(n, y_noise=1.0)
    bound = SIGMAS / math.sqrt(n)
    assert abs(np.corrcoef(y.T)[0, 1]) < bound
    for lag in (1, 2, 10):
        assert abs(np.corrcoef(y[lag:, 0], y[:-lag, 0])[0, 1]) < bound


@pytest.mark.slow
def test_allan_deviation_of_white_noise_falls_with_the_square_root():
    n = 20_000
    y = series(n, y_noise=1.0)[:, 0]
    for length in (1, 10, 100):
        means = y[: n - n % length].reshape(-1, length).mean(axis=1)
        allan = math.sqrt(0.5 * np.mean(np.diff(means) ** 2))
        # Relative error of the estimate from m means: sqrt(3 / (4 m)) for white noise.
        bound = SIGMAS * math.sqrt(0.75 / len(means))
        assert allan == pytest.approx(1.0 / math.sqrt(length), rel=bound)


@pytest.mark.slow
def test_slow_bias_is_stationary_with_its_correlation_time():
    # Over many seeds: b_k has variance s^2, and covariance s^2 exp(-k T / tau) with b_0.
    n, lag, s = 3000, 4, 0.3
    values = {"y_instability": s, "correlation_time": 0.05, "period": 0.01}
    b = []
    for seed in range(1, n + 1):
        probe = started(Probe, seed=float(seed), **values)
        b.append([row[0][0] for row in run(probe, ["y"], 10 * lag, 10)])
    b = np.array(b)
    for k in (0, lag):
        assert b[:, k].std() == pytest.approx(s, rel=SIGMAS / math.sqrt(2 * n))
    rho = math.exp(-lag * 0.01 / 0.05)
    bound = SIGMAS * (1 - rho**2) / math.sqrt(n)
    assert np.corrcoef(b[:, 0], b[:, lag])[0, 1] == pytest.approx(rho, abs=bound)


def test_constant_bias_is_added():
    assert (series(5, y_bias=[0.5, -0.25]) == [0.5, -0.25]).all()


def test_another_seed_draws_other_numbers():
    first, second = (series(2000, y_noise=1.0, seed=seed)[:, 0] for seed in (1.0, 2.0))
    assert abs(np.corrcoef(first, second)[0, 1]) < SIGMAS / math.sqrt(2000)


@given(st.integers(-1000, 1000), st.floats(-0.49, 0.49))
def test_quantisation_gives_the_nearest_multiple_exactly(multiple, rest):
    step = 0.1
    probe = started(Probe, y_resolution=step, truth=[(multiple + rest) * step, 0.0])
    assert probe.get("y.x") == multiple * step


# ------------------------------------------------------------------ time


def truth(t_ms):
    """A truth that changes every 50 ms."""
    return {"truth": [math.sin(t_ms // 50), t_ms // 50]}


@pytest.mark.parametrize("delay_ms", [0, 3, 10, 37, 120])
@pytest.mark.parametrize("period_ms", [7, 10, 50])
def test_what_is_published_does_not_depend_on_the_communication_step(period_ms, delay_ms):
    values = {"period": period_ms / 1000, "delay": delay_ms / 1000, "dropout": 0.3, **ROUGH}

    def at_50_ms(step_ms):
        probe = started(Probe, **values)
        rows = run(probe, ["y", "valid", "count"], 1000, step_ms, truth)
        return rows[:: 50 // step_ms]

    reference = at_50_ms(1)
    for step_ms in (2, 5, 10, 25, 50):
        assert at_50_ms(step_ms) == reference


@pytest.mark.parametrize("delay_ms", [0, 1, 9, 10, 37])
def test_delayed_value_appears_when_due(delay_ms):
    probe = started(Probe, period=0.01, delay=delay_ms / 1000)
    rows = run(probe, ["y.x", "count", "valid"], 200, 1, lambda t: {"truth": [t, 0]})
    for t, row in enumerate(rows):
        if t < delay_ms:
            assert row == [0.0, 0, False]
        else:
            k = (t - delay_ms) // 10
            assert row == [10.0 * k, k + 1, True]


def test_period_that_no_step_meets_is_counted_without_drift():
    # 1/3 s in 0.1 s steps: the 3000th measurement is due at 1000 s.
    probe = started(Probe, period=1 / 3)
    for k in range(9_999):
        probe.advance(k * 0.1, 0.1)
    assert probe.get("count") == 3000
    probe.advance(999.9, 0.1)
    assert probe.get("count") == 3001


# ------------------------------------------------------------------ dropout


def test_lost_measurement_keeps_the_one_before():
    probe = started(Probe, period=0.01, dropout=0.3)
    rows = run(probe, ["y.x", "count", "valid"], 5000, 10, lambda t: {"truth": [t, 0]})
    last, count = 0.0, 0
    for t, (y, n, valid) in zip(range(0, 5001, 10), rows, strict=True):
        if valid:
            last, count = float(t), count + 1
        assert (y, n) == (last, count)
    lost = 1 - count / len(rows)
    assert lost == pytest.approx(0.3, abs=SIGMAS * math.sqrt(0.3 * 0.7 / len(rows)))


def test_nothing_is_valid_if_all_is_lost():
    probe = started(Probe, dropout=1.0)
    rows = run(probe, ["y", "count", "valid"], 100, 10, lambda t: {"truth": [1, 1]})
    assert all(row == [[0.0, 0.0], 0, False] for row in rows)


# ------------------------------------------------------------------ rollback


@settings(deadline=None, max_examples=30)
@given(st.lists(st.sampled_from([1, 4, 10, 23]), min_size=1, max_size=12), st.integers(0, 11))
def test_step_taken_back_and_halved_draws_the_same_noise(steps_ms, redo):
    values = {"period": 0.01, "delay": 0.013, "dropout": 0.2, **ROUGH}
    plain, tried = started(Probe, **values), started(Probe, **values)
    t = 0
    for index, step in enumerate(steps_ms):
        plain.advance(t / 1000, step / 1000)
        if index == redo:
            state = tried.get_state()
            tried.advance(t / 1000, step / 1000)
            tried.get("y")
            tried.set_state(state)
            tried.advance(t / 1000, step / 2000)
            tried.advance(t / 1000 + step / 2000, step / 2000)
        else:
            tried.advance(t / 1000, step / 1000)
        t += step
        for name in ("y", "count", "valid"):
            assert plain.get(name) == tried.get(name)
