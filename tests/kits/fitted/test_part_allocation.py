"""Allocation to parts: the laws of the parts, written once more, give what was asked for."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from seatrial.errors import InputError
from seatrial_kits.fitted.allocation.allocated_parts import BY_SPEED
from seatrial_kits.fitted.allocation.part_allocation import PartAllocation
from seatrial_kits.fitted.parts.slots import PROPULSORS
from tests.devices.running import started
from tests.kits.fitted.allocated import (
    ENDLESS,
    OSV,
    ROV,
    WAMV,
    allocated,
    finned,
    later,
    slots,
    wrench,
)

SURGE, SWAY, HEAVE, ROLL, PITCH, YAW = range(6)
FINS = {"cross": (0, 90, 180, 270), "X": (45, 135, 225, 315), "three": (0, 120, 240)}


def near(found, expected, scale):
    np.testing.assert_allclose(found, expected, atol=1e-6 * scale)


# ---------------------------------------------------------------------- what the parts can give


@given(st.floats(-1.2e5, 1.2e5), st.floats(-1.2e5, 1.2e5), st.floats(-3e6, 3e6))
def test_a_supply_ship_is_given_what_is_asked_for(surge, sway, yaw):
    found = wrench(allocated(OSV, surge=surge, sway=sway, yaw_moment=yaw))
    near(found[[SURGE, SWAY]], [surge, sway], 4e5)
    near(found[YAW], yaw, 1e7)


@given(*[st.floats(-10, 10)] * 3, *[st.floats(-1, 1)] * 3)
def test_six_axes_are_given_by_eight_thrusters(surge, sway, heave, roll, pitch, yaw):
    moments = {"roll_moment": roll, "pitch_moment": pitch, "yaw_moment": yaw}
    found = wrench(allocated(ROV, surge=surge, sway=sway, heave=heave, **moments))
    near(found, [surge, sway, heave, roll, pitch, yaw], 100.0)


@given(st.floats(-80, 200), st.floats(-60, 60))
def test_two_outboards_give_surge_and_yaw(surge, yaw):
    found = wrench(allocated(WAMV, surge=surge, yaw_moment=yaw))
    near(found[[SURGE, YAW]], [surge, yaw], 1e3)


@pytest.mark.parametrize("tail", FINS)
@pytest.mark.parametrize("axis", [ROLL, PITCH, YAW])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_tail_gives_moments_about_one_axis_alone(tail, axis, way):
    names = {ROLL: "roll_moment", PITCH: "pitch_moment", YAW: "yaw_moment"}
    craft = finned(FINS[tail], "surge roll pitch yaw", speed=1.5)
    found = wrench(allocated(craft, surge=4.0, **{names[axis]: 0.4 * way}))
    expected = np.zeros(6)
    expected[[SURGE, axis]] = 4.0, 0.4 * way
    near(found[[SURGE, ROLL, PITCH, YAW]], expected[[SURGE, ROLL, PITCH, YAW]], 10.0)


def test_a_positive_rudder_aft_turns_to_starboard_and_a_positive_stern_plane_dives():
    craft = finned(FINS["cross"][:2], "surge pitch yaw", speed=2.0)
    rudder, plane = allocated(craft, yaw_moment=0.5, pitch_moment=-0.5).get("foil_angle")[:2]
    assert rudder == pytest.approx(plane, rel=1e-6)
    assert rudder > 0.0


@pytest.mark.parametrize("speed", [0.0, 0.29, -2.0])
def test_fins_lie_amidships_without_steerage_way(speed):
    craft = finned(FINS["X"], "surge pitch yaw", speed=speed)
    assert allocated(craft, pitch_moment=1.0, yaw_moment=1.0).get("foil_angle") == [0.0] * 8


@given(st.floats(0.5, 4.0), st.floats(-0.05, 0.05))
def test_angles_of_fins_go_by_the_dynamic_pressure(speed, moment):
    craft = finned(FINS["X"], "surge pitch yaw")
    at_one, found = (
        np.array(allocated(craft, speed=s, pitch_moment=moment).get("foil_angle"))
        for s in (1.0, speed)
    )
    np.testing.assert_allclose(found, at_one / speed**2, rtol=1e-5, atol=1e-12)


def test_a_tunnel_gives_less_under_way_and_nothing_at_its_fading_speed():
    place = {"position": [3, 0, 0], "axis": [0, 1, 0], "thrust": [100, 100], "fading_speed": 2.0}
    craft = slots([("tunnel", place)], axes="sway")
    for speed in (0.0, 1.0, -1.5):
        order = allocated(craft, sway=20.0, speed=speed).get("propulsor_order")[0]
        assert order == pytest.approx(0.2 / (1 - (speed / 2) ** 2), rel=1e-6)
    assert allocated(craft, sway=20.0, speed=2.5).get("propulsor_order")[0] == 0.0


@pytest.mark.parametrize(
    ("kind", "exponent", "root"), [("thruster", 1.0, 1.0), ("thruster", 1.5, 1.5)]
    + [(kind, 1.0, 2.0) for kind in ("propeller", "wageningen-b", "four-quadrant")],
)  # fmt: skip
def test_orders_invert_the_law_of_thrust(kind, exponent, root):
    craft = slots([(kind, {"thrust": [40, 10], "exponent": exponent})], axes="surge")
    for surge, share in ((10.0, 0.25), (-4.0, -0.4), (100.0, 1.0), (-100.0, -1.0)):
        order = allocated(craft, surge=surge).get("propulsor_order")[0]
        assert order == pytest.approx(math.copysign(abs(share) ** (1 / root), share), rel=1e-6)


def test_an_axis_that_is_not_asked_for_takes_what_comes():
    alone = wrench(allocated({**ROV, "axes": "surge yaw"}, surge=20.0, heave=30.0))
    near(alone, [20.0, 0.0, 0.0, 0.0, 0.085 * 20.0, 0.0], 100.0)


# ---------------------------------------------------------------------- what is beyond them


@settings(max_examples=40)
@given(st.lists(st.floats(-1e7, 1e7), min_size=3, max_size=3), st.sampled_from(["OSV", "WAMV"]))
def test_no_limit_is_ever_exceeded(demand, name):
    craft = {"OSV": OSV, "WAMV": WAMV}[name]
    found = later(craft, 0.1, surge=demand[0], sway=demand[1], yaw_moment=demand[2])
    assert max(map(abs, found.get("propulsor_order"))) <= 1.0
    for number in (1, 2):
        least, most = found.get(f"propulsor_angle_limit_{number}")
        assert least <= found.get("propulsor_angle")[number - 1] <= most


@given(*[st.floats(-100, 100)] * 4, st.floats(0, 3))
def test_no_fin_goes_beyond_its_limit(surge, roll, pitch, yaw, speed):
    craft = finned(FINS["X"], "surge roll pitch yaw", speed=speed)
    moments = {"roll_moment": roll, "pitch_moment": pitch, "yaw_moment": yaw}
    found = allocated(craft, surge=surge, **moments)
    assert max(map(abs, found.get("foil_angle"))) <= 0.4
    assert max(map(abs, found.get("propulsor_order"))) <= 1.0


def test_a_single_azimuth_turns_the_ship_first_and_drives_with_what_is_left():
    place = {"position": [-5, 0, 0], "thrust": [1e3, 0], "angle_limit": ENDLESS}
    found = wrench(
        allocated(slots([("azimuth", place)], axes="surge yaw"), surge=1e4, yaw_moment=3e3)
    )
    np.testing.assert_allclose(found[YAW], 3e3, rtol=2e-3)
    np.testing.assert_allclose(found[SURGE], 1e3 * math.sqrt(1 - 0.6**2), rtol=2e-3)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_moments_come_first_then_heave_then_surge(side):
    # The demands fit one by one; of surge there is what a linear programme leaves.
    columns = np.array([columns_of(ROV, number) for number in range(1, 9)]).T
    others = [SWAY, HEAVE, ROLL, PITCH, YAW]
    wanted = {"sway": 0.0, "heave": 100.0, "roll": 0.0, "pitch": 0.0, "yaw_moment": 8.0 * side}
    most = linprog(
        -columns[SURGE],
        A_eq=columns[others],
        b_eq=list(wanted.values()),
        bounds=[(-39.9, 51.4)] * 8,
    )
    found = wrench(allocated(ROV, surge=300.0, heave=100.0, yaw_moment=8.0 * side))
    np.testing.assert_allclose(found[YAW], 8.0 * side, rtol=1e-5)
    np.testing.assert_allclose(found[[ROLL, PITCH]], 0.0, atol=1e-5)
    np.testing.assert_allclose(found[HEAVE], 100.0, rtol=1e-2)
    np.testing.assert_allclose(found[SURGE], -most.fun, rtol=2e-2)


def columns_of(craft, number):
    """Return force and moment of a thruster per newton."""
    place, axis = craft[f"propulsor_position_{number}"], craft[f"propulsor_axis_{number}"]
    return [*axis, *np.cross(place, axis)]


def test_outboards_that_drive_astern_still_turn_the_craft():
    # Together they have 200 N astern; both turned alike they give 2 x 2.4 m x 100 N sin(angle).
    found = wrench(allocated(WAMV, surge=-500.0, yaw_moment=200.0))
    np.testing.assert_allclose(found[YAW], 200.0, rtol=1e-2)
    assert found[SURGE] < -170.0


# ---------------------------------------------------------------------- angles


def test_an_azimuth_turns_at_its_rate_and_no_faster():
    craft = {**OSV, "propulsor_angle_rate_1": 0.2, "propulsor_angle_rate_2": 0.1}
    allocation = allocated(craft, surge=1e5)
    angles = []
    for k in range(250):
        if k == 20:
            allocation.set("sway", 2e5)
        angles.append(allocation.get("propulsor_angle")[:2])
        allocation.advance(0.05 * k, 0.05)
    moves = np.abs(np.diff(angles, axis=0))
    np.testing.assert_allclose(moves.max(axis=0), [0.2 * 0.05, 0.1 * 0.05], rtol=1e-9)
    near(wrench(allocation)[[SURGE, SWAY]], [1e5, 2e5], 4e5)


def test_while_azimuths_turn_the_thrusts_are_the_best_for_their_angles():
    craft = {**OSV, "propulsor_angle_rate_1": 0.01, "propulsor_angle_rate_2": 0.01}
    found = wrench(allocated(craft, sway=1e5))
    # Ahead both still point: only the tunnels push abeam, and the azimuths balance their moment.
    np.testing.assert_allclose(found[YAW], 0.0, atol=2e3)
    assert 5e4 < found[SWAY] <= 1e5


def test_an_azimuth_with_next_to_nothing_to_do_keeps_its_angle():
    allocation = later(OSV, 0.1, sway=2e5)
    before = allocation.get("propulsor_angle")
    allocation.set("sway", -100.0)
    allocation.set("surge", 200.0)
    for k in range(10):
        allocation.advance(0.1 + 0.05 * k, 0.05)
    np.testing.assert_allclose(allocation.get("propulsor_angle"), before, rtol=1e-12)


@given(st.floats(-3.0, 3.0))
def test_a_demand_that_changes_its_sign_turns_no_azimuth_round(direction):
    push = {"surge": 1e5 * math.cos(direction), "sway": 1e5 * math.sin(direction)}
    allocation = later(OSV, 0.1, **push)
    before = np.array(allocation.get("propulsor_angle"))
    for name, value in push.items():
        allocation.set(name, -value)
    allocation.advance(0.1, 0.05)
    np.testing.assert_allclose(allocation.get("propulsor_angle"), before, atol=1e-6)
    near(wrench(allocation)[[SURGE, SWAY]], [-value for value in push.values()], 4e5)


def test_an_endless_azimuth_goes_round_without_turning_back():
    craft = slots(
        [("azimuth", {"position": [0, 0, 0], "thrust": [1, 0], "angle_limit": ENDLESS})],
        axes="surge sway",
    )
    allocation = allocated(craft, surge=0.5)
    for k in range(100):
        allocation.set("surge", 0.5 * math.cos(0.1 * k))
        allocation.set("sway", 0.5 * math.sin(0.1 * k))
        assert allocation.get("propulsor_angle")[0] == pytest.approx(0.1 * k, abs=1e-6)
        allocation.advance(0.05 * k, 0.05)


@pytest.mark.parametrize("kind", PROPULSORS)
def test_one_that_stands_at_an_angle_pushes_along_it(kind):
    place = {"thrust": [10, 10], "angle_limit": [math.pi / 2, math.pi / 2]}
    found = allocated(slots([(kind, place)], axes="sway"), sway=4.0)
    share = math.sqrt(0.4) if kind in BY_SPEED else 0.4
    assert found.get("propulsor_order")[0] == pytest.approx(share, rel=1e-6)
    assert found.get("propulsor_angle")[0] == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("kind", PROPULSORS)
def test_one_of_any_kind_turns_in_its_range(kind):
    place = {"thrust": [10, 10], "angle_limit": ENDLESS}
    found = allocated(slots([(kind, place)], axes="surge sway"), surge=3.0, sway=4.0)
    assert found.get("propulsor_angle")[0] == pytest.approx(math.atan2(4.0, 3.0), abs=1e-6)


# ---------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"propulsor_axis_2": [0, 2, 0]}, "propulsor_axis_2 is .* of length 2: give a unit vector"),
        ({"propulsor_angle_limit_1": [1, -1]}, "propulsor_angle_limit_1 is 1.0 to -1.0 rad"),
        (
            {"propulsor_axis_1": [0, 0, -1]},
            "propulsor_axis_1 .* turns about z has a horizontal one",
        ),
        ({"propulsors": "azimuth azimuth tunnel tunnel propeller"}, "thrust_5 is not given"),
        ({"axes": ""}, "axes names none: give some of surge, sway"),
        ({"axes": "surge heave"}, "give heave not at all: they give surge, sway, yaw"),
        ({"axes": "surge surge"}, "axes: 'surge surge' must name some of"),
        ({"axes": "surge turn"}, "axes: 'surge turn' must name some of surge"),
        ({"foils": "wing"}, "unknown kind 'wing'"),
    ],
)
def test_parts_and_axes_that_do_not_fit_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        started(PartAllocation, **{**OSV, **values})


def test_an_axis_that_comes_only_with_another_is_refused():
    low = slots([("thruster", {"position": [0, 0, 0.1]})], axes="surge pitch")
    with pytest.raises(InputError, match="give surge only together with another one"):
        started(PartAllocation, **low)


def test_no_parts_and_no_axes_ask_for_nothing():
    found = started(PartAllocation, surge=5.0)
    assert found.get("propulsor_order") == [0.0] * 8


# ---------------------------------------------------------------------- one steering angle

HELM = slots(
    [
        ("outboard", {"position": [-2.4, y, 0], "thrust": [250, 100], **own})
        for y, own in ((-1.0, {"angle_limit": [-0.7, 0.7]}), (1.0, {"turns_with": 1}))
    ],
    axes="surge yaw",
)


@given(st.floats(-80, 200), st.floats(-60, 60))
def test_two_outboards_on_one_helm_give_surge_and_yaw_at_one_angle(surge, yaw):
    allocation = allocated(HELM, surge=surge, yaw_moment=yaw)
    near(wrench(allocation)[[SURGE, YAW]], [surge, yaw], 1e3)
    one, two = allocation.get("propulsor_angle")[:2]
    assert one == two
    assert -0.7 <= one <= 0.7


def test_one_helm_turns_at_the_rate_of_the_first_and_uneven_thrusts_help():
    slow = {**HELM, "propulsor_angle_rate_1": 0.2}
    allocation = allocated(slow, surge=100.0, yaw_moment=100.0)
    one, two = allocation.get("propulsor_angle")[:2]
    assert one == two == pytest.approx(-0.2 * 0.05)
    near(wrench(allocation)[[SURGE, YAW]], [100.0, 100.0], 1e3)
    port, starboard = allocation.get("propulsor_order")[:2]
    assert port > starboard


def test_one_helm_without_an_angle_is_refused():
    with pytest.raises(InputError, match=r"propulsor_turns_with_2 is 1\.0: .* no angle of its own"):
        allocated({**HELM, "propulsor_angle_limit_1": [0, 0]})
