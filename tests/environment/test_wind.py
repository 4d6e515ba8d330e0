import math

import numpy as np
import pytest

from seatrial.physics.environment.wind import Wind
from tests.devices.running import run, started

GUSTS = {"intensity": 0.15, "direction_deviation": 0.14, "period": 0.1, "correlation_time": 8.0}


def test_without_gusts_it_is_the_mean():
    wind = started(Wind, mean_speed=5.0, mean_direction=math.radians(30))
    for velocity, speed, direction in run(wind, ["velocity", "speed", "direction"], 1000, 100):
        assert velocity == pytest.approx([5.0 * math.cos(math.pi / 6), 2.5], rel=1e-15)
        assert (speed, direction) == (5.0, math.radians(30))


def test_a_state_is_restored_elsewhere():
    wind, other = started(Wind, wind_speed=7.0, wind_direction=2.0), Wind("other")
    other.set_state(wind.get_state())
    other.advance(0.0, 0.1)
    assert other.get("velocity") == pytest.approx([7.0 * math.cos(2.0), 7.0 * math.sin(2.0)])


def test_single_gust_is_a_full_cosine():
    gust = {"gust_size": 0.5, "gust_start": 2.0, "gust_duration": 4.0}
    wind = started(Wind, mean_speed=8.0, **gust)
    speeds = [speed for (speed,) in run(wind, ["speed"], 8000, 1)]
    assert speeds[:2001] == [8.0] * 2001
    assert speeds[6000:] == [8.0] * 2001
    # A quarter, half and three quarters of the way: half, all and half of 4 m/s.
    assert [speeds[k] for k in (3000, 4000, 5000)] == pytest.approx([10.0, 12.0, 10.0], rel=1e-12)
    # Its impulse is half its peak times its duration.
    assert np.sum(np.array(speeds) - 8.0) * 1e-3 == pytest.approx(0.5 * 4.0 * 4.0, rel=1e-9)


@pytest.mark.parametrize("step_ms", [1, 7, 10, 50, 100, 350])
def test_wind_does_not_depend_on_the_communication_step(step_ms):
    settings = {**GUSTS, "gust_size": 0.5, "gust_start": 0.1, "gust_duration": 0.9, "seed": 7}
    fine = run(started(Wind, **settings), ["velocity"], 1400, 1)
    coarse = run(started(Wind, **settings), ["velocity"], 1400, step_ms)
    assert coarse == fine[::step_ms]


@pytest.mark.interop
def test_gusts_have_the_deviations_and_the_correlation_asked_for():
    # 4000 s are 250 independent stretches of two correlation times: 5 % of a deviation.
    rows = run(started(Wind, **GUSTS), ["speed", "direction"], 4_000_000, 100)
    speed, direction = np.array(rows).T
    assert speed.mean() == pytest.approx(5.0, abs=0.15)
    assert speed.std() == pytest.approx(0.75, rel=0.15)
    assert direction.std() == pytest.approx(0.14, rel=0.15)
    away = speed - speed.mean()
    for lag in (40, 80):  # 4 and 8 s
        correlation = np.mean(away[lag:] * away[:-lag]) / speed.var()
        assert correlation == pytest.approx(math.exp(-lag / 80), abs=0.12)
    assert abs(np.corrcoef(speed, direction)[0, 1]) < 0.15


def test_gusts_start_anywhere_in_their_distribution():
    first = [started(Wind, seed=seed, **GUSTS).get("speed") for seed in range(400)]
    assert np.std(first) == pytest.approx(0.75, rel=0.1)
    assert np.mean(first) == pytest.approx(5.0, abs=0.12)


def test_speed_is_never_negative():
    rows = run(started(Wind, intensity=3.0), ["speed"], 60_000, 100)
    assert min(speed for (speed,) in rows) == 0.0
