import math

import pytest

from seatrial.devices.actuators.angle_servo import AngleServo
from seatrial.errors import InputError

from .running import run, started

DEG = math.radians(1.0)


def test_moves_at_its_instants_by_the_rate():
    # 60 deg/s every 20 ms: 1.2 degrees, the first of them at the start.
    servo = started(AngleServo, rate=60 * DEG, command=5 * DEG)
    angles = [angle / DEG for (angle,) in run(servo, ["angle"], 120, 10)]
    expected = [1.2, 1.2, 2.4, 2.4, 3.6, 3.6, 4.8, 4.8, 5.0, 5.0, 5.0, 5.0, 5.0]
    assert angles == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("step_ms", [1, 4, 20, 60])
def test_moves_alike_whatever_the_communication_step(step_ms):
    fine, coarse = (
        run(started(AngleServo, rate=1.0, command=-0.3), ["angle"], 420, step)
        for step in (1, step_ms)
    )
    assert coarse == fine[::step_ms]


def test_answers_a_command_at_once_and_the_last_one_of_an_instant_counts():
    servo = started(AngleServo, rate=10.0, command=0.1)
    assert servo.get("angle") == 0.1
    servo.set("command", -0.15)
    assert servo.get("angle") == -0.15
    servo.advance(0.0, 0.01)
    servo.set("command", 0.1)  # between two instants
    assert servo.get("angle") == -0.15


@pytest.mark.parametrize(("command", "end"), [(9.0, 0.2), (-9.0, -0.1)])
def test_stops_at_the_ends_of_the_range(command, end):
    servo = started(AngleServo, command=command, angle_min=-0.1, angle_max=0.2)
    assert run(servo, ["angle"], 1000, 20)[-1] == [end]


def test_starts_from_its_start_angle():
    servo = started(AngleServo, angle_start=0.5, rate=1.0, command=0.0)
    assert servo.get("angle") == pytest.approx(0.48, rel=1e-15)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"angle_min": 2.0}, "angle_min must be less than angle_max, got 2.0"),
        ({"angle_start": 2.0}, "angle_start is 2.0 rad, allowed"),
    ],
)
def test_refuses_what_cannot_be(values, message):
    with pytest.raises(InputError, match=message):
        started(AngleServo, **values)
