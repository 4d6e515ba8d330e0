import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial_kits.mavlink.transport import Sender

from .bench import OTHER_STATION, STATION, Bench


@pytest.mark.slow
def test_before_the_first_ground_station_nothing_happens():
    bench = Bench()
    bench.arm()
    bench.wait(60.0)
    assert (bench.vehicle.armed, bench.vehicle.failsafe) == (True, False)


@pytest.mark.slow
def test_only_the_station_that_steers_an_ardupilot_is_missed():
    for autopilot, lost in [("ardupilotmega", True), ("px4", False)]:
        bench = Bench(station_timeout=5.0, autopilot=autopilot)
        bench.heartbeat(STATION)
        for _ in range(10):
            bench.wait(1.0)
            bench.heartbeat(OTHER_STATION)
        assert bench.vehicle.failsafe is lost
        bench.heartbeat(STATION)
        assert not bench.vehicle.failsafe


@pytest.mark.parametrize("armed", [False, True])
def test_losing_the_last_one_is_what_matters(armed):
    bench = Bench(station_timeout=5.0, pilot_system=OTHER_STATION.system)
    bench.enter("guided")
    if armed:
        bench.arm()
    bench.heartbeat(STATION)
    bench.heartbeat(OTHER_STATION)
    for _ in range(10):  # one of them stays
        bench.wait(1.0)
        bench.heartbeat(OTHER_STATION)
    assert bench.vehicle.stations == 1
    assert not bench.vehicle.failsafe
    bench.wait(5.0)
    assert not bench.vehicle.failsafe
    bench.tick()
    assert bench.vehicle.failsafe
    assert bench.vehicle.stations == 0
    assert bench.vehicle.mode.name == ("hold" if armed else "guided")
    assert bench.vehicle.armed is armed


@pytest.mark.parametrize("pace", [0.2, 1.0, 5.0, 10.0])
def test_a_station_that_beats_each_second_stays_at_any_pace(pace):
    bench = Bench(station_timeout=5.0)
    bench.pace = pace
    bench.enter("guided")
    bench.arm()
    for _ in range(4):
        bench.heartbeat()
        bench.wait(pace)  # a second of the station's
    assert (bench.vehicle.stations, bench.vehicle.mode.name) == (1, "guided")
    assert "lost" not in "".join(bench.texts())
    bench.wait(max(5.0, 3.0 * pace))  # the time-out, and three beats that it missed
    assert (bench.vehicle.stations, bench.vehicle.mode.name) == (0, "hold")


def test_a_station_in_simulated_time_is_lost_by_it_at_any_pace():
    bench = Bench(station_timeout=5.0)
    bench.pace = 1000.0
    bench.arm()
    for _ in range(4):
        bench.heartbeat()
        bench.wait(1.0)
    bench.wait(4.0)
    assert bench.vehicle.stations == 1
    bench.tick()
    assert (bench.vehicle.stations, bench.vehicle.failsafe) == (0, True)


def test_beats_that_come_doubled_are_no_faster_ones():
    bench = Bench(station_timeout=5.0)
    bench.pace = 10.0
    for _ in range(6):
        bench.heartbeat()
        bench.heartbeat()
        bench.wait(10.0)
        assert bench.vehicle.stations == 1


def test_it_acts_again_on_whoever_takes_over_without_a_heartbeat():
    bench = Bench(station_timeout=2.0)
    bench.arm()
    for _ in range(2):
        bench.enter("guided")
        bench.heartbeat()
        assert not bench.vehicle.failsafe
        bench.wait(3.0)
        assert bench.vehicle.mode.name == "hold"
        for _ in range(2):
            bench.enter("guided")  # not refused, as in ArduPilot
            bench.wait(2.0)
            assert bench.vehicle.mode.name == "guided"
            bench.wait(0.02)
            assert bench.vehicle.mode.name == "hold"


def test_it_acts_once_on_a_station_that_comes_back_in_time():
    bench = Bench(station_timeout=2.0)
    bench.arm()
    bench.heartbeat()
    bench.wait(3.0)
    bench.enter("guided")
    for _ in range(4):
        bench.wait(1.0)
        bench.heartbeat()
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("guided", False)


ARM, FORCE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 21196
FAILED, ACCEPTED = mavlink.MAV_RESULT_FAILED, mavlink.MAV_RESULT_ACCEPTED


def test_it_does_not_arm_in_failsafe():
    bench = Bench(station_timeout=2.0, failsafe="disarm")
    bench.heartbeat()
    bench.wait(3.0)
    sender = Sender(99, 1, 0)  # sends no heartbeat
    assert bench.command(ARM, 1, sender=sender) == FAILED
    assert "PreArm: all ground stations lost" in bench.texts()
    assert not bench.vehicle.armed
    bench.heartbeat()
    assert bench.command(ARM, 1, sender=sender) == ACCEPTED
    bench.wait(3.0)
    assert not bench.vehicle.armed


def test_armed_by_force_in_failsafe_it_acts_again_after_the_time_out():
    bench = Bench(station_timeout=2.0, failsafe="disarm")
    bench.heartbeat()
    bench.wait(3.0)
    assert bench.command(ARM, 1, FORCE) == ACCEPTED
    bench.wait(2.0)
    assert bench.vehicle.armed
    bench.wait(0.02)
    assert not bench.vehicle.armed


@pytest.mark.parametrize(
    "settings",
    [{"failsafe": "none"}, {"watches_stations": False}, {"arming_check": 0}],
    ids=lambda settings: next(iter(settings)),
)
def test_a_failsafe_that_is_off_prevents_no_arming(settings):
    bench = Bench(station_timeout=2.0, station_to_arm=True, **settings)
    bench.heartbeat()
    bench.wait(3.0)
    bench.arm()
    bench.wait(10.0)
    assert bench.vehicle.armed


def test_a_vehicle_that_needs_a_station_does_not_arm_before_the_first():
    bench = Bench(station_to_arm=True)
    assert bench.command(ARM, 1) == FAILED
    assert "PreArm: no ground station" in bench.texts()
    bench.heartbeat()
    assert bench.command(ARM, 1) == ACCEPTED


@pytest.mark.slow
def test_manual_control_that_was_lost_is_missed_again_in_the_next_manual_mode():
    bench = Bench(manual_timeout=3.0)
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 0, 1000, 0, 0))
    bench.wait(60.0)  # lost while nobody steers
    assert not bench.vehicle.failsafe
    bench.arm()
    bench.enter("manual")
    bench.wait(3.0)
    assert bench.vehicle.mode.name == "manual"
    bench.wait(0.02)
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("hold", True)
    bench.command(ARM, 0)
    assert bench.command(ARM, 1) == FAILED
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 0, 1000, 0, 0))
    bench.arm()


@pytest.mark.parametrize(
    ("action", "submerged", "mode", "armed"),
    [
        ("none", False, "guided", True),
        ("disarm", False, "guided", False),
        ("hold", False, "hold", True),
        ("loiter", False, "loiter", True),
        ("return", False, "return", True),
        ("surface", True, "surface", True),
    ],
)
def test_every_action(action, submerged, mode, armed):
    bench = Bench(failsafe=action, submerged=submerged)
    bench.enter("guided")
    bench.arm()
    bench.heartbeat()
    bench.wait(6.0)
    assert (bench.vehicle.mode.name, bench.vehicle.armed) == (mode, armed)
    sent = [m.text for m in bench.transport.take("STATUSTEXT")]
    assert any("all ground stations lost" in text for text in sent)


def test_a_mode_that_cannot_be_entered_becomes_disarmed():
    bench = Bench(failsafe="return")
    bench.arm()
    bench.measure(position_valid=False)
    bench.heartbeat()
    bench.wait(6.0)
    assert (bench.vehicle.mode.name, bench.vehicle.armed) == ("hold", False)
    sent = [m.text for m in bench.transport.take("STATUSTEXT")]
    assert "Failsafe: return impossible, no position" in sent


def test_it_is_sent_in_the_heartbeat_until_a_station_is_back():
    bench = Bench()
    bench.heartbeat()
    bench.wait(6.0)
    bench.transport.take()
    bench.wait(1.0)
    assert bench.transport.take("HEARTBEAT")[0].system_status == mavlink.MAV_STATE_CRITICAL
    bench.heartbeat()
    bench.tick()
    assert bench.transport.take("HEARTBEAT")[0].system_status == mavlink.MAV_STATE_STANDBY
    assert "Ground station is back" in [m.text for m in bench.transport.take("STATUSTEXT")]


def test_one_failsafe_lasts_while_another_ends():
    bench = Bench()
    bench.enter("manual")
    bench.arm()
    bench.heartbeat()
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 0, 1000, 0, 0))
    bench.wait(6.0)  # neither is there any more
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 0, 1000, 0, 0))
    assert bench.vehicle.failsafe
    bench.heartbeat()
    assert not bench.vehicle.failsafe


def test_other_components_are_no_ground_stations():
    bench = Bench()
    bench.heartbeat(kind=mavlink.MAV_TYPE_ONBOARD_CONTROLLER)
    bench.tick()
    assert bench.vehicle.stations == 0


def test_the_number_of_ground_stations_is_bounded():
    bench = Bench()
    for system in range(1, 250):
        bench.heartbeat(Sender(system, 5, 0))
    bench.tick()
    assert bench.vehicle.stations == 32


@pytest.mark.parametrize(("action", "submerged"), [("surface", False), ("return", True)])
def test_an_action_that_the_vehicle_cannot_carry_out_is_refused(action, submerged):
    with pytest.raises(InputError, match=f"unknown failsafe of this vehicle '{action}'.*disarm"):
        Bench(failsafe=action, submerged=submerged)
