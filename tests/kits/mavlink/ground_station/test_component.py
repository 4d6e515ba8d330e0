"""The ground station against pymavlink's own end of a vehicle."""

from __future__ import annotations

import math
import time

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from seatrial.errors import InputError, SimulationError
from seatrial_kits.mavlink.ground_station.component import GroundStation

from .vehicle import AUTO, HOME, Px4Vehicle, Vehicle, geodetic, placed, radii

PLACES = [(30.0, 0.0, 0.0), (30.0, -40.0, 0.0), (0.0, 0.0, 2.5)]


class Bench:
    """A station and a vehicle, which take turns every 0.1 s of simulated time."""

    def __init__(self, **values):
        self.station, self.t = GroundStation("station"), 0.0
        places = {f"waypoint_{number}": place for number, place in enumerate(PLACES, 1)}
        origin = dict(zip(("latitude", "longitude"), map(math.radians, HOME), strict=True))
        settings = {"link": "tcpin:127.0.0.1:0", "count": 3.0, "radius": 2.0}
        settings |= {**origin, **places, **values}
        for name, value in settings.items():
            self.station.set(name, value)
        self.station.setup(0.0)
        self.station.initialise()
        self.station.begin()
        self._vehicles = []

    def vehicle(self, kind=Vehicle, **options):
        _, host, port = self.station._endpoint.url.split(":")
        made = kind((host, int(port)), **options)
        self._vehicles.append(made)
        return made

    def run(self, vehicle, seconds):
        for number in range(round(seconds / 0.1)):
            if number % 5 == 0:
                vehicle.beat()
            vehicle.attend()
            self.station.advance(self.t, 0.1)
            self.t += 0.1

    def close(self):
        self.station.close()
        for each in self._vehicles:
            each.socket.close()


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


def test_a_mission_is_uploaded_armed_and_started(bench):
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    assert sorted(vehicle.items) == [0, 1, 2, 3]  # 0 is home
    for number, (north, east, down) in enumerate(PLACES, 1):
        item = vehicle.items[number]
        assert placed(item) == pytest.approx((north, east), abs=0.02)  # 1e-7 degrees are 0.011 m
        assert (item.z, item.param2) == (-down, 2.0)
        assert item.command == mavlink.MAV_CMD_NAV_WAYPOINT
        assert item.frame == mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    assert (vehicle.armed, vehicle.mode) == (True, AUTO)
    station = bench.station
    assert station.get("under_way")
    assert station.get("armed")
    assert (station.get("mode"), station.get("doing")) == (AUTO, "")
    assert not station.get("failsafe")


def test_waypoints_do_not_depend_on_where_the_vehicle_takes_its_home_to_be(bench):
    vehicle = bench.vehicle()
    vehicle.home = geodetic(-3.0, 21.0)
    bench.run(vehicle, 10.0)
    for number, (north, east, _) in enumerate(PLACES, 1):
        assert placed(vehicle.items[number]) == pytest.approx((north, east), abs=0.02)
    assert bench.station.get("home") == pytest.approx((-3.0, 21.0, 0.0), abs=0.02)


def test_a_vehicle_at_the_other_end_of_the_world(bench):
    vehicle = bench.vehicle()
    vehicle.home = (63.44, 10.40)
    with pytest.raises(SimulationError, match=r"63.44.*10.40.* 50 km from latitude -31.78"):
        bench.run(vehicle, 10.0)


def test_where_the_vehicle_takes_itself_to_be(bench):
    vehicle = bench.vehicle()
    assert not bench.station.get("estimated")
    vehicle.place, vehicle.ms = (12.0, -7.0), 1250
    bench.run(vehicle, 10.0)
    assert bench.station.get("estimated")
    assert bench.station.get("estimate") == pytest.approx((12.0, -7.0, 0.0), abs=0.02)
    assert bench.station.get("estimate_time") == 1.25


def test_a_place_of_zeros_is_none(bench):
    vehicle = bench.vehicle()
    vehicle.place = tuple(-math.radians(x) * r for x, r in zip(HOME, radii(), strict=True))
    bench.run(vehicle, 5.0)
    assert bench.station.get("connected")
    assert not bench.station.get("estimated")


def test_it_beats_as_a_ground_station_once_a_second(bench):
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    beats = [m for m in vehicle.received if m.get_type() == "HEARTBEAT"]
    assert len(beats) == pytest.approx(10, abs=1)
    assert {(b.type, b.get_srcSystem()) for b in beats} == {(mavlink.MAV_TYPE_GCS, 255)}
    assert not [m for m in vehicle.received if m.get_type() == "MANUAL_CONTROL"]


def test_what_the_vehicle_loses_is_sent_again(bench):
    lost = ("MISSION_COUNT", "MISSION_ITEM_INT", "COMMAND_LONG")
    vehicle = bench.vehicle(deaf=lost)
    bench.run(vehicle, 20.0)
    assert sorted(vehicle.items) == [0, 1, 2, 3]
    assert bench.station.get("under_way")


def test_it_waits_for_the_estimator_and_says_for_what(bench):
    vehicle = bench.vehicle()
    vehicle.healthy = False
    bench.run(vehicle, 20.0)
    assert bench.station.get("doing") == "estimate that lets it arm"
    assert not vehicle.items
    vehicle.healthy = True
    bench.run(vehicle, 10.0)
    assert bench.station.get("under_way")


def test_arming_is_tried_again(bench):
    vehicle = bench.vehicle()
    vehicle.arms_after = 3
    bench.run(vehicle, 5.0)
    assert bench.station.get("doing") == "arming"
    bench.run(vehicle, 10.0)
    assert bench.station.get("under_way")


def test_what_never_comes_ends_the_run_with_what_the_vehicle_said(bench):
    vehicle = bench.vehicle()
    vehicle.healthy = False
    bench.run(vehicle, 1.0)
    vehicle.say("PreArm: compass not calibrated")
    said = r"station: no estimate .* within 180 s; the vehicle said: PreArm: compass not calibrated"
    with pytest.raises(SimulationError, match=said):
        bench.run(vehicle, 200.0)


PX4_MISSION = 0x04040000
"""PX4's custom_mode AUTO.MISSION, as QGroundControl and MAVSDK have it."""


def test_px4_is_sent_round_in_its_own_way(bench):
    vehicle = bench.vehicle(Px4Vehicle)
    bench.run(vehicle, 10.0)
    assert sorted(vehicle.items) == [0, 1, 2]  # home is none of them
    for number, (north, east, down) in enumerate(PLACES):
        item = vehicle.items[number]
        assert placed(item) == pytest.approx((north, east), abs=0.02)
        assert item.z == pytest.approx(-down)
    orders = [m.command for m in vehicle.received if m.get_type() == "COMMAND_LONG"]
    arm, mode = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE
    assert [each for each in orders if each in (arm, mode)] == [mode, arm]
    assert (vehicle.mode, vehicle.armed) == (PX4_MISSION, True)
    vehicle.reach(0)
    bench.run(vehicle, 1.0)
    assert bench.station.get("reached") == 1
    assert bench.station.get("failsafe") is False
    vehicle.mode = 0x03040000  # it goes into hold
    bench.run(vehicle, 2.0)
    assert bench.station.get("failsafe") is True


def test_silence_ends_the_run(bench):
    with pytest.raises(SimulationError, match=r"no heartbeat within 60 s; .* said: nothing"):
        for _ in range(700):
            bench.station.advance(bench.t, 0.1)
            bench.t += 0.1


def test_a_mission_that_is_refused_ends_the_run(bench):
    vehicle = bench.vehicle()
    vehicle.result = mavlink.MAV_MISSION_NO_SPACE
    with pytest.raises(SimulationError, match="refused the mission: MAV_MISSION_NO_SPACE"):
        bench.run(vehicle, 10.0)


@pytest.mark.parametrize(
    ("autopilot", "kind"),
    [
        (mavlink.MAV_AUTOPILOT_PX4, mavlink.MAV_TYPE_SUBMARINE),
        (mavlink.MAV_AUTOPILOT_GENERIC, mavlink.MAV_TYPE_SURFACE_BOAT),
        (mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, mavlink.MAV_TYPE_FIXED_WING),
    ],
)
def test_other_vehicles_are_refused(bench, autopilot, kind):
    vehicle = bench.vehicle()
    vehicle.autopilot, vehicle.kind = autopilot, kind
    said = f"MAV_TYPE {kind} with MAV_AUTOPILOT {autopilot}; missions are for"
    with pytest.raises(SimulationError, match=said):
        bench.run(vehicle, 2.0)


def alarm(vehicle):
    vehicle.state = mavlink.MAV_STATE_CRITICAL


def leave(vehicle):
    vehicle.mode = 4


def disarm(vehicle):
    vehicle.armed = False


@pytest.mark.parametrize("happens", [alarm, leave, disarm])
def test_a_failsafe_is_seen_and_remembered(bench, happens):
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    assert not bench.station.get("failsafe")
    happens(vehicle)
    bench.run(vehicle, 2.0)
    vehicle.state, vehicle.mode, vehicle.armed = mavlink.MAV_STATE_ACTIVE, AUTO, True
    bench.run(vehicle, 2.0)
    assert bench.station.get("failsafe")


def test_after_the_last_waypoint_the_vehicle_may_do_as_it_likes(bench):
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    for number in (1, 2, 3):
        vehicle.reach(number)
    bench.run(vehicle, 1.0)
    assert bench.station.get("reached") == 3
    disarm(vehicle)
    bench.run(vehicle, 2.0)
    assert not bench.station.get("failsafe")


def test_a_submarine_arms_where_it_is_and_has_manual_control_at_rest(bench):
    vehicle = bench.vehicle()
    vehicle.kind = mavlink.MAV_TYPE_SUBMARINE
    bench.run(vehicle, 10.0)
    modes = [int(m.param2) for m in vehicle.received if getattr(m, "command", 0) == 176]
    assert modes == [2, 3]  # depth hold, auto: ArduSub's numbers
    manual = [m for m in vehicle.received if m.get_type() == "MANUAL_CONTROL"]
    assert {(m.x, m.y, m.z, m.r, m.buttons) for m in manual} == {(0, 0, 500, 0, 0)}
    assert len(manual) >= 8


def test_a_multirotor_takes_off_and_lands_at_the_last_waypoint():
    bench = Bench(last="land", waypoint_1=(6.0, 0.0, -5.0))
    vehicle = bench.vehicle()
    vehicle.kind = mavlink.MAV_TYPE_QUADROTOR
    bench.run(vehicle, 10.0)
    commands = [vehicle.items[number].command for number in range(5)]
    assert commands[1:] == [22, 16, 16, 21]  # take off, two waypoints, land: common.xml
    assert vehicle.items[1].z == 5.0
    modes = [int(m.param2) for m in vehicle.received if getattr(m, "command", 0) == 176]
    assert modes == [4, 3]  # guided, auto: ArduCopter's numbers
    for seq, reached in ((1, 0), (2, 1), (3, 2), (4, 3)):
        vehicle.reach(seq)
        for _ in range(50):  # the message takes its time on a busy machine
            bench.run(vehicle, 0.5)
            if bench.station.get("reached") == reached:
                break
            time.sleep(0.02)
        assert bench.station.get("reached") == reached
    vehicle.armed = False
    bench.run(vehicle, 2.0)
    assert not bench.station.get("failsafe")
    bench.close()


def test_a_boat_loiters_at_the_last_waypoint():
    bench = Bench(last="loiter", count=1.0)
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    assert [vehicle.items[number].command for number in (0, 1)] == [16, 17]
    bench.close()


def test_instruments_are_taken_and_given_back(bench):
    vehicle = bench.vehicle(deaf=("PARAM_SET",))
    bench.run(vehicle, 10.0)
    assert not vehicle.parameters
    bench.station.set("without", (True, False, False))
    bench.run(vehicle, 5.0)
    assert vehicle.parameters == {"SIM_GPS1_ENABLE": 0.0}
    bench.station.set("without", (False, True, False))
    bench.run(vehicle, 5.0)
    failed = dict.fromkeys(("SIM_MAG1_FAIL", "SIM_MAG2_FAIL", "SIM_MAG3_FAIL"), 1.0)
    assert vehicle.parameters == {"SIM_GPS1_ENABLE": 1.0, **failed}
    bench.station.set("without", (False, False, True))
    bench.run(vehicle, 5.0)
    assert vehicle.parameters["SIM_BATT_VOLTAGE"] == pytest.approx(9.6)
    assert not any(vehicle.parameters[name] for name in failed)
    asked = [m for m in vehicle.received if m.get_type() == "PARAM_SET"]
    bench.run(vehicle, 10.0)
    assert [m for m in vehicle.received if m.get_type() == "PARAM_SET"] == asked


def test_an_outage_of_the_vehicles_sensors_reaches_the_firmware(bench):
    vehicle = bench.vehicle()
    bench.station.set("position_valid", False)  # before anybody is there
    bench.station.set("position_valid", True)
    bench.run(vehicle, 10.0)
    assert not vehicle.parameters
    bench.station.set("position_valid", False)
    bench.run(vehicle, 5.0)
    assert vehicle.parameters == {"SIM_GPS1_ENABLE": 0.0}
    bench.station.set("position_valid", True)
    bench.station.set("heading_valid", False)
    bench.run(vehicle, 5.0)
    assert vehicle.parameters["SIM_GPS1_ENABLE"] == 1.0
    assert vehicle.parameters["SIM_MAG2_FAIL"] == 1.0


def test_a_station_that_is_silent_sends_nothing(bench):
    vehicle = bench.vehicle()
    bench.run(vehicle, 10.0)
    bench.station.set("silent", True)
    bench.run(vehicle, 0.2)
    before = len(vehicle.received)
    bench.run(vehicle, 10.0)
    assert len(vehicle.received) == before
    assert bench.station.get("armed")  # what comes is taken in


def test_a_vehicle_that_comes_again_gets_its_mission_again(bench):
    first = bench.vehicle()
    bench.run(first, 10.0)
    first.socket.close()
    again = bench.vehicle()
    bench.run(again, 10.0)
    assert sorted(again.items) == [0, 1, 2, 3]
    assert bench.station.get("under_way")


def test_other_senders_are_left_alone(bench):
    vehicle = bench.vehicle()
    vehicle.mav.srcComponent = 100  # a camera
    bench.run(vehicle, 5.0)
    assert not bench.station.get("connected")


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ("tcpin:127.0.0.1:0 tcpin:127.0.0.1:0", "at most one is needed"),
        ("tcp:5760", "kind of link"),
    ],
)
def test_a_link_that_cannot_be_is_refused(link, said):
    with pytest.raises(InputError, match=said):
        Bench(link=link)


def test_an_address_without_tcp_is_refused():
    bench = Bench(link="", address="udpin:127.0.0.1:14550")
    with pytest.raises(
        SimulationError, match=r"reached at 'udpin:127.0.0.1:14550', one link tcpin"
    ):
        bench.station.advance(0.0, 0.1)
    bench.close()
