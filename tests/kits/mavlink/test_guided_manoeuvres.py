"""Guided set-points that last: headings that turn, speeds, and where a PX4 stays."""

import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import ORIGIN, Bench

BODY = mavlink.MAV_FRAME_BODY_NED
VELOCITY_AND_RATE = 0x5C7  # as MAVSDK sends it: all ignored but the velocity and the yaw rate
CHANGE_SPEED, REPOSITION = mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.MAV_CMD_DO_REPOSITION
OK, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
FAILED = mavlink.MAV_RESULT_FAILED
EAST = math.pi / 2


def ahead(speed, rate, down=0.0):
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 7, 1, BODY, VELOCITY_AND_RATE, 0, 0, 0, speed, 0, down, 0, 0, 0, 0, rate
    )


def place(north=4.0, east=3.0):
    latitude, longitude, _ = ORIGIN.geodetic((north, east, 0.0))
    return {"frame": 6, "x": round(latitude * 1e7), "y": round(longitude * 1e7), "z": 0.0}


def guided(**kind):
    bench = Bench(**kind)
    bench.enter("guided")
    bench.measure(position_n=(10.0, 20.0, 5.0), attitude=(0.0, 0.0, EAST))
    return bench


def test_a_velocity_ahead_holds_the_heading_at_which_it_began():
    boat = guided()
    boat.receive(ahead(0.6, 0.0))
    boat.wait(0.1)
    boat.measure(attitude=(0.0, 0.0, EAST + 0.3))  # pushed aside
    boat.receive(ahead(0.5, 0.0))
    boat.wait(0.1)
    target = boat.vehicle.target
    assert (target.kind, target.speed) == ("heading", 0.5)
    assert target.heading == pytest.approx(EAST)


def test_a_yaw_rate_turns_the_heading_as_far_as_the_craft_follows():
    boat = guided()
    boat.receive(ahead(0.6, 0.2))
    boat.wait(1.0)
    assert boat.vehicle.target.heading == pytest.approx(EAST + 0.2, abs=1e-9)
    boat.receive(ahead(0.6, -0.1))
    boat.wait(1.0)
    assert boat.vehicle.target.heading == pytest.approx(EAST + 0.1, abs=1e-9)
    for _ in range(9):
        boat.receive(ahead(0.6, -2.0))
        boat.wait(1.0)
    assert boat.vehicle.target.heading == pytest.approx(EAST - 0.5, abs=1e-9)
    boat.wait(3.1)
    assert boat.vehicle.target is None


@pytest.mark.parametrize("heading", [0.1, -0.1, math.pi - 0.05, -math.pi + 0.05])
@pytest.mark.parametrize("rate", [0.2, -0.2])
def test_a_yaw_rate_turns_on_across_north_and_south(heading, rate):
    boat = guided()
    boat.measure(attitude=(0.0, 0.0, heading))
    for seconds in range(1, 4):
        boat.receive(ahead(0.6, rate))
        boat.wait(1.0)
        wanted = heading + rate * seconds
        assert math.remainder(boat.vehicle.target.heading - wanted, math.tau) == pytest.approx(0.0)
        boat.measure(attitude=(0.0, 0.0, math.remainder(wanted, math.tau)))
        reported = boat.one(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED)
        assert reported.yaw == pytest.approx(math.remainder(wanted, math.tau))


def test_a_submarine_dives_on_the_way_and_a_boat_does_not():
    for kind, down in (({"submerged": True}, 5.3), ({}, 5.0)):
        craft = guided(**kind)
        craft.receive(ahead(0.2, 0.0, down=0.1))
        craft.wait(3.0)
        assert craft.vehicle.target.position == pytest.approx((10.0, 20.0, down))


def test_a_rate_that_is_none_is_not_obeyed():
    boat = guided()
    for rate in (math.nan, math.inf, 1e9):
        boat.receive(ahead(0.6, rate))
        assert boat.vehicle.target is None


def test_a_speed_applies_to_places_until_the_mode_ends():
    boat = guided()
    assert boat.command_int(REPOSITION, -1.0, 0, **place()) == OK
    assert boat.command(CHANGE_SPEED, 1, 0.4, -1) == OK
    assert boat.vehicle.target.speed == pytest.approx(0.4)
    assert boat.command_int(REPOSITION, -1.0, 0, **place(8.0)) == OK
    assert boat.vehicle.target.speed == pytest.approx(0.4)
    for nothing in (-1.0, 0.0, math.nan, 1e9):
        assert boat.command(CHANGE_SPEED, 1, nothing, -1) == OK
        assert boat.vehicle.target.speed == pytest.approx(0.4)
    assert boat.command(CHANGE_SPEED, 1, -2.0, -1) == OK  # its own again
    assert boat.vehicle.target.speed == 0.0
    assert boat.command(CHANGE_SPEED, 1, 0.3, -1) == OK
    boat.enter("hold")
    assert boat.command(CHANGE_SPEED, 1, 0.2, -1) == FAILED
    boat.enter("guided")
    assert boat.command_int(REPOSITION, -1.0, 0, **place()) == OK
    assert boat.vehicle.target.speed == 0.0


def test_a_px4_shows_hold_while_it_goes_elsewhere():
    boat = Bench(autopilot="px4")
    hold = boat.vehicle.dialect.mode("hold")
    assert boat.command_int(REPOSITION, -1.0, 0, **place()) == DENIED
    assert boat.command_int(REPOSITION, -1.0, 1, **place()) == OK
    assert boat.vehicle.mode.name == "guided"  # to guidance
    boat.transport.take()
    boat.wait(1.0)
    (heartbeat, *_) = boat.transport.take("HEARTBEAT")
    assert heartbeat.custom_mode == hold.custom_mode
    boat.receive(ahead(0.6, 0.0))  # applies in Offboard alone
    assert boat.vehicle.target.kind == "position"
    boat.enter("hold")
    assert boat.vehicle.target is None
