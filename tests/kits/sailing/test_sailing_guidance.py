import itertools
import math

import pytest

from seatrial.errors import InputError
from seatrial_kits.sailing.control.guidance import SailingGuidance
from tests.devices.running import started

DEG = math.radians(1.0)
NORTHERLY = [-5.0, 0.0]  # it blows to the south: the eye of the wind is north
NEUTRAL, PILOTED, STAYS, FOLLOWS, STEERS, BEATS = range(6)


def guidance(position=(0.0, 0.0), heading=90.0, speed=2.0, **changes):
    """Return an armed boat under way, whose heading wanted does not lag by default."""
    along = [speed * math.cos(heading * DEG), speed * math.sin(heading * DEG), 0.0]
    values = {"armed": True, "wind": NORTHERLY, "turn_rate": 1e3, "lead": math.pi}
    placed = {"position_n": [*position, 0.0], "velocity_n": along, "heading": heading * DEG}
    return started(SailingGuidance, **{**values, **placed, **changes})


def leg(end, start=(0.0, 0.0), number=1, **settings):
    ends = {"leg_from": [*start, 0.0], "leg_to": [*end, 0.0]}
    return {"mode": "auto", "leg": number, **ends, **settings}


def at(bearing, distance=100.0):
    return distance * math.cos(bearing * DEG), distance * math.sin(bearing * DEG)


def wrapped(angle):
    return math.degrees(math.remainder(angle, math.tau))


def steer(boat, seconds, speed=2.0, current=(0.0, 0.0), each=None):
    """Move a boat that turns as commanded, without leeway; it has way while its sail is trimmed."""
    period = boat.period
    north, east, _ = boat.position_n
    for _ in range(round(seconds / period)):
        heading = boat.get("heading_wanted")
        sails = boat.get("engaged.sail")
        if each and each(north, east, heading):
            return True
        boat.advance(boat.now, period)
        u = speed if sails else 0.0
        v_n = u * math.cos(heading) + current[0], u * math.sin(heading) + current[1]
        north, east = north + period * v_n[0], east + period * v_n[1]
        boat.set("heading", heading)
        boat.set("velocity_n", [*v_n, 0.0])
        boat.set("position_n", [north, east, 0.0])
    return False


# ---------------------------------------------------------------------- legs


@pytest.mark.parametrize("bearing", [60, 90, 179, -150, -66])
def test_sails_a_leg_off_the_wind(bearing):
    found = guidance(heading=bearing, **leg(at(bearing)))
    assert wrapped(found.get("course")) == pytest.approx(bearing)
    assert found.get("distance") == pytest.approx(100.0)
    assert (found.get("state"), found.get("engaged")) == (FOLLOWS, [True, True])


def test_beside_a_leg_it_heads_for_the_line_as_line_of_sight_has_it():
    found = guidance((-10.0, 20.0), **leg(at(90)), lookahead=20.0)
    assert found.get("cross_track") == pytest.approx(10.0)
    assert wrapped(found.get("course")) == pytest.approx(90 - math.degrees(math.atan(0.5)))
    # But no closer to the wind than it can.
    found = guidance((-60.0, 20.0), **leg(at(90)), lookahead=20.0)
    assert wrapped(found.get("course")) == pytest.approx(60.0)


def test_off_the_wind_it_comes_back_onto_the_line():
    found = guidance((-10.0, 0.0), **leg((0.0, 400.0)), lookahead=20.0, turn_rate=6 * DEG)
    steer(found, 100)
    # e' = -U e / sqrt(lookahead^2 + e^2): after t it is near exp(-U t / lookahead) of 10 m.
    assert abs(found.get("cross_track")) < 0.01
    assert found.get("state") == FOLLOWS


def turns(heading, course, count=400):
    """Return the headings wanted, deg, of a boat that follows them at once."""
    target = {"mode": "guided", "target_kind": "heading", "target_heading": course * DEG}
    found = guidance(heading=heading, turn_rate=6 * DEG, target_speed=1.0, **target)
    headings, wearing = [heading], []
    for k in range(count):
        wanted = found.get("heading_wanted")
        headings.append(headings[-1] + wrapped(wanted - headings[-1] * DEG))
        wearing.append(found.get("wearing"))
        found.advance(0.1 * k, 0.1)
        found.set("heading", wanted)
        found.set("velocity_n", [2.0 * math.cos(wanted), 2.0 * math.sin(wanted), 0.0])
    return headings, wearing


@pytest.mark.parametrize(
    ("heading", "course", "turned"),
    [(90, 150, 60), (150, -150, 60), (80, -80, 200), (-80, 80, -200), (170, -100, 90)],
)
def test_turns_at_the_rate_and_never_through_the_eye_of_the_wind(heading, course, turned):
    headings, wearing = turns(heading, course)
    assert headings[-1] - heading == pytest.approx(turned, abs=1e-6)
    steps = [b - a for a, b in itertools.pairwise(headings)]
    assert max(map(abs, steps)) <= 0.6 + 1e-9
    assert all(abs(wrapped(h * DEG)) > 60 for h in headings)
    assert any(wearing) == (abs(turned) > 180)


def test_without_way_it_bears_away_until_it_has_way_again():
    found, courses = guidance(heading=70, **leg(at(70, 1e5)), recovered=2.0), []
    for k, speed in enumerate([0.6, 0.4, 0.6, 0.9, 1.1, 0.6]):
        found.set("velocity_n", [*at(70, speed), 0.0])
        courses.append(wrapped(found.get("course")))
        found.advance(0.1 * k, 0.1)
    assert courses == pytest.approx([70, 110, 110, 110, 70, 70], abs=1e-6)


@pytest.mark.parametrize("end", [(300.0, 0.0), (250.0, 120.0)])
def test_beats_to_an_end_upwind_and_a_new_line_begins_where_it_is_laid(end):
    found = guidance(heading=100, **leg(end, leg_radius=12.0), turn_rate=6 * DEG)
    tacks, states = set(), set()

    def arrives(north, east, heading):
        assert abs(wrapped(heading)) > 59.9
        tacks.add(math.copysign(1.0, wrapped(heading)))
        states.add(found.get("state"))
        return found.get("reached") == 1

    assert steer(found, 1000, each=arrives)
    assert math.dist(found.position_n[:2], end) <= 12.0
    assert tacks == {1.0, -1.0}
    assert {BEATS, FOLLOWS} <= states
    assert found.get("cross_track_rms") < 25.0  # of the last board, not of the boards before


def test_it_wears_for_the_other_tack_once_the_ground_that_is_lost_can_be_spared():
    # 60 deg off the wind a boat that is d below the end must be d tan(60 deg) aside: 30 m from
    # the end upwind it is 51.96 m, and with 20 m lost in wearing 86.6 m.
    for aside, course in ((80.0, 60), (90.0, -math.degrees(math.atan2(90.0, 30.0)))):
        at_end = leg((30.0, -aside), leg_radius=1.0)
        found = guidance(heading=60, **at_end, wearing_loss=20.0, margin=0.0)
        found.advance(0.0, 0.1)
        assert wrapped(found.get("course")) == pytest.approx(course)


def test_waits_at_the_end_of_a_leg():
    found = guidance(at(90, 95.0), **leg(at(90), leg_radius=8.0, leg_wait=2.0))
    reached = []
    for k in range(30):
        reached.append(found.get("reached"))
        found.advance(0.1 * k, 0.1)
    assert reached.index(1) == 20
    assert found.get("engaged.sail") is False


def test_a_new_number_of_the_same_leg_is_a_leg_of_its_own():
    found = guidance(at(90), **leg(at(90), leg_radius=8.0))
    found.advance(0.0, 0.1)
    assert found.get("reached") == 1
    found.set("leg", 2)
    assert found.get("reached") == 2


# ---------------------------------------------------------------------- staying


def test_holding_in_a_current_it_sails_back_from_the_drift_limit():
    found = guidance(mode="hold", drift_limit=40.0, capture_radius=20.0, turn_rate=6 * DEG)
    offs, sailed = [], []

    def watch(north, east, heading):
        offs.append(math.hypot(north, east))
        sailed.append(found.get("engaged.sail"))
        return False

    steer(found, 600, current=(0.0, 0.3), each=watch)
    assert any(sailed[1000:])
    assert not all(sailed[1000:])
    # A boat that turns at 6 deg/s sweeps 2 U / rate = 38 m.
    assert max(offs) < 40.0 + 2 * 2.0 / (6 * DEG) + 10.0


def test_lying_to_it_rounds_up_while_it_has_way_and_then_nobody_steers():
    found = guidance(heading=170, mode="hold", lying=70 * DEG)
    assert wrapped(found.get("course")) == pytest.approx(70)
    assert (found.get("engaged"), found.get("state")) == ([True, False], STAYS)
    found.set("velocity_n", [0.0, 0.0, 0.0])
    assert found.get("engaged") == [False, False]
    assert found.get("heading_wanted") == pytest.approx(170 * DEG)


@pytest.mark.parametrize("radius", [-60.0, pytest.param(60.0, marks=pytest.mark.interop)])
def test_goes_round_a_circle_though_the_wind_is_in_the_way(radius):
    found = guidance((0.0, 60.0), mode="hold", turn_rate=6 * DEG)
    found.set("position_n", [0.0, 0.0, 0.0])
    found.set("loiter_radius", radius)
    found.set("mode", "loiter")
    bearings = []
    steer(found, 900, each=lambda n, e, h: bearings.append(math.atan2(e, n)))
    way = sum(math.remainder(b - a, math.tau) for a, b in itertools.pairwise(bearings[100:]))
    assert math.copysign(1, radius) * way > 1.5 * math.tau


# ---------------------------------------------------------------------- orders


def test_disarmed_the_rudder_is_amidships_and_the_sail_streams():
    found = guidance(mode="manual", manual=[1.0, 0.0, 1.0, 0.0], armed=False)
    assert found.get("engaged") == [False, False]
    assert found.get("direct") == [0.0, 0.0]
    assert found.get("state") == NEUTRAL


def test_manual_control_goes_through_in_manual_only():
    found = guidance(mode="manual", manual=[0.5, 0.0, -2.0, 0.0], position_valid=False)
    assert (found.get("direct"), found.get("state")) == ([-1.0, 0.5], PILOTED)
    found.set("manual", [-1.0, 0.0, 0.0, 0.0])
    assert found.get("direct") == [0.0, 0.0]  # a sheet does not push
    found.set("mode", "hold")
    assert found.get("direct") == [0.0, 0.0]


def test_without_a_position_for_longer_than_the_timeout_it_is_neutral():
    found, states = guidance(heading=90, **leg(at(90))), []
    found.advance(0.0, 0.1)
    found.set("position_valid", False)
    for k in range(1, 20):
        states.append(found.get("state"))
        found.advance(0.1 * k, 0.1)
    assert states == [FOLLOWS] * 10 + [NEUTRAL] * 9


@pytest.mark.parametrize(
    ("kind", "wanted"),
    [
        ("velocity", {"target_velocity": [0.0, 1.0, 0.0]}),
        ("heading", {"target_heading": 90 * DEG, "target_speed": 1.0}),
        ("position", {"target_position": [0.0, 100.0, 0.0]}),
    ],
)
def test_guided_sails_where_it_is_sent(kind, wanted):
    found = guidance(heading=120, mode="guided", target_kind=kind, **wanted)
    assert wrapped(found.get("course")) == pytest.approx(90.0)
    assert found.get("engaged") == [True, True]


def test_a_speed_of_0_is_to_lie_to():
    found = guidance(mode="guided", target_kind="velocity", target_velocity=[0.0, 0.0, 0.0])
    assert found.get("engaged.sail") is False


def test_returns_home():
    found = guidance((0.0, -100.0), mode="return", home=[0.0, 0.0, 0.0], acceptance_radius=8.0)
    assert steer(found, 100, each=lambda n, e, h: found.get("state") == STAYS)
    assert math.hypot(*found.position_n[:2]) <= 8.0


def test_refuses_a_mode_that_it_has_not():
    with pytest.raises(InputError, match=r"unknown mode 'surface'.*loiter"):
        guidance(mode="surface").get("state")


def test_refuses_radii_that_do_not_go_together():
    with pytest.raises(InputError, match=r"capture_radius .* must be less than drift_limit"):
        guidance(drift_limit=20.0)


def test_it_keeps_clear_of_what_a_camera_has_confirmed():
    """An obstacle of 1 m ahead at 40 m, seen once, twice, three times; then no more."""
    settings = {
        "mode": "guided",
        "armed": True,
        "position_valid": True,
        "heading_valid": True,
        "target_kind": "heading",
        "target_valid": True,
        "target_heading": 1.5,
        "target_speed": 1.0,
        "heading": 1.5,
        "velocity_n": [0.0, 2.0, 0.0],
        "wind": [5.0, 0.0],
        "clearance": 8.0,
        "turn_rate": 10.0,
        "forget": 5.0,
    }
    guidance = started(SailingGuidance, **settings)
    size = 2 * math.asin(0.5 / 40.0)
    courses = []
    for k in range(120):
        if k < 5:
            guidance.set("frame", k + 1)
            guidance.set("detected", 2)
            guidance.set("sight_bearing", [0.0, -0.01, 0, 0, 0, 0])
            guidance.set("sight_size", [size, 0.1, 0, 0, 0, 0])
            guidance.set("sight_kind", [2, 1, 0, 0, 0, 0])  # a buoy is no obstacle
        guidance.advance(0.1 * k, 0.1)
        courses.append(guidance.get("course"))
    assert courses[1] == pytest.approx(1.5)
    assert abs(courses[5] - 1.5) == pytest.approx(math.asin(8.0 / 40.0), abs=1e-9)
    assert courses[-1] == pytest.approx(1.5)
    assert (guidance.get("avoiding"), guidance.get("obstacles")) == (False, 0)
