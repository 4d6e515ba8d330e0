import json
import math
import re
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import STATION, Bench
from .ground import (
    DELAY,
    GLOBAL,
    JUMP,
    LATITUDE,
    LOITER,
    LOITER_TIME,
    LONGITUDE,
    MISSION_FRAME,
    RALLY,
    RELATIVE,
    RETURN,
    SET_HOME,
    SPEED,
    TURNS,
    WAYPOINT,
    item,
    listed,
    north_of,
    one,
    upload,
)

REFERENCE = Path(__file__).parents[2] / "reference"
OK, DENIED, FAILED = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_DENIED,
    mavlink.MAV_RESULT_FAILED,
)
START, PAUSE_CONTINUE = mavlink.MAV_CMD_MISSION_START, mavlink.MAV_CMD_DO_PAUSE_CONTINUE
SET_CURRENT = mavlink.MAV_CMD_DO_SET_MISSION_CURRENT
NO_MISSION, NOT_STARTED, ACTIVE, PAUSED, COMPLETE = 1, 2, 3, 4, 5
SQUARE = [(20.0, 0.0), (20.0, 20.0), (0.0, 20.0), (0.0, 0.0)]
DO = {"frame": MISSION_FRAME, "at": (0, 0)}
HERE = (3.0, -4.0, 0.0)


def square():
    return listed(*(one(at=north_of(*place)) for place in SQUARE))


class Mission(Bench):
    """A bench whose vehicle gets where it is sent when a test has it."""

    def __init__(self, items, **bench):
        super().__init__(**bench)
        assert upload(self, items) == 0
        self.measure(position_n=HERE)
        self.tick()
        self.transport.take()

    @property
    def leg(self):
        return self.node.missions.leg

    def go(self):
        """Start it as a ground station does, and let it begin."""
        assert self.command(START) == OK
        if not self.vehicle.armed:
            self.arm()
        self.tick()

    def arrive(self):
        """Be at the end of the leg, as guidance reports it."""
        self.measure(position_n=self.leg.end)
        self.node.missions.reached = self.leg.number
        self.tick()

    def reached(self):
        """Return and forget the items that were reported as reached."""
        return [m.seq for m in self.transport.take("MISSION_ITEM_REACHED", None)]

    def current(self):
        self.transport.take("MISSION_CURRENT")
        assert self.command(mavlink.MAV_CMD_REQUEST_MESSAGE, 42) == OK
        (m,) = self.transport.take("MISSION_CURRENT", STATION.link)
        return m.seq, m.mission_state

    def ends(self, most=20):
        """Arrive until the mission is complete; return where the legs led."""
        found = []
        while self.current()[1] == ACTIVE and len(found) < most:
            found.append(tuple(round(x) for x in self.leg.end[:2]))
            self.arrive()
        return found


# ---------------------------------------------------------------------- legs


def test_legs_lead_from_one_waypoint_to_the_next():
    boat = Mission(square(), waypoint_radius=2.5, cruise_speed=0.8)
    boat.go()
    starts = [HERE[:2], *SQUARE[:-1]]
    numbers = []
    for start, end in zip(starts, SQUARE, strict=True):
        leg = boat.leg
        assert leg.start[:2] == pytest.approx(start, abs=1e-2)
        assert leg.end[:2] == pytest.approx(end, abs=1e-2)
        assert (leg.speed, leg.radius, leg.wait, leg.circle) == (0.8, 2.5, 0.0, 0.0)
        numbers.append(leg.number)
        boat.arrive()
    assert len(set(numbers)) == 4
    assert 0 not in numbers
    assert boat.reached() == [1, 2, 3, 4]
    assert boat.current() == (4, COMPLETE)
    assert boat.leg == leg  # and there it stays


def test_a_px4_begins_with_item_0():
    boat = Mission(listed(*(one(at=north_of(*p)) for p in SQUARE), home=False), autopilot="px4")
    assert boat.one(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT).total == 4
    boat.go()
    assert boat.current() == (0, ACTIVE)
    assert boat.ends() == SQUARE
    assert boat.reached() == [0, 1, 2, 3]


def test_what_a_waypoint_requests():
    boat = Mission(listed(one(WAYPOINT, 7.5, 4.0), one(WAYPOINT, 0.0, -1.0, 0.0, math.nan)))
    boat.go()
    assert (boat.leg.wait, boat.leg.radius) == (7.5, 4.0)
    boat.arrive()
    assert (boat.leg.wait, boat.leg.radius) == (0.0, 3.0)


def test_a_leg_of_before_does_not_count():
    boat = Mission(square())
    boat.go()
    boat.arrive()
    boat.wait(1.0)  # guidance reports the old number for a while
    assert boat.current() == (2, ACTIVE)


def test_depth_is_negative_altitude():
    submarine = Mission(
        listed(
            one(z=-12.0, at=north_of(10), frame=RELATIVE),
            one(z=-12.0, at=north_of(10), frame=GLOBAL),
        ),
        submerged=True,
    )
    submarine.vehicle.home_n = (0.0, 0.0, 0.5)
    submarine.measure(position_n=(0.0, 0.0, 3.0))
    submarine.go()
    ends = []
    for _ in range(2):
        ends.append(submarine.leg.end[2])
        submarine.arrive()
    # Relative to home; above the sea, with the origin 2 m above.
    assert ends == pytest.approx([12.5, 14.0])


def test_a_place_that_is_not_given_is_here():
    boat = Mission(listed(one(LOITER_TIME, 5.0, at=(0, 0))))
    boat.go()
    assert boat.leg.end[:2] == pytest.approx(HERE[:2], abs=1e-6)


def test_speeds():
    boat = Mission(
        listed(
            one(at=north_of(10)),
            one(SPEED, 1.0, 1.5, -1.0, **DO),
            one(at=north_of(20)),
            one(SPEED, 1.0, -1.0, 50.0, **DO),
            one(at=north_of(30)),
            one(SPEED, 1.0, -2.0, **DO),
            one(at=north_of(40)),
        ),
        waypoint_speed=0.7,
    )
    boat.go()
    speeds = []
    while boat.current()[1] == ACTIVE:
        speeds.append(boat.leg.speed)
        boat.arrive()
    assert speeds == [0.7, 1.5, 1.5, 0.7]
    assert boat.reached() == [1, 2, 3, 4, 5, 6, 7]
    boat.enter("hold")
    boat.go()
    assert boat.leg.speed == 0.7


def test_the_speed_of_the_leg_changes_by_command():
    boat = Mission(square())
    assert boat.command(SPEED, 1, 2.0) == FAILED  # not in a mission
    boat.go()
    before = boat.leg
    assert boat.command(SPEED, 1, 2.0) == OK
    assert (boat.leg.number, boat.leg.end, boat.leg.speed) == (before.number, before.end, 2.0)
    for speed in (math.nan, math.inf, 0.0, -3.0, 1e6):
        assert boat.command(SPEED, 1, speed) == OK  # nothing requested
        assert boat.leg.speed == 2.0
    boat.arrive()
    assert boat.leg.speed == 2.0


@pytest.mark.parametrize(("radius", "circle"), [(0.0, 0.0), (6.0, 6.0), (-6.0, -6.0)])
def test_loiter_unlimited(radius, circle):
    boat = Mission(listed(one(LOITER, p3=radius, at=north_of(30)), one()))
    boat.go()
    assert (boat.leg.circle, boat.leg.radius, boat.leg.wait) == (circle, abs(circle) + 3.0, 0.0)
    boat.arrive()
    boat.wait(20.0)
    assert boat.current() == (1, ACTIVE)


@pytest.mark.slow
def test_loiter_time_is_waited_by_guidance():
    boat = Mission(listed(one(LOITER_TIME, 12.0, p3=-5.0), one(at=north_of(9))))
    boat.go()
    assert (boat.leg.wait, boat.leg.circle) == (12.0, -5.0)
    boat.wait(60.0)
    assert boat.current() == (1, ACTIVE)
    boat.arrive()
    assert boat.current() == (2, ACTIVE)
    # From the circle, not from its centre.
    assert boat.leg.start == boat.vehicle.estimates.position_n


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("turns", "radius"), [(2.0, 5.0), (0.5, 5.0), (1.0, 0.0)])
def test_turns_are_counted_from_the_arrival(way, turns, radius):
    boat = Mission(listed(one(TURNS, turns, p3=way * radius, at=north_of(0)), one(at=north_of(9))))
    boat.go()
    radius = radius or 10.0  # the vehicle's own, clockwise
    way = way if boat.leg.circle < 0 or way > 0 else 1
    assert boat.leg.circle == way * radius

    def circle(angle):
        bearing = 0.3 + way * angle
        centre = boat.leg.end
        boat.measure(
            position_n=(
                centre[0] + radius * math.cos(bearing),
                centre[1] + radius * math.sin(bearing),
                0.0,
            )
        )
        boat.tick()

    degrees = 0
    for _ in range(200):  # on the way to it turns are not counted
        degrees += 3
        circle(math.radians(degrees))
    boat.node.missions.reached = boat.leg.number
    start = degrees
    while boat.current() == (1, ACTIVE):
        degrees += 3
        circle(math.radians(degrees))
        assert degrees - start < 2000
    assert degrees - start == pytest.approx(turns * 360, abs=6)


def test_return_leads_to_home_and_goes_on():
    boat = Mission(listed(one(RETURN, **DO), one(at=north_of(50))))
    boat.vehicle.home_n = (-30.0, 5.0, 0.0)
    boat.tick()
    boat.go()
    assert boat.leg.end == (-30.0, 5.0, 0.0)
    boat.arrive()
    assert boat.current() == (2, ACTIVE)


def test_return_leads_to_the_nearest_rally_point():
    boat = Mission(listed(one(at=north_of(100)), one(RETURN, **DO)))
    upload(boat, listed(one(5100, at=north_of(90)), kind=RALLY), RALLY)
    boat.go()
    boat.arrive()
    assert boat.leg.end[0] == pytest.approx(90.0, abs=0.01)


def test_delay_holds_for_its_time():
    boat = Mission(listed(one(DELAY, 3.0, -1, -1, -1, **DO), one(at=north_of(9)), one(DELAY, 1.0)))
    boat.go()
    assert boat.leg.number == 0  # stays where it is
    boat.wait(2.98)
    assert boat.current() == (1, ACTIVE)
    boat.wait(0.03)
    assert boat.current() == (2, ACTIVE)
    boat.arrive()
    assert boat.current() == (3, ACTIVE)
    assert boat.leg.end[0] == pytest.approx(9.0, abs=0.01)  # stays at the waypoint
    boat.wait(1.01)
    assert boat.current() == (3, COMPLETE)


@pytest.mark.parametrize("command", [DELAY, None])
def test_a_circle_is_left_for_a_rest(command):
    after = [] if command is None else [one(DELAY, 5.0, **DO)]
    boat = Mission(listed(one(LOITER_TIME, 5.0, p3=8.0), *after))
    boat.go()
    boat.arrive()
    assert boat.leg.number == 0


def test_home_is_moved_by_the_mission():
    boat = Mission(
        listed(
            one(SET_HOME, 0.0, at=north_of(12, 5), z=2.0, frame=GLOBAL),
            one(at=north_of(40)),
            one(SET_HOME, 1.0, **DO),
            one(SET_HOME, 0.0, at=(0, 0)),
            one(at=north_of(50)),
        )
    )
    boat.go()
    assert boat.vehicle.home_n == pytest.approx((12.0, 5.0, 0.0), abs=0.01)
    boat.arrive()
    assert boat.vehicle.home_n == pytest.approx((40.0, 0.0, 0.0), abs=0.01)
    assert "DO_SET_HOME failed" in "".join(boat.texts())  # to another ocean


DELAYED, SET_MODE, FENCE_ENABLE = 112, 176, 207


@pytest.mark.parametrize(
    ("item", "result"),
    [
        ((one(180, 10.0, **DO)), mavlink.MAV_MISSION_UNSUPPORTED),  # DO_SET_PARAMETER
        ((one(113, 90.0, **DO)), mavlink.MAV_MISSION_UNSUPPORTED),  # CONDITION_CHANGE_ALT
        ((one(DELAYED, math.nan, **DO)), mavlink.MAV_MISSION_INVALID_PARAM1),
        ((one(SET_MODE, 1.0, 99.0, **DO)), mavlink.MAV_MISSION_INVALID_PARAM2),
        ((one(SET_MODE, 0.0, 4.0, **DO)), mavlink.MAV_MISSION_INVALID_PARAM1),
        ((one(FENCE_ENABLE, 2.0, **DO)), mavlink.MAV_MISSION_INVALID_PARAM1),
    ],
)
def test_what_is_not_carried_out_is_refused_at_upload(item, result):
    boat = Bench()
    assert upload(boat, listed(one(at=north_of(9)), item)) == result
    assert any("item 2" in text for text in boat.texts())


def answers_of_a_rover():
    """Return the items that ArduPilot Rover was given alone, and whether it stored each."""
    recorded = json.loads((REFERENCE / "ardupilot_answers_rover.json").read_text("utf-8"))
    asked = (REFERENCE / "ardupilot_requests.jsonl").read_text("utf-8").splitlines()
    for request in map(json.loads, asked):
        name = request["name"]
        if re.fullmatch(r"item [A-Z_0-9]+", name) and name in recorded:
            (given,) = request["do"][0]["items"]
            stored = recorded[name]["answers"][0] == "MISSION_ACK type=0 mission_type=0"
            yield pytest.param(given["command"], stored, id=name.removeprefix("item "))


@pytest.mark.parametrize(("command", "stored"), [*answers_of_a_rover()])
def test_what_a_rover_stores_is_stored(command, stored):
    boat = Bench()
    parameters = (0.0, 4.0) if command == SET_MODE else ()
    item = one(command, *parameters, at=north_of(9))
    accepted = upload(boat, listed(item)) == mavlink.MAV_MISSION_ACCEPTED
    # It has modes as items too, which a Rover of 4.7 refuses, and no value that it cannot mean.
    assert accepted == stored or command in (SET_MODE, JUMP)


@pytest.mark.parametrize("command", [21, 22, 115, 181, 183, 194, 195, 201, 206, 211])
def test_what_nothing_is_there_for_is_skipped_with_a_text(command):
    boat = Mission(listed(one(at=north_of(9)), one(command, **DO), one(at=north_of(18))))
    boat.go()
    assert boat.ends() == [(9, 0), (18, 0)]
    assert boat.current()[1] == COMPLETE
    assert any("skipped" in text for text in boat.texts())


def test_what_follows_a_condition_waits_while_the_boat_goes_on():
    boat = Mission(
        listed(
            one(DELAYED, 5.0, **DO),
            one(SPEED, 1.0, 0.4, **DO),
            one(at=north_of(9)),
            one(DELAYED, 5.0, **DO),
            one(SPEED, 1.0, 0.2, **DO),
            one(at=north_of(19)),
        )
    )
    boat.go()
    assert (boat.current()[0], boat.leg.speed) == (3, 1.0)
    boat.wait(4.9)
    assert boat.leg.speed == 1.0
    boat.wait(0.2)
    assert boat.leg.speed == 0.4
    assert boat.reached() == [1, 2]
    boat.arrive()
    boat.arrive()  # within the 5 s: what waited is dropped
    assert boat.current()[1] == COMPLETE
    assert any("item 5 dropped" in text for text in boat.texts())


def test_what_waits_at_the_end_of_a_mission_is_still_done():
    boat = Mission(listed(one(at=north_of(9)), one(DELAYED, 5.0, **DO), one(SPEED, 1, 0.4, **DO)))
    boat.go()
    boat.arrive()
    assert boat.current()[1] == ACTIVE
    boat.wait(5.1)
    assert boat.current()[1] == COMPLETE
    assert boat.reached() == [1, 2, 3]


def test_a_mission_sets_a_mode_and_goes_on_after_it():
    boat = Mission(listed(one(at=north_of(9)), one(SET_MODE, 1.0, 5.0, **DO), one(at=north_of(19))))
    boat.go()
    boat.arrive()
    assert boat.vehicle.mode.name == "loiter"
    assert boat.current() == (3, PAUSED)
    boat.enter("auto")
    boat.tick()
    assert boat.leg.end[0] == pytest.approx(19.0, abs=0.01)


def test_a_mission_switches_the_fence():
    off, on = (one(FENCE_ENABLE, value, **DO) for value in (0.0, 1.0))
    boat = Mission(listed(off, one(at=north_of(9)), on))
    boat.go()
    assert "Fence off" in boat.texts()
    boat.arrive()
    assert "Fence on" in boat.texts()


# ---------------------------------------------------------------------- jumps


@pytest.mark.parametrize(("times", "rounds"), [(0, 1), (1, 2), (3, 4)])
def test_jumps_are_repeated_as_often_as_they_say(times, rounds):
    boat = Mission(
        listed(
            one(at=north_of(1)),
            one(at=north_of(2)),
            one(JUMP, 1.0, times, **DO),
            one(at=north_of(3)),
        )
    )
    boat.go()
    assert boat.ends() == [*[(1, 0), (2, 0)] * rounds, (3, 0)]
    boat.enter("hold")
    boat.go()  # and again from the start
    assert boat.ends() == [*[(1, 0), (2, 0)] * rounds, (3, 0)]


def test_a_negative_count_jumps_always():
    boat = Mission(listed(one(at=north_of(1)), one(JUMP, 1.0, -1.0, **DO)))
    boat.go()
    assert boat.ends(most=50) == [(1, 0)] * 50


def test_a_jump_leads_to_its_tag_or_ends_the_mission():
    tag, back = (one(command, 7.0, 1.0, **DO) for command in (600, 601))
    boat = Mission(listed(tag, one(at=north_of(1)), back, one(at=north_of(2))))
    boat.go()
    assert boat.ends() == [(1, 0), (1, 0), (2, 0)]
    boat = Mission(listed(one(at=north_of(1)), back, one(at=north_of(2))))
    boat.go()
    assert boat.ends() == [(1, 0)]
    assert boat.current()[1] == COMPLETE


def test_jumps_ahead():
    boat = Mission(
        listed(
            one(at=north_of(1)), one(JUMP, 4.0, 1.0, **DO), one(at=north_of(2)), one(at=north_of(3))
        )
    )
    boat.go()
    assert boat.ends() == [(1, 0), (3, 0)]


@pytest.mark.parametrize(
    "items",
    [
        [one(JUMP, 1.0, -1.0, **DO)],
        [one(SPEED, 1.0, 2.0, **DO), one(JUMP, 1.0, -1.0, **DO)],
        [one(JUMP, 2.0, -1.0, **DO), one(JUMP, 1.0, -1.0, **DO)],
    ],
)
def test_jumps_without_an_end_end(items):
    boat = Mission(listed(*items))
    boat.go()
    assert boat.current()[1] == COMPLETE
    assert "Mission ended: its jumps have no end" in boat.texts()


# ---------------------------------------------------------------------- control


def test_auto_needs_a_mission():
    boat = Bench()
    assert boat.command(START) == FAILED
    assert "Mission not started: no mission" in boat.texts()
    assert boat.command(mavlink.MAV_CMD_DO_SET_MODE, 1, 10) == FAILED
    m = boat.one(mavlink.MAVLINK_MSG_ID_MISSION_CURRENT)
    assert (m.seq, m.total, m.mission_state, m.mission_mode) == (0, 0xFFFF, NO_MISSION, 2)
    upload(boat, listed())  # home alone is no mission
    assert boat.command(START) == FAILED


def test_nothing_moves_before_it_is_armed():
    boat = Mission(square())
    assert boat.current() == (0, NOT_STARTED)  # as an ArduPilot has it
    assert boat.command(START) == OK
    boat.wait(1.0)
    assert boat.current() == (1, NOT_STARTED)
    assert boat.leg.number == 0
    boat.arm()
    boat.tick()
    assert boat.current() == (1, ACTIVE)


def test_start_says_where_to_begin():
    boat = Mission(square())
    boat.arm()
    for first, last in [(9, 0), (-1, 0), (math.inf, 0), (0, 2), (5, 4)]:
        assert boat.command(START, first, last) == DENIED
    assert boat.vehicle.mode.name == "hold"
    assert boat.command(START, 3, 4) == OK
    boat.tick()
    assert boat.current() == (3, ACTIVE)
    assert boat.command(START, math.nan, math.nan) == OK  # goes on
    boat.tick()
    assert boat.current() == (3, ACTIVE)
    assert boat.ends() == SQUARE[2:]
    assert boat.command(START) == OK  # begins anew
    boat.tick()
    assert boat.current() == (1, ACTIVE)


def interrupt_by_mode(boat):
    boat.enter("manual")
    boat.tick()
    yield
    boat.enter("auto")


def interrupt_by_disarming(boat):
    assert boat.command(400, 0) == OK
    boat.tick()
    yield
    boat.arm()


def interrupt_by_pause(boat):
    assert boat.command(PAUSE_CONTINUE, 0) == OK
    boat.tick()
    yield
    assert boat.command(PAUSE_CONTINUE, 1) == OK


def interrupt_by_pause_and_start(boat):
    assert boat.command(PAUSE_CONTINUE, 0) == OK
    boat.tick()
    yield
    assert boat.command(START) == OK


interruptions = pytest.mark.parametrize(
    "interruption",
    [
        interrupt_by_mode,
        interrupt_by_disarming,
        interrupt_by_pause,
        interrupt_by_pause_and_start,
    ],
)


@interruptions
def test_an_interrupted_item_begins_anew_where_the_vehicle_is(interruption):
    boat = Mission(square())
    boat.go()
    boat.arrive()
    number = boat.leg.number
    interrupted = interruption(boat)
    next(interrupted)
    assert (boat.leg.number, boat.current()) == (0, (2, PAUSED))
    boat.measure(position_n=(7.0, 8.0, 0.0))
    boat.node.missions.reached = number
    boat.wait(30.0)
    assert boat.current() == (2, PAUSED)
    list(interrupted)
    boat.tick()
    assert boat.current() == (2, ACTIVE)
    assert boat.leg.number > number
    assert boat.leg.start == (7.0, 8.0, 0.0)
    assert boat.leg.end[:2] == pytest.approx(SQUARE[1], abs=0.01)


def test_another_mode_ends_a_pause():
    boat = Mission(square())
    boat.go()
    boat.command(PAUSE_CONTINUE, 0)
    boat.enter("hold")
    boat.tick()
    boat.enter("auto")
    boat.tick()
    assert boat.current() == (1, ACTIVE)


def test_pauses_are_for_missions():
    boat = Mission(square())
    assert boat.command(PAUSE_CONTINUE, 0) == DENIED
    boat.go()
    for value in (0.5, -1, math.nan):
        assert boat.command(PAUSE_CONTINUE, value) == DENIED


def set_by_command(boat, sequence):
    return boat.command(SET_CURRENT, sequence) == OK


def set_by_message(boat, sequence):
    boat.receive(mavlink.MAVLink_mission_set_current_message(7, 1, sequence))
    return "There is no mission item" not in "".join(boat.texts())


@pytest.mark.parametrize("set_current", [set_by_command, set_by_message])
def test_set_current(set_current):
    boat = Mission(square())
    assert set_current(boat, 3)
    assert boat.current() == (3, NOT_STARTED)
    boat.go()
    boat.measure(position_n=(1.0, 2.0, 0.0))
    assert set_current(boat, 2)
    boat.tick()
    assert boat.current() == (2, ACTIVE)
    assert boat.leg.start == (1.0, 2.0, 0.0)
    assert boat.ends() == SQUARE[1:]
    assert set_current(boat, 4)  # goes on after the end
    boat.tick()
    assert boat.current() == (4, ACTIVE)
    assert not set_current(boat, 5)
    assert boat.current() == (4, ACTIVE)
    assert set_current(boat, 0)  # home: from the first
    boat.tick()
    assert boat.current() == (1, ACTIVE)


def test_set_current_out_of_range():
    boat = Mission(square())
    for sequence in (5, 1000, math.nan, math.inf):
        assert boat.command(SET_CURRENT, sequence) == DENIED
    assert Bench().command(SET_CURRENT, 0) == DENIED


def test_set_current_is_always_answered():
    boat = Mission(square())
    boat.receive(mavlink.MAVLink_mission_set_current_message(7, 1, 1))
    boat.tick()
    assert [m.seq for m in boat.transport.take("MISSION_CURRENT", None)] == [1]


def test_jumps_are_counted_anew_if_requested():
    items = listed(one(at=north_of(1)), one(JUMP, 1.0, 1.0, **DO), one(at=north_of(2)))
    boat = Mission(items)
    boat.go()
    assert boat.ends() == [(1, 0), (1, 0), (2, 0)]
    boat.command(SET_CURRENT, 1)
    boat.tick()
    assert boat.ends() == [(1, 0), (2, 0)]
    boat.command(SET_CURRENT, 1, 1)
    boat.tick()
    assert boat.ends() == [(1, 0), (1, 0), (2, 0)]
    assert boat.command(SET_CURRENT, -1, 1) == DENIED  # PX4: goes on
    assert boat.command(SET_CURRENT, 3, 1) == OK
    boat.tick()
    assert boat.current() == (3, ACTIVE)


def test_another_mission_begins_at_once():
    boat = Mission(square())
    boat.go()
    boat.arrive()
    number = boat.leg.number
    assert upload(boat, listed(one(at=north_of(77)))) == 0
    boat.tick()
    assert boat.current() == (1, ACTIVE)
    assert boat.leg.number > number
    assert boat.leg.end[0] == pytest.approx(77.0, abs=0.01)


def test_a_cleared_mission_stops():
    boat = Mission(square())
    boat.go()
    assert upload(boat, []) == 0
    boat.tick()
    assert boat.leg.number == 0
    assert boat.current() == (0, NO_MISSION)


def test_current_is_streamed_and_sent_at_every_change():
    boat = Mission(square())
    boat.transport.take()
    boat.wait(10.0)
    assert len(boat.transport.take("MISSION_CURRENT", STATION.link)) == 10
    boat.go()
    (m,) = boat.transport.take("MISSION_CURRENT", None)[-1:]
    assert (m.seq, m.total, m.mission_state, m.mission_mode) == (1, 4, ACTIVE, 1)
    boat.arrive()
    (m,) = boat.transport.take("MISSION_CURRENT", None)
    assert m.seq == 2


def test_what_is_done_is_reported():
    boat = Mission(square())
    boat.go()
    assert "Mission: item 1, NAV_WAYPOINT" in boat.texts()
    boat.ends()
    assert "Mission complete" in boat.texts()


# ---------------------------------------------------------------------- guided items


def guide(boat, **more):
    boat.transport.take()
    boat.receive(item(0, current=2, at=north_of(15), **more))
    (answer,) = boat.transport.take("MISSION_ACK", STATION.link)
    return answer.type


def test_an_item_in_guided_mode_is_a_place_to_go_to():
    boat = Bench()
    assert guide(boat) == mavlink.MAV_MISSION_ERROR
    boat.enter("guided")
    assert guide(boat) == mavlink.MAV_MISSION_ACCEPTED
    assert boat.vehicle.target.position[:2] == pytest.approx((15.0, 0.0), abs=0.01)
    assert guide(boat, frame=MISSION_FRAME) == mavlink.MAV_MISSION_UNSUPPORTED_FRAME


def test_an_item_in_guided_mode_is_no_part_of_an_upload():
    boat = Bench()
    boat.enter("guided")
    boat.receive(mavlink.MAVLink_mission_count_message(7, 1, 2, 0))
    guide(boat)
    boat.wait(1.0)
    (request,) = boat.transport.take("MISSION_REQUEST_INT")
    assert request.seq == 0


def test_places_of_the_bench_are_where_they_should_be():
    # What the tests above rest on: the bench's own metres per degree.
    north, east, _ = Bench().vehicle.origin.position(*north_of(100, 100), 0.0)
    assert (north, east) == pytest.approx((100.0, 100.0), abs=5e-3)
    assert north_of(0) == (LATITUDE, LONGITUDE)
