import math

import pytest

from seatrial.devices.actuators.servo import Servo
from seatrial.errors import InputError

from .running import run, started

SHARP = {"dead_band": 0.0, "rate": 2.0}


def resting(pulse, **values):
    servo = started(Servo, pulse=pulse, **values)
    servo.advance(0.0, 5.0)
    return servo.get("angle")


@pytest.mark.parametrize(
    ("us", "degrees"), [(1100, -45), (1300, -22.5), (1500, 0), (1700, 22.5), (1900, 45)]
)
def test_pulse_to_angle(us, degrees):
    assert resting(us / 1e6, **SHARP) == pytest.approx(math.radians(degrees), abs=1e-12)
    reverse = resting(us / 1e6, reversed=1.0, **SHARP)
    assert reverse == pytest.approx(-math.radians(degrees), abs=1e-12)


@pytest.mark.parametrize(("us", "degrees"), [(600, -45), (1099, -45), (1901, 45), (2400, 45)])
def test_stops_at_the_ends_of_the_range(us, degrees):
    assert resting(us / 1e6, **SHARP) == pytest.approx(math.radians(degrees), abs=1e-12)


def test_range_that_is_not_symmetric():
    sheet = {"pulse_min": 1.0e-3, "pulse_neutral": 1.4e-3, "pulse_max": 2.0e-3, **SHARP}
    angles = {"angle_min": 0.0, "angle_max": math.pi / 2}
    for pulse, angle in [(1.0e-3, 0.0), (1.2e-3, 0.125), (1.4e-3, 0.25), (1.7e-3, 0.375)]:
        assert resting(pulse, **sheet, **angles) == pytest.approx(angle * math.pi, abs=1e-12)


@pytest.mark.parametrize("step_ms", [1, 2, 5, 10, 20, 50, 100])
def test_ramp_takes_the_time_of_the_rate(step_ms):
    # 45 degrees at 2 rad/s: 0.3927 s
    servo = started(Servo, pulse=1.9e-3, **SHARP)
    for index, (angle,) in enumerate(run(servo, ["angle"], 600, step_ms)):
        expected = min(2.0 * index * step_ms / 1000, math.pi / 4)
        assert angle == pytest.approx(expected, abs=1e-12)


def test_hobby_servo_needs_its_data_sheet_time_for_60_degrees():
    servo = started(Servo, pulse=1.9e-3, dead_band=0.0, angle_start=math.radians(-15))
    angles = [a for (a,) in run(servo, ["angle"], 400, 1)]
    assert angles[209] < math.radians(45) == pytest.approx(angles[210], abs=1e-9)


@pytest.mark.parametrize("step_ms", [1, 3, 4, 7, 10, 20, 35, 140])
def test_pulse_is_read_at_frames_only(step_ms):
    # The pulse changes at 25 ms; the frames are at 20 and 40 ms. Steps meet at 140 ms.
    servo = started(Servo, **SHARP)
    taken_at = -(-25 // step_ms) * step_ms  # the communication point from which it is seen
    frame = -(-taken_at // 20) * 20
    rows = run(servo, ["angle"], 420, step_ms, lambda t: {"pulse": 1.9e-3} if t >= 25 else {})
    for index, (angle,) in enumerate(rows):
        expected = min(max(0.0, 2.0 * (index * step_ms - frame) / 1000), math.pi / 4)
        assert angle == pytest.approx(expected, abs=1e-12)


def test_short_pulse_between_frames_is_not_seen():
    servo = started(Servo, **SHARP)
    rows = run(servo, ["angle"], 60, 1, lambda t: {"pulse": 1.9e-3 if 21 <= t < 40 else 1.5e-3})
    assert {angle for (angle,) in rows} == {0.0}


def test_dead_band_is_a_stop_short_from_both_sides():
    # 8 us of 800 us for 90 degrees: 0.9 degrees
    band = math.radians(0.9)
    assert resting(1.7e-3) == pytest.approx(math.radians(22.5) - band, abs=1e-12)
    from_above = resting(1.7e-3, angle_start=math.pi / 4)
    assert from_above == pytest.approx(math.radians(22.5) + band, abs=1e-12)
    assert resting(1.5e-3 + 7.9e-6) == 0.0
    assert resting(1.5e-3 + 9e-6) > 0.0


def test_no_pulse_holds_the_shaft_where_it_is():
    servo = started(Servo, **SHARP)
    rows = run(servo, ["angle"], 200, 1, lambda t: {"pulse": 1.9e-3 if t < 100 else 0.0})
    assert rows[100][0] == pytest.approx(0.2)
    assert {angle for (angle,) in rows[100:]} == {rows[100][0]}


def test_starts_at_its_start_angle():
    servo = started(Servo, angle_start=0.3, pulse=0.0)
    assert servo.get("angle") == 0.3


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"pulse_neutral": 2.0e-3}, "must rise"),
        ({"angle_min": 1.0}, "angle_min must be less"),
        ({"angle_start": 1.0}, "angle_start is 1.0 rad, allowed"),
    ],
)
def test_refuses_what_cannot_be(values, message):
    with pytest.raises(InputError, match=message):
        started(Servo, **values)
