import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.kinematics import to_ned
from seatrial.physics.environment.downwash import Downwash

WEIGHT = 10 * 9.81  # N
STEP = 1e-9  # s, the grain of time


def downwash(**changes):
    component = Downwash()
    for name, value in changes.items():
        component.set(name, value)
    return component


def running(**changes):
    component = downwash(**changes)
    component.initialise()
    component.begin()
    return component


def test_ground_effect_is_full_on_the_deck_and_none_far_away():
    component = downwash(k0=0.6)
    assert component.ground_effect(0.0) == 1.6
    assert component.ground_effect(1e6) == 1.0
    # one diameter per decay: 1/e of the gain
    assert component.ground_effect(0.1) == pytest.approx(1 + 0.6 / math.e, rel=1e-15)


@pytest.mark.parametrize("model", ["source", "consistent"])
def test_load_after_contact_is_the_weight_exactly(model):
    component = downwash(load_model=model)
    assert component.load_at(4.0) == component.load_at(1e4) == WEIGHT


def test_landing_meets_the_deck_without_speed_and_with_full_ground_effect():
    component = downwash()
    assert component.load_at(4.0 - STEP) == pytest.approx(1.6 * WEIGHT, rel=1e-8)
    assert component.height_at(0.0) == 2.0
    assert component.height_at(2.0) == pytest.approx(1.0, rel=1e-15)
    assert component.height_at(4.0 - 1e-4) == pytest.approx(0.0, abs=1e-11)


def test_landing_thrust_follows_the_acceleration_of_the_descent():
    component = downwash(load_model="consistent", wake_length=1e9)  # all the wake meets the deck
    h = 1e-3
    for t in (0.5, 1.0, 2.5, 3.5):
        heights = [component.height_at(t + k * h) for k in (-1, 0, 1)]
        acceleration = (heights[0] - 2 * heights[1] + heights[2]) / h**2
        assert component.load_at(t) == pytest.approx(10 * (9.81 + acceleration), abs=1e-4)


def test_before_time_zero_it_hovers_at_the_initial_height():
    component = downwash(load_model="consistent", wake_length=1e9)
    assert component.height_at(-1.0) == 2.0
    assert component.load_at(-1.0) == pytest.approx(WEIGHT, rel=1e-12)


def test_take_off_of_the_source_adds_wake_to_weight():
    component = downwash(phase="takeoff")
    assert component.load_at(10.0 - STEP) == WEIGHT
    assert component.load_at(10.0) == pytest.approx(2.6 * WEIGHT, rel=1e-15)
    assert component.load_at(10.5 - STEP) == pytest.approx(2.6 * WEIGHT, rel=1e-15)
    assert component.load_at(10.5) == pytest.approx(1.6 * 10 * 10.81, rel=1e-15)


def test_after_lift_off_the_wake_dies_out_with_height():
    component = downwash(phase="takeoff")
    height = 0.5 * 1.0 * 1.5**2
    gain = 1 + 0.6 * math.exp(-4 * height / 0.4)
    expected = math.exp(-(height**2)) * gain * 10 * 10.81
    assert component.height_at(12.0) == height
    assert component.load_at(12.0) == pytest.approx(expected, rel=1e-14)
    assert component.load_at(1e9) == 0.0


def test_take_off_of_the_consistent_load_keeps_the_weight_until_lift_off():
    component = downwash(phase="takeoff", load_model="consistent")
    assert component.load_at(10.5 - STEP) == WEIGHT
    assert component.load_at(10.5) == pytest.approx(108.1, rel=1e-15)


def test_spool_up_raises_the_thrust_linearly():
    component = downwash(phase="takeoff", spool_up_time=0.2, k0=0.5)
    assert component.load_at(10.0) == WEIGHT
    assert component.load_at(10.05) == pytest.approx(WEIGHT * (1 + 1.5 * 0.25), rel=1e-12)
    assert component.load_at(10.3) == pytest.approx(WEIGHT * 2.5, rel=1e-15)


def test_breaks_are_where_the_load_jumps_or_bends():
    assert downwash().breaks() == [4.0]
    assert downwash(phase="takeoff").breaks() == [10.0, 10.5]
    assert downwash(phase="takeoff", spool_up_time=0.2).breaks() == [10.0, 10.2, 10.5]
    assert downwash(phase="takeoff", spool_up_time=0.7).breaks() == [10.0, 10.5]
    assert downwash(phase="takeoff", lift_off_time=10.0).breaks() == [10.0]
    assert downwash(phase="takeoff", load_model="consistent").breaks() == [10.5]


def test_body_direction_gives_the_wrench_of_the_source():
    component = downwash(pad=(-0.319, -0.25, -0.2), direction="body-z")
    force, moment = component.wrench(5.0, (0.3, -0.2, 1.0))
    assert force == (0.0, 0.0, WEIGHT)
    assert moment == (-0.25 * WEIGHT, 0.319 * WEIGHT, 0.0)


def test_vertical_direction_is_a_weight_at_the_pad():
    pad, attitude = (0.319, 0.25, -0.2), (0.3, -0.2, 1.0)
    component = downwash(pad=pad, direction="vertical")
    force, moment = component.wrench(5.0, attitude)
    assert to_ned(attitude, force) == pytest.approx((0.0, 0.0, WEIGHT), abs=1e-13)
    lever = to_ned(attitude, pad)
    expected = (lever[1] * WEIGHT, -lever[0] * WEIGHT, 0.0)  # no moment about the vertical
    assert to_ned(attitude, moment) == pytest.approx(expected, abs=1e-13)


def test_outputs_say_load_height_and_contact():
    component = running(pad=(0.0, 0.25, -0.2))
    assert component.get("on_deck") is False
    for k in range(400):
        component.advance(k * 0.01, 0.01)
    assert component.get("on_deck") is True
    assert component.get("load") == WEIGHT
    assert component.get("height") == 0.0
    assert component.get("force") == [0.0, 0.0, WEIGHT]
    assert component.get("moment") == [0.25 * WEIGHT, 0.0, 0.0]


def test_switches_come_on_the_instant_although_steps_do_not_add_up_in_doubles():
    component = running(phase="takeoff")
    t, off_deck = 0.0, []
    for _ in range(110):
        component.advance(t, 0.1)
        t += 0.1
        if not component.get("on_deck"):
            off_deck.append(component.now)
    assert off_deck[0] == 10.5
    assert t != 11.0


def test_outputs_follow_the_attitude_at_once():
    component = running(direction="vertical", pad=(0.0, 0.0, -0.2))
    component.set("attitude", (0.1, 0.0, 0.0))
    load = component.get("load")
    assert component.get("force.y") == pytest.approx(load * math.sin(0.1), rel=1e-14)
    assert component.get("moment.x") == pytest.approx(0.2 * load * math.sin(0.1), rel=1e-14)


def test_lift_off_before_spool_up_is_refused():
    with pytest.raises(InputError, match="lift_off_time"):
        running(phase="takeoff", lift_off_time=9.0)
    running(phase="takeoff", lift_off_time=9.0, load_model="consistent")


def test_unknown_phase_is_refused():
    with pytest.raises(InputError, match="landing"):
        running(phase="take-off")


def test_load_is_continuous_but_at_its_breaks():
    for changes in ({}, {"phase": "takeoff", "spool_up_time": 0.3}):
        component = downwash(**changes)
        t = np.arange(0, 15, 1e-3)
        jumps = np.abs(np.diff([component.load_at(time) for time in t]))
        away = np.min(np.abs(t[1:, None] - np.array(component.breaks())), axis=1) > 2e-3
        assert jumps[away].max() < 1.0
        assert jumps.max() > 50.0
