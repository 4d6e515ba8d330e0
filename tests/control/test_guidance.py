"""Guidance of a point without lags, against closed forms."""

import math

import numpy as np
import pytest

from seatrial.control.guidance import Guidance
from seatrial.control.guidance_motion import FOLLOW, MANUAL, NEUTRAL, STAY, STEER
from seatrial.errors import InputError
from tests.devices.running import started

from .guided_craft import drive, guidance, leg

DEG = math.radians(1.0)
FAR = leg((0.0, 0.0), (1e4, 0.0))


def wrapped(angle):
    return math.degrees(math.remainder(angle, math.tau))


# ---------------------------------------------------------------------- legs


@pytest.mark.parametrize("offset", [20.0, -7.0, pytest.param(0.5, marks=pytest.mark.interop)])
def test_comes_onto_a_leg_as_the_closed_form_says(offset):
    """sqrt(D^2 + e^2) - D asinh(D / e) falls by U t, from e' = -U e / sqrt(D^2 + e^2)."""
    lookahead, speed = 5.0, 1.3

    def passed(e):
        return math.hypot(lookahead, e) - lookahead * math.asinh(lookahead / abs(e))

    found = guidance(
        (0.0, offset),
        **FAR,
        leg_speed=speed,
        velocity_n=[speed, 0.0, 0.0],
        lookahead=lookahead,
        integral_gain=0.0,
        turning_speed=1.0,
        period=2e-3,
    )
    rows = np.array(drive(found, 8.0))
    t, e = rows[:, 0], rows[:, 2]
    assert np.sign(e).tolist() == [math.copysign(1.0, offset)] * len(e)
    # Headings held for 2 ms: an error of U period / lookahead of the way.
    gone = [passed(e[0]) - passed(x) for x in e]
    np.testing.assert_allclose(gone, speed * t, rtol=1e-3, atol=5e-3)


@pytest.mark.parametrize("current", [-0.6, pytest.param(0.2, marks=pytest.mark.interop)])
def test_integral_removes_the_error_that_a_current_leaves(current):
    speed, settings = 1.0, {**FAR, "velocity_n": [1.0, 0.0, 0.0], "turning_speed": 1.0}
    crab = -math.asin(current / speed)
    without = drive(guidance(**settings, integral_gain=0.0), 120.0, (0.0, current))
    # Without it the crab angle needs an error: tan(crab) = -e / lookahead.
    assert without[-1][2] == pytest.approx(-5.0 * math.tan(crab), rel=1e-3)
    with_integral = drive(guidance(**settings), 400.0, (0.0, current))
    assert with_integral[-1][2] == pytest.approx(0.0, abs=1e-3)
    assert with_integral[-1][3] == pytest.approx(crab, abs=1e-4)


@pytest.mark.parametrize("course", [0, 90, 135, 180, -91])
def test_legs_in_all_directions_are_alike(course):
    """The same way beside a leg that leads north, turned: also across +-180 degrees."""
    c, s = math.cos(course * DEG), math.sin(course * DEG)

    def turned(north, east):
        return c * north - s * east, s * north + c * east

    def way(turn):
        settings = leg(turn(0, 0), turn(60, 0), velocity_n=[*turn(1, 0), 0.0])
        found = guidance(turn(-3, 4), **settings)
        found.set("heading", math.atan2(*reversed(turn(1, 0))))
        return drive(found, 40.0)

    plain = way(lambda north, east: (north, east))
    other = way(turned)
    for (_, north, east, heading, speed, across), row in zip(plain, other, strict=True):
        assert row[1:3] == pytest.approx(turned(north, east), abs=1e-6)
        assert wrapped(row[3] - heading - course * DEG) == pytest.approx(0.0, abs=1e-6)
        assert row[4:] == pytest.approx((speed, across), abs=1e-6)
        assert -math.pi <= row[3] <= math.pi


def test_past_the_end_it_heads_for_the_end():
    found = guidance((60.0, 8.0), **leg((0, 0), (50, 0)))
    assert wrapped(found.get("heading_wanted")) == pytest.approx(wrapped(math.atan2(-8, -10)))
    assert found.get("cross_track") == pytest.approx(8.0)
    assert found.get("state") == FOLLOW


@pytest.mark.parametrize(("asked", "speed"), [(-1.0, 0.7), (0.4, 0.4), (0.0, 0.0)])
def test_a_leg_without_a_speed_of_its_own_is_at_cruise_speed(asked, speed):
    settled = {"leg_speed": asked, "cruise_speed": 0.7, "acceleration": 1e3, "approach_gain": 1e3}
    found = guidance((20.0, 0.0), **leg((0, 0), (90, 0)), **settled)
    assert found.get("speed_wanted") == pytest.approx(speed)


@pytest.mark.parametrize(("asked", "state"), [(0.0, STAY), (2.0, FOLLOW), (6.0, STAY)])
def test_a_leg_without_a_radius_of_its_own_has_that_of_acceptance(asked, state):
    radii = {"leg_radius": asked, "acceptance_radius": 5.0}
    found = guidance((46.0, 0.0), **leg((0, 0), (50, 0)), leg_wait=9.0, **radii)
    drive(found, 0.3)
    assert found.get("state") == state


def test_the_end_is_reached_within_the_radius_and_after_the_wait():
    found, seen = guidance(**leg((0, 0), (10, 0)), leg_radius=2.0, leg_wait=1.0), {}

    def look(t):
        seen.setdefault(found.get("state"), (t, found.position_n[0]))
        if found.get("reached"):
            seen.setdefault("reached", (t, found.get("reached")))

    found.set("leg", 7)
    drive(found, 15.0, each=look)
    arrived, north = seen[STAY]
    assert 8.0 <= north < 8.1 + 1e-9
    assert seen["reached"] == (pytest.approx(arrived + 1.0), 7)


def test_a_reached_leg_stays_reached_until_another_begins():
    found = guidance((9.0, 0.0), **leg((0, 0), (10, 0), number=4))
    assert found.get("reached") == 4
    found.advance(0.0, 0.1)
    found.set("position_n", [0.0, 0.0, 0.0])
    assert found.get("reached") == 4
    found.set("leg", 5)
    assert found.get("reached") == 0
    assert found.get("state") == FOLLOW


def test_root_mean_square_of_the_cross_track_error():
    found = guidance((0.0, 3.0), **FAR)
    errors = [row[5] for row in drive(found, 20.0)]
    found.set("mode", "hold")  # what comes now is ignored
    drive(found, 5.0)
    assert found.get("cross_track_rms") == pytest.approx(math.sqrt(np.mean(np.square(errors))))


@pytest.mark.parametrize(
    ("error", "least", "share"),
    [(0, 0.0, 1.0), (60, 0.0, 0.5), (120, 0.0, 0.0), (120, 0.3, 0.3), (-60, 0.8, 0.8)],
)
def test_slows_down_to_turn(error, least, share):
    found = guidance(**FAR, heading=error * DEG, turning_speed=least, leg_speed=1.5)
    assert found.get("speed_wanted") == pytest.approx(1.5 * share, abs=1e-12)


# ---------------------------------------------------------------------- depth


@pytest.mark.parametrize(
    ("along", "depth"), [(-5.0, 2.0), (0.0, 2.0), (10.0, 4.0), (45.0, 11.0), (55.0, 12.0)]
)
def test_depth_goes_along_the_leg(along, depth):
    found = guidance((along, 1.0), 7.0, **leg((0, 0, 2), (50, 0, 12)), depth_control="on")
    assert found.get("depth_wanted") == pytest.approx(depth)
    off = guidance((along, 1.0), 7.0, **leg((0, 0, 2), (50, 0, 12)))
    assert off.get("depth_wanted") == 0.0


def test_a_waypoint_is_reached_at_its_depth_alone():
    found = guidance((9.0, 0.0), 3.0, **leg((0, 0, 0), (10, 0, 5)), depth_control="on")
    assert (found.get("reached"), found.get("state")) == (0, STAY)
    assert found.get("depth_wanted") == 5.0
    found.set("depth", 4.8)
    assert found.get("reached") == 1


def test_nothing_is_wanted_above_the_surface():
    settings = {"depth_control": "on", "surface_depth": 0.5}
    found = guidance((9.0, 0.0), 3.0, **leg((0, 0, 2), (10, 0, -20)), **settings)
    assert found.get("depth_wanted") == 0.5


# ---------------------------------------------------------------------- staying


def test_rests_within_the_drift_limit_and_returns_beyond():
    found = guidance((4.0, -2.0), mode="hold", heading=1.0)
    assert (found.get("speed_wanted"), found.get("heading_wanted")) == (0.0, 1.0)
    found.advance(0.0, 0.1)
    for k, (off, speed) in enumerate(
        [(1.9, 0.0), (2.1, 0.63), (1.0, 0.3), (0.51, 0.153), (0.49, 0.0), (1.9, 0.0)], 1
    ):
        found.set("position_n", [4.0, -2.0 - off, 0.0])
        found.set("heading", math.pi / 2 if speed else 1.0)  # where it must go
        assert found.get("speed_wanted") == pytest.approx(speed)
        assert found.get("distance") == pytest.approx(off)
        if speed:
            assert found.get("heading_wanted") == pytest.approx(math.pi / 2)
        found.advance(0.1 * k, 0.1)


def test_surfaces_where_the_mode_was_set():
    found = guidance((3.0, 4.0), 6.0, mode="surface", depth_control="on", surface_depth=0.2)
    assert (found.get("depth_wanted"), found.get("distance")) == (0.2, 0.0)


def test_in_a_current_it_comes_to_rest_where_its_way_back_equals_it():
    rows = drive(guidance(mode="hold", approach_gain=0.25), 300.0, (0.0, 0.2))
    off = [math.hypot(north, east) for _, north, east, *_ in rows]
    assert 2.0 < max(off) < 2.1
    assert off[-1] == pytest.approx(0.2 / 0.25, rel=1e-6)


def test_in_a_weak_current_it_drifts_and_returns():
    rows = drive(guidance(mode="hold"), 300.0, (0.1, 0.1))
    off = [math.hypot(north, east) for _, north, east, *_ in rows]
    late = off[1500:]
    assert (min(late), max(late)) == pytest.approx((0.5, 2.0), abs=0.05)


@pytest.mark.parametrize("course", [0.0, 1.0, 2.5, math.pi, -2.0])
def test_a_weather_vane_comes_to_rest_bow_up_where_its_way_back_equals_the_current(course):
    current = 0.2 * math.cos(course), 0.2 * math.sin(course)
    found = guidance(mode="hold", staying="weather-vane", approach_gain=0.25)
    rows = np.array(drive(found, 300.0, current))
    late = rows[rows[:, 0] > 100.0]
    leeward = 2.0 + 0.2 / 0.25
    ends = [leeward * math.cos(course), leeward * math.sin(course)]
    np.testing.assert_allclose(late[-1, 1:3], ends, atol=1e-6)
    assert np.hypot(rows[:, 1], rows[:, 2]).max() < leeward + 1e-6
    upstream = math.remainder(found.get("heading_wanted") - course - math.pi, math.tau)
    assert upstream == pytest.approx(0.0, abs=1e-6)


def test_a_weather_vane_keeps_its_heading_within_the_drift_limit():
    found = guidance((4.0, -2.0), mode="hold", heading=1.0, staying="weather-vane")
    found.advance(0.0, 0.1)
    for off, speed in ((1.9, 0.0), (2.1, 0.03), (1.9, 0.0), (-1.0, 0.0), (3.0, 0.3)):
        found.set("position_n", [4.0, -2.0 - off, 0.0])
        before = found.get("heading_wanted") if abs(off) < 2.0 else math.pi / 2
        found.set("heading", before)
        assert found.get("speed_wanted") == pytest.approx(speed, abs=1e-12)
        assert found.get("heading_wanted") == pytest.approx(before)
        found.advance(0.1, 0.1)


@pytest.mark.parametrize("radius", [8.0, -8.0])
@pytest.mark.parametrize("start", [0.5, 30.0])
def test_loiters_on_a_circle(radius, start):
    found = guidance(mode="loiter", loiter_radius=radius, turning_speed=1.0, integral_gain=0.0)
    found.advance(0.0, 0.1)  # the mode is set at the origin
    found.set("position_n", [start, 0.0, 0.0])
    rows = np.array(drive(found, 120.0))
    late = rows[rows[:, 0] > 90.0]
    # Headings held for 0.1 s lead outside by half of what they turn in that time.
    np.testing.assert_allclose(np.hypot(late[:, 1], late[:, 2]), 8.0, atol=0.1)
    angle = np.unwrap(np.arctan2(late[:, 2], late[:, 1]))
    assert angle[-1] - angle[0] == pytest.approx(math.copysign(30.0 / 8.0, radius), rel=0.02)


def test_a_craft_that_cannot_stop_circles_where_others_rest():
    found = guidance((9.0, 0.0), **leg((0, 0), (10, 0)), staying="circle", loiter_radius=-6.0)
    assert found.get("state") == STAY
    assert found.get("cross_track") == pytest.approx(-(6.0 - 1.0))
    found.set("leg_circle", 4.0)
    assert found.get("cross_track") == pytest.approx(4.0 - 1.0)


# ---------------------------------------------------------------------- guided, return


def test_goes_to_a_position_and_stays():
    found = guidance((5.0, 5.0), mode="guided", target_position=[-20.0, 30.0, 0.0])
    rows = drive(found, 120.0)
    assert math.dist(rows[-1][1:3], (-20.0, 30.0)) < 3.0
    assert max(abs(row[5]) for row in rows) < 1e-9  # the line begins where the craft was
    assert found.get("state") == STAY
    found.set("target_position", [0.0, 0.0, 0.0])
    assert found.get("state") == FOLLOW


@pytest.mark.parametrize(("asked", "speed"), [(0.0, 1.4), (0.6, 0.6)])
def test_speed_to_a_position(asked, speed):
    settings = {"target_position": [90.0, 0.0, 0.0], "target_speed": asked, "cruise_speed": 1.4}
    assert guidance(mode="guided", **settings).get("speed_wanted") == pytest.approx(speed)


def test_steers_a_velocity():
    velocity = [-0.3, 0.4, 0.2]
    found = guidance(
        depth=2.0, mode="guided", target_kind="velocity", target_velocity=velocity,
        depth_control="on",
    )  # fmt: skip
    assert found.get("heading_wanted") == pytest.approx(math.atan2(0.4, -0.3))
    found.set("heading", math.atan2(0.4, -0.3))
    assert found.get("speed_wanted") == pytest.approx(0.5)
    for k in range(20):
        found.advance(0.1 * k, 0.1)
    assert found.get("depth_wanted") == pytest.approx(2.0 + 20 * 0.1 * 0.2)
    assert found.get("state") == STEER
    # Without a velocity it keeps heading and depth.
    found.set("target_velocity", [0.0, 0.0, 0.0])
    assert found.get("heading_wanted") == pytest.approx(math.atan2(0.4, -0.3))
    assert found.get("speed_wanted") == 0.0


def test_steers_a_heading():
    found = guidance(
        mode="guided", target_kind="heading", target_heading=-3.0, target_speed=0.7,
        target_position=[50.0, 50.0, 4.0], depth_control="on", heading=-3.0,
    )  # fmt: skip
    wanted = [found.get(f"{name}_wanted") for name in ("heading", "speed", "depth")]
    assert wanted == pytest.approx([-3.0, 0.7, 4.0])


def test_steers_velocities_along_the_body_axes_whatever_the_heading():
    """A target at right angles: surge does not wait, sway comes up at the acceleration."""
    found = guidance(
        mode="guided", target_kind="body", target_heading=math.pi / 2.0, target_speed=0.7,
        target_sway=0.4, acceleration=0.5, heading=math.pi / 6.0, velocity_n=[1.0, 0.0, 0.0],
    )  # fmt: skip
    assert found.get("sway") == pytest.approx(-0.5)  # north is 30 degrees to port of the bow
    assert found.get("sway_engaged")
    assert found.get("sway_wanted") == pytest.approx(-0.5 + 0.5 * found.period)
    for k in range(40):
        found.advance(k * found.period, found.period)
    wanted = [found.get(f"{name}_wanted") for name in ("heading", "speed", "sway")]
    assert wanted == pytest.approx([math.pi / 2.0, 0.7, 0.4])
    found.set("target_kind", "heading")
    assert not found.get("sway_engaged")
    assert found.get("sway_wanted") == 0.0


def test_without_a_set_point_it_holds():
    found = guidance((1.0, 2.0), mode="guided", target_position=[90.0, 0.0, 0.0])
    drive(found, 10.0)
    found.set("target_valid", False)
    assert found.get("state") == STAY
    assert found.get("distance") == 0.0


def test_comes_home_and_stays():
    found = guidance((40.0, -30.0), mode="return", home=[1.0, 2.0, 0.0])
    rows = drive(found, 120.0)
    assert math.dist(rows[-1][1:3], (1.0, 2.0)) <= 3.0
    assert found.get("state") == STAY


# ---------------------------------------------------------------------- modes


def test_manual_control_is_for_manual_alone():
    found = guidance(manual=[0.5, -2.0, 2.0, -0.25], mode="manual")
    assert found.get("direct") == [0.5, -1.0, 1.0, -0.25]
    assert (found.get("state"), found.get("engaged")) == (MANUAL, [False] * 3)
    for settings in ({"armed": False}, {"armed": True, "mode": "hold"}):
        for name, value in settings.items():
            found.set(name, value)
        assert found.get("direct") == [0.0] * 4


MANUAL_AXES = [0.5, -0.5, 0.25, -1.0]


@pytest.mark.parametrize(
    ("mode", "engaged", "direct"),
    [
        ("manual", [False, False, False], MANUAL_AXES),
        ("manual-depth", [False, False, True], [0.5, -0.5, 0.25, 0.0]),
        ("stabilize", [False, True, False], [0.5, -0.5, 0.0, -1.0]),
        ("depth-hold", [False, True, True], [0.5, -0.5, 0.0, 0.0]),
        ("hold", [True, True, True], [0.0, 0.0, 0.0, 0.0]),
    ],
)
def test_manual_control_acts_where_no_autopilot_does(mode, engaged, direct):
    found = guidance(depth=5.0, mode=mode, heading=1.0, manual=MANUAL_AXES, depth_control="on")
    for k in range(10):
        found.advance(0.1 * k, 0.1)
    assert (found.get("engaged"), found.get("direct")) == (engaged, direct)
    # Manual control of the axes that are held: 0.4 rad/s and 0.2 m/s at full deflection.
    turned = 0.25 * 0.4 * (mode in ("stabilize", "depth-hold"))
    sunk = -0.2 * mode.endswith("depth") - 0.2 * (mode == "depth-hold")
    assert found.get("heading_wanted") == pytest.approx(1.0 + turned)
    assert found.get("depth_wanted") == pytest.approx(5.0 + sunk)


@pytest.mark.parametrize(
    ("mode", "needed"),
    [
        ("manual", set()),
        ("manual-depth", {"depth"}),
        ("stabilize", {"heading"}),
        ("depth-hold", {"heading", "depth"}),
        ("hold", {"heading", "depth", "position"}),
    ],
)
def test_a_mode_needs_the_estimates_that_it_uses(mode, needed):
    for name in ("heading", "depth", "position"):
        found = guidance(mode=mode, depth_control="on", **{f"{name}_valid": False})
        assert (found.get("state") == NEUTRAL) == (name in needed)


def test_starts_disarmed_and_neutral():
    found = started(Guidance, **FAR, heading=0.3, depth=4.0, depth_control="on")
    assert (found.get("state"), found.get("engaged")) == (NEUTRAL, [False] * 3)
    wanted = [found.get(f"{name}_wanted") for name in ("heading", "speed", "depth")]
    assert wanted == pytest.approx([0.3, 0.0, 4.0])


@pytest.mark.parametrize("mode", ["hold", "auto", "return", "loiter", "guided"])
def test_a_mode_begins_without_jumps(mode):
    """From manual under way, heading south-west at 1.2 m/s: speed from there, at its rate."""
    heading, step = 225 * DEG, 0.3 * 0.1
    velocity = [1.2 * math.cos(heading), 1.2 * math.sin(heading), 0.0]
    ahead = [500.0 * math.cos(heading), 500.0 * math.sin(heading), 3.0]
    places = {"leg": 1, "leg_to": ahead, "home": ahead, "target_position": ahead}
    found = guidance(
        depth=3.0, mode="manual", heading=heading, velocity_n=velocity, depth_control="on",
        acceleration=0.3, leg_from=[0.0, 0.0, 3.0], **places,
    )  # fmt: skip
    for k in range(5):
        found.advance(0.1 * k, 0.1)
    found.set("mode", mode)
    assert found.get("speed_wanted") == pytest.approx(1.2, abs=step + 1e-9)
    assert found.get("depth_wanted") == 3.0
    if mode != "loiter":  # which turns away from its centre
        assert wrapped(found.get("heading_wanted") - heading) == pytest.approx(0.0, abs=1e-6)
    speeds = [row[4] for row in drive(found, 8.0)]
    assert np.abs(np.diff(speeds)).max() <= step + 1e-9


def test_to_hold_under_way_keeps_the_heading_wanted():
    found = guidance((0.0, 3.0), **FAR)
    drive(found, 3.0)
    before = found.get("heading_wanted")
    found.advance(3.0, 0.1)
    found.set("mode", "hold")
    assert abs(before) > 0.1
    assert found.get("heading_wanted") == pytest.approx(before, abs=0.02)
    assert found.get("distance") == 0.0


@pytest.mark.parametrize("name", ["position", "heading", "depth"])
def test_a_stale_estimate_is_neutral_after_the_timeout(name):
    found = guidance(**FAR, timeout=0.5, depth_control="on")
    found.advance(0.0, 0.1)
    found.set(f"{name}_valid", False)
    engaged = []
    for k in range(1, 10):
        engaged.append(all(found.get("engaged")))
        found.advance(0.1 * k, 0.1)
    # Last valid at 0 s: lost from the first instant after 0.5 s on.
    assert engaged == [True] * 5 + [False] * 4
    assert found.get("speed_wanted") == 0.0
    found.set("mode", "manual")
    assert found.get("state") == MANUAL
    found.set("mode", "auto")
    found.set(f"{name}_valid", True)
    assert found.get("engaged") == [True] * 3


@pytest.mark.parametrize("name", ["position", "heading", "depth"])
def test_an_estimate_that_was_never_valid_is_lost(name):
    found = guidance(**FAR, **{f"{name}_valid": False}, depth_control="on")
    assert found.get("state") == NEUTRAL


def test_a_surface_craft_needs_no_depth():
    assert guidance(**FAR, depth_valid=False).get("state") == FOLLOW


def test_speed_is_what_is_made_good_along_the_bow():
    found = guidance(heading=150 * DEG, velocity_n=[-1.0, 2.0, 9.0])
    assert found.get("speed") == pytest.approx(math.cos(150 * DEG) * -1 + math.sin(150 * DEG) * 2)


# ---------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"mode": "atuo"}, "Guidance: unknown mode 'atuo'; did you mean 'auto'"),
        ({"mode": "guided", "target_kind": "speed"}, "unknown target 'speed'"),
        ({"capture_radius": 2.0}, r"capture_radius \(2.0 m\) must be less than drift_limit"),
        ({"loiter_radius": 0.0, "staying": "circle"}, "loiter_radius is 0.0 m"),
        ({"staying": "float"}, "unknown value of staying 'float'"),
    ],
)
def test_refuses(settings, expected):
    with pytest.raises(InputError, match=expected):
        guidance(**settings).get("state")
