"""Everything that takes or gives servo pulses: speed controllers, drivers, a pulse of zero."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.devices.actuators.esc import Esc
from seatrial.devices.actuators.esc_driver import EscDriver
from seatrial.devices.actuators.servo import Servo
from seatrial.devices.actuators.servo_driver import ServoDriver
from seatrial.devices.actuators.thruster import Thruster
from seatrial.errors import InputError
from seatrial.fmi.components.source import shipped_sources

from .running import started

UNEVEN = {"pulse_min": 1.0e-3, "pulse_neutral": 1.4e-3, "pulse_max": 2.0e-3}


def share(pulse, **values):
    return started(Esc, pulse=pulse, **values).get("share")


@pytest.mark.parametrize(
    ("us", "expected"), [(1000, -1), (1200, -0.5), (1400, 0), (1700, 0.5), (2000, 1)]
)
def test_the_share_is_linear_on_either_side_of_neutral(us, expected):
    assert share(us / 1e6, **UNEVEN) == pytest.approx(expected, abs=1e-12)
    assert share(us / 1e6, **UNEVEN, reversed=1.0) == pytest.approx(-expected, abs=1e-12)


@pytest.mark.parametrize(("us", "expected"), [(1, -1), (900, -1), (2100, 1), (30000, 1)])
def test_pulses_outside_the_range_are_held_at_its_ends(us, expected):
    assert share(us / 1e6, **UNEVEN) == expected


def test_the_dead_band_is_about_neutral():
    band = {"dead_band": 25e-6}
    assert [share(us / 1e6, **band) for us in (1476, 1500, 1524)] == [0.0, 0.0, 0.0]
    assert share(1.526e-3, **band) == pytest.approx(26 / 400, abs=1e-12)
    assert share(1.474e-3, **band) == pytest.approx(-26 / 400, abs=1e-12)


def test_the_share_follows_the_pulse_at_once():
    esc = started(Esc)
    assert esc.get("share") == 0.0
    esc.set("pulse", 1.9e-3)
    assert esc.get("share") == 1.0


def ranges(low, high):
    return st.tuples(*[st.floats(low, high)] * 3).map(sorted)


@given(
    ranges(0.5e-3, 2.5e-3).filter(lambda p: p[1] - p[0] > 1e-4 and p[2] - p[1] > 1e-4),
    st.tuples(st.floats(-2, 2), st.floats(0.1, 3)),
    st.floats(-0.2, 1.2),
    st.sampled_from([0.0, 1.0]),
)
def test_a_driver_is_the_inverse_of_its_servo(pulses, angles, place, reverse):
    low, high = angles[0], angles[0] + angles[1]
    values = dict(zip(UNEVEN, pulses, strict=True))
    values |= {"angle_min": low, "angle_max": high, "reversed": reverse}
    wanted = low + place * (high - low)
    pulse = started(ServoDriver, **values, angle=wanted).get("pulse")
    assert pulses[0] - 1e-15 <= pulse <= pulses[2] + 1e-15
    servo = started(
        Servo, **values, pulse=pulse, angle_start=low, dead_band=0.0, rate=10.0, period=1e-3
    )
    servo.advance(0.0, 1.0)
    held = min(max(wanted, low), high)
    # Relative to the range: an angle near 0 is a difference of larger ones.
    assert abs(servo.get("angle") - held) < 1e-12 * (high - low + abs(low) + abs(high))


@given(
    ranges(0.5e-3, 2.5e-3).filter(lambda p: p[1] - p[0] > 1e-4 and p[2] - p[1] > 1e-4),
    st.floats(-1.5, 1.5),
    st.sampled_from([0.0, 1.0]),
)
def test_a_speed_controller_gives_the_share_that_its_driver_is_given(pulses, wanted, reverse):
    values = {**dict(zip(UNEVEN, pulses, strict=True)), "reversed": reverse}
    pulse = started(EscDriver, **values, share=wanted).get("pulse")
    assert share(pulse, **values) == pytest.approx(min(max(wanted, -1.0), 1.0), abs=1e-11)


def test_a_share_within_the_dead_band_stops():
    pulse = started(EscDriver, share=0.05).get("pulse")
    assert share(pulse, dead_band=25e-6) == 0.0


@pytest.mark.parametrize("cls", [Esc, EscDriver, ServoDriver, Servo, Thruster])
def test_pulses_that_do_not_rise_are_refused(cls):
    with pytest.raises(InputError, match="pulse_min, pulse_neutral and pulse_max must rise"):
        started(cls, pulse_min=1.5e-3)


def test_angles_that_do_not_rise_are_refused():
    with pytest.raises(InputError, match="angle_min must be less than angle_max"):
        started(ServoDriver, angle_min=1.0, angle_max=1.0)


def takers_of_pulses():
    classes = [source.component_class() for source in shipped_sources().values()]
    return [
        cls
        for cls in classes
        if "seatrial.devices." in cls.__module__
        and getattr(cls.ports.get("pulse"), "kind", "") == "input"
    ]


def test_all_actuators_that_take_pulses_are_tried_here():
    assert {cls.__name__ for cls in takers_of_pulses()} == {"Esc", "Servo", "Thruster"}


@pytest.mark.parametrize("neutral", [1.3e-3, 1.5e-3, 1.7e-3])
def test_a_pulse_of_zero_stops_a_thruster(neutral):
    values = {"pulse_neutral": neutral}
    assert share(0.0, **values) == 0.0
    thruster = started(Thruster, **values, pulse=0.0)
    thruster.advance(0.0, 1.0)
    assert (thruster.get("thrust"), thruster.get("current")) == (0.0, 0.0)


@pytest.mark.parametrize("angle", [-0.3, 0.0, 0.2])
def test_a_pulse_of_zero_leaves_a_shaft_where_it_is(angle):
    servo = started(Servo, pulse=0.0, angle_start=angle)
    servo.advance(0.0, 1.0)
    assert servo.get("angle") == angle
    servo.set("pulse", 1.9e-3)
    servo.advance(1.0, 1.0)
    assert servo.get("angle") == pytest.approx(math.pi / 4, abs=0.02)
