import math

import pytest
from pymavlink.dialects.v20 import all as mavlink
from pymavlink.quaternion import Quaternion

from .bench import ORIGIN, Bench

NED, OFFSET, BODY, BODY_OFFSET, FRD = 1, 7, 8, 9, 12
POSITION, VELOCITY, YAW = 0xDF8, 0xDC7, 0x9FF  # masks with the rest ignored
VELOCITY_AND_YAW = 2503  # as MAVSDK sends it
REPOSITION = mavlink.MAV_CMD_DO_REPOSITION
OK, DENIED, FAILED = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_DENIED,
    mavlink.MAV_RESULT_FAILED,
)
NAN = float("nan")


def local(frame, mask, position=(0, 0, 0), velocity=(0, 0, 0), yaw=0.0):
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 7, 1, frame, mask, *position, *velocity, 0, 0, 0, yaw, 0
    )


def global_(frame, mask, latitude, longitude, altitude, velocity=(0, 0, 0)):
    return mavlink.MAVLink_set_position_target_global_int_message(
        0, 7, 1, frame, mask, round(latitude * 1e7), round(longitude * 1e7), altitude,
        *velocity, 0, 0, 0, 0, 0,
    )  # fmt: skip


def attitude(heading, thrust, mask=0x7):
    return mavlink.MAVLink_set_attitude_target_message(
        0, 7, 1, mask, list(Quaternion([0.05, -0.1, heading]).q), 0, 0, 0, thrust
    )


@pytest.fixture
def boat():
    bench = Bench()
    bench.enter("guided")
    bench.measure(position_n=(10.0, 20.0, 0.2), attitude=(0.0, 0.0, math.pi / 2))
    return bench


@pytest.fixture
def submarine():
    bench = Bench(submerged=True)
    bench.enter("guided")
    bench.measure(position_n=(10.0, 20.0, 5.0), attitude=(0.0, 0.0, math.pi / 2))
    return bench


# The craft heads east at (10, 20): 1 ahead of it is 1 further east, 1 to starboard 1 further south.
@pytest.mark.parametrize(
    ("frame", "position", "wanted"),
    [
        (NED, (3, 4, 5), (3, 4, 5)),
        (OFFSET, (3, 4, 1), (13, 24, 6)),
        (BODY, (3, 4, 1), (6, 23, 6)),
        (BODY_OFFSET, (3, 4, 1), (6, 23, 6)),
        (FRD, (3, 4, -1), (6, 23, 4)),
    ],
)
def test_local_positions_in_every_frame(boat, submarine, frame, position, wanted):
    for bench in (boat, submarine):
        bench.receive(local(frame, POSITION, position))
        assert bench.vehicle.target.kind == "position"
    assert submarine.vehicle.target.position == pytest.approx(wanted)
    # A boat stays on the surface.
    assert boat.vehicle.target.position == pytest.approx((*wanted[:2], 0.2))


def test_a_depth_that_is_ignored_is_kept(submarine):
    for frame in (NED, BODY):
        submarine.receive(local(frame, POSITION | 4, (1, 1, 99)))
        assert submarine.vehicle.target.position[2] == 5.0


@pytest.mark.parametrize(
    ("frame", "wanted"), [(NED, (1, 2, 0.5)), (OFFSET, (1, 2, 0.5)), (BODY, (-2, 1, 0.5))]
)
def test_velocities(submarine, boat, frame, wanted):
    for mask in (VELOCITY, VELOCITY_AND_YAW):
        submarine.receive(local(frame, mask, velocity=(1, 2, 0.5), yaw=0.3))
        assert submarine.vehicle.target.kind == "velocity"
        assert submarine.vehicle.target.velocity == pytest.approx(wanted)
    boat.receive(local(frame, VELOCITY, velocity=(1, 2, 0.5)))
    assert boat.vehicle.target.velocity == pytest.approx((*wanted[:2], 0.0))


@pytest.mark.parametrize(("frame", "heading"), [(NED, 0.3), (BODY, math.pi / 2 + 0.3)])
def test_a_yaw_alone_turns_on_the_spot(boat, frame, heading):
    boat.receive(local(frame, YAW, yaw=0.3))
    target = boat.vehicle.target
    assert (target.kind, target.speed) == ("heading", 0.0)
    assert target.heading == pytest.approx(heading)


def test_attitudes_give_heading_and_share_of_full_speed():
    bench = Bench(full_speed=1.6)
    bench.enter("guided")
    bench.receive(attitude(-2.0, 0.5))
    target = bench.vehicle.target
    assert (target.kind, target.speed) == ("heading", pytest.approx(0.8))
    assert target.heading == pytest.approx(-2.0, abs=1e-6)
    bench.receive(attitude(1.0, 0.5, mask=0x7 | 0x40))
    assert bench.vehicle.target.speed == 0.0


def test_global_positions(submarine, boat):
    latitude, longitude, _ = ORIGIN.geodetic((100.0, -50.0, 0.0))
    for frame, altitude in ((0, -10.0), (5, -10.0), (3, -12.0), (6, -12.0)):
        submarine.receive(global_(frame, POSITION, latitude, longitude, altitude))
        # The origin is 2 m above the sea, home is there; 1e-7 degrees are 1 cm.
        assert submarine.vehicle.target.position == pytest.approx((100.0, -50.0, 12.0), abs=0.02)
        boat.receive(global_(frame, POSITION, latitude, longitude, altitude))
        assert boat.vehicle.target.position == pytest.approx((100.0, -50.0, 0.2), abs=0.02)


def test_velocities_with_global_frames_are_north_and_east(boat):
    boat.receive(global_(6, VELOCITY, 0, 0, 0, velocity=(0.5, -0.5, 0)))
    assert boat.vehicle.target.velocity == (0.5, -0.5, 0.0)


@pytest.mark.parametrize(
    "message",
    [
        local(NED, POSITION, (NAN, 0, 0)),
        local(NED, POSITION, (float("inf"), 0, 0)),
        local(NED, POSITION, (3e38, 0, 0)),
        local(NED, VELOCITY, velocity=(0, 1e4, 0)),
        local(NED, YAW, yaw=NAN),
        local(NED, 0xFFF),
        local(4, POSITION, (1, 1, 1)),  # ENU is not supported
        global_(6, POSITION, 91.0, 0.0, 0.0),
        global_(6, POSITION, 31.78, 52.26, 0.0),  # the other side of the Earth
        global_(11, POSITION, -31.78, -52.26, 0.0),  # above terrain that is not known
        attitude(1.0, NAN),
        attitude(1.0, 1.0, mask=0x87),
        mavlink.MAVLink_set_attitude_target_message(0, 7, 1, 7, [0, 0, 0, 0], 0, 0, 0, 1),
    ],
)
def test_what_makes_no_sense_changes_nothing(boat, message):
    boat.receive(local(NED, POSITION, (1, 2, 3)))
    before = boat.vehicle.target
    boat.receive(message)
    assert boat.vehicle.target is before


def test_only_guided_mode_takes_set_points():
    bench = Bench()
    for message in (local(NED, POSITION), attitude(1.0, 1.0)):
        bench.receive(message)
        assert bench.vehicle.target is None


@pytest.mark.parametrize(
    "message", [local(NED, POSITION), local(NED, VELOCITY), attitude(1.0, 1.0)]
)
def test_set_points_count_as_long_as_they_come(message):
    bench = Bench(target_timeout=3.0)
    bench.enter("guided")
    for _ in range(4):
        bench.receive(message)
        bench.wait(2.9)
        assert bench.vehicle.target is not None
    bench.wait(0.1)
    assert bench.vehicle.target is not None
    bench.tick()
    assert bench.vehicle.target is None
    assert bench.vehicle.mode.name == "guided"


# ------------------------------------------------------------------ reposition


def at(position):
    latitude, longitude, _ = ORIGIN.geodetic(position)
    return {"x": round(latitude * 1e7), "y": round(longitude * 1e7)}


@pytest.mark.parametrize("speed", [NAN, 0.0, -1.0])
def test_reposition_stays(boat, speed):
    place = at((40.0, 30.0, 0.0))
    assert boat.command_int(REPOSITION, speed, 0, NAN, NAN, frame=6, z=0.0, **place) == OK
    boat.wait(20.0)
    target = boat.vehicle.target
    assert target.kind == "position"
    assert target.position == pytest.approx((40.0, 30.0, 0.2), abs=0.02)
    assert target.speed == 0.0


def test_reposition_with_a_speed(boat):
    assert boat.command_int(REPOSITION, 0.7, 0, frame=0, z=0.0, **at((4.0, 3.0, 0.0))) == OK
    assert boat.vehicle.target.speed == pytest.approx(0.7)


def test_reposition_as_a_long_command(boat):
    latitude, longitude, _ = ORIGIN.geodetic((400.0, 300.0, 0.0))
    assert boat.command(REPOSITION, -1, 0, 0, NAN, latitude, longitude, 0) == OK
    assert boat.vehicle.target.position == pytest.approx((400.0, 300.0, 0.2), abs=1e-3)


def test_reposition_enters_guided_mode_if_it_says_so():
    bench = Bench()
    place = {"frame": 6, "z": 0.0, **at((4.0, 3.0, 0.0))}
    assert bench.command_int(REPOSITION, NAN, 0, **place) == DENIED
    assert bench.vehicle.mode.name == "hold"
    assert bench.command_int(REPOSITION, NAN, 1, **place) == OK
    assert bench.vehicle.mode.name == "guided"
    assert bench.vehicle.target.kind == "position"
    lost = Bench(valid=False)
    assert lost.command_int(REPOSITION, NAN, 1, **place) == FAILED
    assert lost.vehicle.target is None


@pytest.mark.parametrize(
    "place",
    [
        {"frame": 6, "x": 0x7FFFFFFF, "y": 0x7FFFFFFF, "z": 0.0},  # not given
        {"frame": 6, "x": 0, "y": 0, "z": 0.0},  # thousands of kilometres away
        {"frame": 1, "x": 10, "y": 10, "z": 0.0},
        {"frame": 2, "x": 10, "y": 10, "z": 0.0},
    ],
)
def test_reposition_to_nowhere_is_denied(boat, place):
    assert boat.command_int(REPOSITION, NAN, 1, **place) == DENIED
    assert boat.vehicle.target is None


def test_the_set_point_is_sent(boat):
    number = mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED
    assert boat.request(number) == (DENIED, [])
    boat.receive(local(NED, POSITION, (3, 4, 0)))
    reported = boat.one(number)
    assert (reported.x, reported.y, reported.type_mask & 0x7) == (3.0, 4.0, 0)
