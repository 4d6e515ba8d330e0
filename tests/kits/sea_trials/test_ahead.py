"""Stopping, acceleration and speed trials against closed forms."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.straight import (
    acceleration,
    bollard_pull,
    mean_of_means,
    run_speed,
    speed_power,
    speed_trial,
    stopping,
)

SPEED, LAG, COURSE = 8.0, 50.0, 0.7


def straight(time, way):
    return Record(time, way * math.cos(COURSE), way * math.sin(COURSE), np.full_like(time, COURSE))


def coasting(side=0.0):
    """Return a craft that slows down as exp(-t / LAG) from 0 s on, and drifts aside."""
    time = np.arange(-60.0, 400.0, 0.5)
    after = np.maximum(time, 0.0)
    way = SPEED * np.minimum(time, 0.0) + SPEED * LAG * (1.0 - np.exp(-after / LAG))
    off = side * (1.0 - np.exp(-after / LAG)) ** 2
    north = way * math.cos(COURSE) - off * math.sin(COURSE)
    east = way * math.sin(COURSE) + off * math.cos(COURSE)
    return Record(time, north, east, np.full_like(time, COURSE))


def test_coasting_to_a_fifth_of_the_speed():
    found = stopping(coasting(), 0.0, share=0.2)
    assert found["stopping_time"] == pytest.approx(LAG * math.log(5.0), rel=1e-3)
    assert found["track_reach"] == pytest.approx(0.8 * SPEED * LAG, rel=1e-3)
    assert found["head_reach"] == pytest.approx(0.8 * SPEED * LAG, rel=1e-3)
    assert found["heading_change"] == 0.0


def test_side_reach_is_to_starboard_and_the_track_longer_than_the_head_reach():
    found = stopping(coasting(side=30.0), 0.0, share=0.2)
    assert found["side_reach"] == pytest.approx(30.0 * 0.64, rel=1e-3)
    assert found["track_reach"] > found["head_reach"] + 0.1


def test_a_crash_stop_at_constant_deceleration():
    time = np.arange(0.0, 100.0, 0.5)
    way = SPEED * time - 0.05 * time**2
    found = stopping(straight(time, way), 0.0)
    assert found["stopping_time"] == pytest.approx(80.0, rel=1e-6)
    assert found["track_reach"] == pytest.approx(SPEED**2 / 0.2, rel=1e-6)


def test_a_craft_that_does_not_stop_says_how_fast_it_still_is():
    with pytest.raises(InputError, match=r"speed is still .* m/s is needed"):
        stopping(coasting(), 0.0)


def test_a_craft_at_rest_cannot_be_stopped():
    time = np.arange(0.0, 10.0, 0.5)
    with pytest.raises(InputError, match="does not move ahead"):
        stopping(straight(time, 0.0 * time), 0.0)


def test_acceleration_to_ninety_percent():
    time = np.arange(0.0, 500.0, 0.5)
    found = acceleration(straight(time, SPEED * (time - LAG * (1 - np.exp(-time / LAG)))), 0.0)
    at = LAG * math.log(10.0)
    assert found["acceleration_time"] == pytest.approx(at, rel=1e-3)
    assert found["acceleration_distance"] == pytest.approx(SPEED * (at - 0.9 * LAG), rel=1e-3)


def test_an_acceleration_that_ends_in_ripples_has_the_figures_of_its_mean():
    time = np.arange(0.0, 500.0, 0.5)
    ripple, period = 0.02, 7.0
    way = SPEED * (time - LAG * (1 - np.exp(-time / LAG)))
    way += ripple * SPEED * period / (2 * math.pi) * np.sin(2 * math.pi * time / period)
    found = acceleration(straight(time, way), 0.0)
    assert found["final_speed"] == pytest.approx(SPEED, rel=2e-3)  # the last ripple is not whole
    slowest = LAG * math.log(1.0 / (0.1 - 1.5 * ripple))  # between the crests of the ripple
    assert LAG * math.log(1.0 / (0.1 + 1.5 * ripple)) < found["acceleration_time"] < slowest


def test_an_acceleration_that_goes_on_is_refused():
    time = np.arange(0.0, 60.0, 0.5)
    with pytest.raises(InputError, match="speed still changes"):
        acceleration(straight(time, SPEED * (time - LAG * (1 - np.exp(-time / LAG)))), 0.0)


@pytest.mark.parametrize("tide", [(0.4,), (0.4, 0.1), (0.4, -0.3, 0.05)])
def test_the_mean_of_means_removes_a_tide_that_is_a_polynomial(tide):
    runs = np.arange(len(tide) + 1)
    speeds = SPEED + (-1.0) ** runs * np.polynomial.polynomial.polyval(runs, tide)
    assert mean_of_means(speeds) == pytest.approx(SPEED, rel=1e-12)


def test_one_run_has_no_mean_of_means():
    with pytest.raises(InputError, match="two runs"):
        mean_of_means([8.0])


def test_a_cubic_speed_power_curve():
    speeds = np.array([4.0, 6.0, 8.0])
    assert speed_power(speeds, 120.0 * speeds**3) == pytest.approx((120.0, 3.0))


@pytest.mark.parametrize("sides", [(0.3, 0.0), (0.3, 0.2)])
def test_a_speed_trial_in_a_current_has_the_speeds_through_the_water(sides):
    along, across = sides
    time = np.arange(0.0, 401.0, 1.0)
    speed = np.where(time < 200.0, 8.0, 6.0)
    corners = [[100.0 * n - 5.0, 100.0 * n + 5.0] for n in (1, 2, 3)]
    turned = np.interp(time, np.ravel(corners), np.pi * np.array([0, 1, 1, 2, 2, 3]))
    course = COURSE + turned
    north = np.cumsum(speed * np.cos(course) + along * np.cos(COURSE) - across * np.sin(COURSE))
    east = np.cumsum(speed * np.sin(course) + along * np.sin(COURSE) + across * np.cos(COURSE))
    rec = Record(time, north, east, course, power=20.0 * speed**3)
    found = speed_trial(rec, [(100.0 * n + 20.0, 100.0 * n + 80.0) for n in range(4)])
    assert (found["speed_1"], found["speed_2"]) == pytest.approx((8.0, 6.0), rel=1e-6)
    assert found["power_1"] == pytest.approx(20.0 * 8.0**3)
    assert found["speed_power_exponent"] == pytest.approx(3.0, rel=1e-5)
    assert found["power_at_unit_speed"] == pytest.approx(20.0, rel=1e-4)


def test_a_speed_trial_without_power_has_speeds_and_says_so():
    time = np.arange(0.0, 200.0, 1.0)
    found = speed_trial(straight(time, 5.0 * time), [(0.0, 50.0), (60.0, 100.0)])
    assert found["speed_1"] == pytest.approx(5.0)
    assert found.missing["power_at_unit_speed"] == "the record has no power"
    with pytest.raises(InputError, match="runs by twos are needed, found 1"):
        speed_trial(straight(time, 5.0 * time), [(0.0, 50.0)])


def test_the_bollard_pull_is_that_after_the_surge_into_the_line():
    time = np.arange(0.0, 400.0, 0.5)
    swing = 1.0 - np.exp(-0.05 * time) * np.cos(0.5 * time)
    found = bollard_pull(Record(time, 0.0 * time, 0.0 * time, 0.0 * time, pull=240.0 * swing), 0.0)
    assert found["bollard_pull"] == pytest.approx(240.0, rel=1e-4)
    # The first overshoot of e^-at (cos bt): at bt = pi - atan(a/b).
    at = (math.pi - math.atan(0.1)) / 0.5
    peak = 240.0 * (1.0 - math.exp(-0.05 * at) * math.cos(0.5 * at))
    assert found["largest_pull"] == pytest.approx(peak, rel=1e-2)


def test_speed_and_power_over_a_mile():
    time = np.arange(0.0, 100.0, 1.0)
    rec = Record(time, 5.0 * time, 0.0 * time, 0.0 * time, power=1e3 + 10.0 * time)
    found = run_speed(rec, 20.0, 60.0)
    assert found["speed_over_ground"] == pytest.approx(5.0)
    assert found["power"] == pytest.approx(1400.0)
    with pytest.raises(InputError, match="times from 0 to 99 s"):
        run_speed(rec, 20.0, 160.0)
