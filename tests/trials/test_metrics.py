"""Metrics of records in criteria, against closed forms."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trial.criteria.criteria import parse

TIME = np.round(np.arange(0, 20.005, 0.01), 9)
ZETA, OMEGA = 0.3, 1.0
DAMPED = OMEGA * math.sqrt(1 - ZETA**2)
UNITS = {
    "a.x": "m", "a.y": "m", "a.v": "m/s", "a.phi": "rad", "a.step": "m", "a.psi": "rad",
    "a.north": "m", "a.east": "m",
}  # fmt: skip
SIGNALS = {
    "a.x": np.sin(TIME),
    "a.y": 0.5 * TIME,
    "a.v": np.cos(TIME),
    "a.phi": np.radians(10.0) * (1 - np.exp(-TIME / 2.0)),
    "a.step": 1
    - np.exp(-ZETA * OMEGA * TIME)
    * (np.cos(DAMPED * TIME) + ZETA * OMEGA / DAMPED * np.sin(DAMPED * TIME)),
    "a.psi": np.radians(405.0) + 0.0 * TIME,
    # A circle of 5 m about the corner of a path that comes from the south and goes east.
    "a.north": 5 * np.cos(math.pi * TIME / 10),
    "a.east": 5 * np.sin(math.pi * TIME / 10),
}


def evaluate(text, time=TIME, signals=SIGNALS):
    return parse(text).evaluate(time, signals, UNITS)


@pytest.mark.parametrize(
    ("expression", "unit", "expected"),
    [
        ("rms(a.x)", "m", math.sqrt(0.5 - math.sin(40.0) / 80.0)),
        ("mean(a.y)", "m", 5.0),
        ("mean(a.y after 10 s)", "m", 7.5),
        ("mean(a.y from 2 s to 4 s)", "m", 1.5),
        ("std(a.y)", "m", 10 / math.sqrt(12)),
        ("integral(a.v)", "m", math.sin(20.0)),
        ("integral(a.v from 1 s to 2 s)", "m", math.sin(2.0) - math.sin(1.0)),
        ("percentile(a.y, 95 %)", "m", 9.5),
        ("crossings(a.x, 0 m)", "1", 6.0),
        ("time_above(a.x, 0.5 m)", "s", 2 * math.pi + 20 - (6 * math.pi + math.pi / 6)),
        ("time_below(a.x, -0.5 m)", "s", 2 * math.pi),
        ("overshoot(a.step, 1 m)", "1", math.exp(-math.pi * ZETA / math.sqrt(1 - ZETA**2))),
        ("rise_time(a.phi, 10 deg)", "s", 2 * math.log(9)),
        ("settling_time(a.phi, 10 deg, 0.5 deg)", "s", 2 * math.log(20)),
        ("max(rms(a.x), mean(a.y)) * 2", "m", 10.0),
    ],
)
def test_of_closed_forms(expression, unit, expected):
    bound = "0" if unit == "1" else f"0 {unit}"
    verdict = evaluate(f"{expression} > {bound}")
    assert verdict.passed is (expected > 0)
    assert verdict.worst == pytest.approx(expected, rel=2e-5)  # trapezia of 10 ms
    assert verdict.unit == unit
    assert verdict.time is None
    assert verdict.detail.endswith(f"limit {bound}")


@pytest.mark.parametrize(
    ("text", "passed"),
    [
        ("abs(derivative(a.x) - a.v) < 1 mm/s from 1 s to 19 s", True),
        ("abs(a.psi - 45 deg) < 1 deg", False),
        ("abs(wrap(a.psi - 45 deg)) < 1e-9 deg", True),
        ("abs(wrap(a.psi - 225 deg)) > 179.9 deg", True),
        ("abs(atan2(sin(a.phi), cos(a.phi)) - a.phi) < 1e-9 rad", True),
        ("abs(tan(a.phi) * cos(a.phi) - sin(a.phi)) < 1e-12", True),
        ("abs(sqrt(a.north * a.north + a.east * a.east) - 5 m) < 1e-9 m", True),
        ("always (rms(a.x) < 1 m and a.y <= 10 m)", True),
        ("mean(a.y) < 2 m or a.y >= 0 m", True),
    ],
)
def test_of_single_points(text, passed):
    assert evaluate(text).passed is passed


def test_distance_from_a_path():
    path = "cross_track(a.north, a.east, -10 m, 0 m, 0 m, 0 m, 0 m, 10 m)"
    # North of the corner the path is 5 m away, on its legs 0 m, between them |5 sin| or |5 cos|.
    assert evaluate(f"{path} <= 5.000001 m").passed
    for at, distance in (("0 s", 5.0), ("5 s", 0.0), ("10 s", 0.0), ("7.5 s", 5 / math.sqrt(2))):
        assert evaluate(f"abs({path} - {distance} m) < 1e-6 m from {at} to {at}").passed


def test_a_metric_has_a_margin_and_a_verdict_of_the_whole_record():
    verdict = evaluate("rms(a.x after 10 s) < 0.5 m")
    assert not verdict.passed
    expected = math.sqrt(0.5 - (math.sin(40.0) - math.sin(20.0)) / 40.0)
    assert verdict.robustness == pytest.approx(1 - expected / 0.5, rel=1e-4)
    assert verdict.detail == "0.71 m, limit 0.5 m"


@pytest.mark.parametrize(
    "text",
    [
        "mean(a.y from 5 s to 30 s) < 99 m",  # beyond the end
        "mean(a.y after 30 s) < 99 m",
        "settling_time(a.x, 0 m, 0.1 m) < 99 s",  # never
        "rise_time(a.x, 3 m) < 99 s",
    ],
)
def test_what_the_record_does_not_give_does_not_pass(text):
    verdict = evaluate(text)
    assert not verdict.passed
    assert "the expression is" in verdict.detail


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("abs(a.x after 5 s) < 1 m", "abs is of single points: it takes no 'after'"),
        ("derivative(a.x after 5 s) < 1 m/s", "derivative has a value at every point"),
        ("sin(a.x) < 1", "'sin' needs an angle, got a.x in 'm'"),
        ("wrap(a.x) < 1 m", "'wrap' needs an angle"),
        ("percentile(a.y, 95) < 1 m", "percentile needs a share from 0 to 100 %"),
        ("percentile(a.y, 1 m) < 1 m", "percentile needs a share from 0 to 100 %"),
        ("mean(a.y) < 1 s", "'<' needs values of one kind"),
        ("integral(a.v) < 1 m/s", "'<' needs values of one kind"),
        ("overshoot(a.x, 1 s) < 10 %", "'overshoot' needs values of one kind"),
        ("settling_time(a.x, 1 m, 1 s) < 1 s", "'settling_time' needs values of one kind"),
        ("mean(a.x, a.y) < 1 m", "mean takes one value, got 2"),
        ("cross_track(a.north, a.east, 1 m) < 1 m", "north and east of each place"),
        ("cross_track(a.north, a.east, a.x, 1 m) < 1 m", "north and east of each place"),
        ("mean(a.x from 5 s to 4 s) < 1 m", "the interval ends at 4 s, before it starts at 5 s"),
        ("median(a.x) < 1 m", "column 1: found 'median'"),
    ],
)
def test_mistakes_are_named(text, said):
    with pytest.raises(InputError) as caught:
        evaluate(text)
    assert said in str(caught.value)


def test_metrics_of_rows_that_are_not_evenly_spaced_are_of_time():
    time = np.array([0.0, 1.0, 1.5, 1.75, 4.0])
    signals = {**dict.fromkeys(SIGNALS, 0.0 * time), "a.y": 0.5 * time}
    assert evaluate("mean(a.y) > 0 m", time, signals).worst == pytest.approx(1.0, rel=1e-12)
    assert evaluate("rms(a.y) > 0 m", time, signals).worst == pytest.approx(2 / math.sqrt(3))
