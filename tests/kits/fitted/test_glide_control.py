"""Saw-tooth of a glider: its turns at two depths, the moving mass, and who acts."""

import math

import pytest

from seatrial.errors import InputError
from seatrial_kits.fitted.control.glide_control import GlideControl
from tests.devices.running import started

DEPTH, HEADING, NONE = [True, True, True], [False, True, False], [False, False, False]
GLIDE = {"glide_pitch": 0.4, "buoyancy": 0.6, "climb_to": 5.0, "dive_to": 10.0}
GLIDE |= {"depth_wanted": 20.0}


def control(**values):
    return started(GlideControl, **{"engaged": DEPTH, **GLIDE, **values})


def test_it_dives_and_climbs_between_both_depths():
    glide, found = control(depth=10.0), []
    for k, depth in enumerate((10.0, 19.9, 20.0, 15.0, 5.1, 5.0, 10.0, 25.0, 2.0)):
        glide.set("depth", depth)
        found.append(glide.get("dives"))
        sign = -1.0 if found[-1] else 1.0
        assert glide.get("pitch_ordered") == sign * 0.4
        assert glide.get("buoyancy_order") == sign * 0.6
        glide.advance(0.1 * k, 0.1)
    assert found == [True, True, False, False, False, True, True, False, True]


def test_a_depth_wanted_at_the_surface_is_a_climb():
    glide = control(depth=2.0, depth_wanted=0.0)
    assert not glide.get("dives")
    assert glide.get("buoyancy_order") == 0.6


def test_a_shallow_depth_is_a_dive_to_the_least_one():
    dives = [control(depth=d, depth_wanted=1.0).get("dives") for d in (2.0, 9.9, 10.0)]
    assert dives == [True, True, False]


def test_depths_that_do_not_go_together_are_refused():
    with pytest.raises(InputError, match=r"climb_to is 10\.0 m, not above dive_to, 10\.0 m"):
        control(climb_to=10.0)


def test_the_mass_gives_the_moment_that_is_asked_for():
    # m g x of 9 kg within 5 cm: order 1 is 4.41 N.m, bow down.
    glide = control(depth=10.0, capacity=9 * 9.8 * 0.05, rate_limit=1.0)
    for k in range(100):
        assert glide.get("mass_order") == pytest.approx(-glide.get("pitch_moment") / 4.41)
        glide.advance(0.1 * k, 0.1)
    assert glide.get("mass_order") == 1.0  # it has not pitched down: all the way ahead


@pytest.mark.parametrize(
    ("pitch", "order"), [(-0.4, 0.5), (0.4, -0.5), (-0.2, 0.25), (0.0, 0.0), (-1.0, 0.5)]
)
def test_a_turn_to_starboard_is_a_bank_to_starboard_in_a_dive_alone(pitch, order):
    glide = control(pitch=pitch, yaw_moment=0.3, yaw_capacity=0.6)
    assert glide.get("roll_order") == pytest.approx(order)
    glide.set("yaw_moment", -3.0)
    assert glide.get("roll_order") == pytest.approx(-2 * order)


def test_manual_heave_has_ballast_and_pitch_and_a_glider_that_is_not_armed_rests():
    dive = [0.0, 0.0, 0.0, 0.5]
    held = control(engaged=HEADING, direct=dive, pitch_limit=0.5)
    assert held.get("buoyancy_order") == -0.5
    assert held.get("pitch_ordered") == -0.25
    direct = control(engaged=NONE, direct=dive)
    assert direct.get("mass_order") == 0.5
    rests = control(engaged=NONE)
    assert [rests.get(name) for name in ("buoyancy_order", "mass_order")] == [0.0, 0.0]


def test_without_a_depth_it_waits():
    waits = control(depth_valid=False, pitch=math.radians(-20))
    assert [waits.get(name) for name in ("buoyancy_order", "pitch_moment")] == [0.0, 0.0]
