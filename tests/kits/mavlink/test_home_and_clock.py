import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import ORIGIN, OTHER_STATION, STATION, Bench

SET, GET = mavlink.MAV_CMD_DO_SET_HOME, mavlink.MAV_CMD_GET_HOME_POSITION
HOME = mavlink.MAVLINK_MSG_ID_HOME_POSITION
OK, DENIED, FAILED = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_DENIED,
    mavlink.MAV_RESULT_FAILED,
)
NAN = float("nan")


def place(home):
    return home.latitude, home.longitude, home.altitude


def test_home_is_the_origin_at_first():
    bench = Bench()
    home = bench.one(HOME)
    assert place(home) == (-317800000, -522600000, 2000)
    assert (home.x, home.y, home.z) == (0.0, 0.0, 0.0)
    assert bench.command(GET) == OK
    (reported,) = bench.transport.take("HOME_POSITION", STATION.link)
    assert place(reported) == place(home)


def test_home_where_it_is_now_is_sent_to_all():
    bench = Bench()
    bench.measure(position_n=(30.0, 40.0, 1.0))
    bench.tick()
    bench.transport.take()
    assert bench.command(SET, 1) == OK
    assert bench.vehicle.home_n == (30.0, 40.0, 1.0)
    assert len(bench.transport.take("HOME_POSITION", None)) == 1
    bench.measure(position_valid=False)
    assert bench.command(SET, 1) == FAILED


@pytest.mark.parametrize("way", ["long", "int", "message"])
def test_home_at_a_place(way):
    bench = Bench()
    wanted = (300.0, -400.0, -8.0)
    latitude, longitude, altitude = ORIGIN.geodetic(wanted)
    x, y = round(latitude * 1e7), round(longitude * 1e7)
    if way == "long":
        assert bench.command(SET, 0, 0, 0, 0, latitude, longitude, altitude) == OK
    elif way == "int":
        assert bench.command_int(SET, 0, frame=0, x=x, y=y, z=altitude) == OK
    else:
        bench.receive(
            mavlink.MAVLink_set_home_position_message(
                7, x, y, round(altitude * 1e3), 0, 0, 0, [1, 0, 0, 0], 0, 0, 0
            )
        )
    assert bench.vehicle.home_n == pytest.approx(wanted, abs=0.01)
    assert place(bench.one(HOME)) == (x, y, round(altitude * 1e3))


@pytest.mark.parametrize(
    "parameters",
    [
        (0, 0, 0, 0, NAN, NAN, 0),
        (0, 0, 0, 0, -31.78, -52.26, NAN),
        (0, 0, 0, 0, 91, 0, 0),
        (0, 0, 0, 0, 31, 52, 0),
    ],
)
def test_home_nowhere_fails(parameters):
    bench = Bench()
    assert bench.command(SET, *parameters) == FAILED
    assert bench.vehicle.home_n == (0.0, 0.0, 0.0)


def test_the_origin_is_sent_and_stays():
    bench = Bench()
    number = mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN
    origin = bench.one(number)
    assert place(origin) == (-317800000, -522600000, 2000)
    bench.receive(mavlink.MAVLink_set_gps_global_origin_message(7, 10, 20, 30), OTHER_STATION)
    (answer,) = bench.transport.take("GPS_GLOBAL_ORIGIN", OTHER_STATION.link)
    assert place(answer) == place(origin)


def test_altitude_above_home_moves_with_home():
    bench = Bench()
    bench.measure(position_n=(0.0, 0.0, 3.0))
    bench.vehicle.home_n = (0.0, 0.0, 1.0)
    position = bench.one(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
    assert (position.alt, position.relative_alt) == (-1000, -2000)


def test_time_is_synchronised_to_simulated_time():
    bench = Bench()
    bench.wait(1.23)
    bench.receive(mavlink.MAVLink_timesync_message(0, 123_456_789), OTHER_STATION)
    (answer,) = bench.transport.take("TIMESYNC", OTHER_STATION.link)
    assert (answer.tc1, answer.ts1) == (1_230_000_000, 123_456_789)
    bench.receive(mavlink.MAVLink_timesync_message(5, 6))  # another station's answer
    assert bench.transport.take("TIMESYNC") == []


def test_pings_are_answered_to_the_sender():
    bench = Bench()
    bench.wait(0.5)
    bench.receive(mavlink.MAVLink_ping_message(99, 42, 0, 0), OTHER_STATION)
    (answer,) = bench.transport.take("PING", OTHER_STATION.link)
    assert (answer.seq, answer.time_usec) == (42, 500_000)
    assert (answer.target_system, answer.target_component) == (250, 190)
    bench.receive(mavlink.MAVLink_ping_message(99, 42, 7, 1))  # an answer to us
    assert bench.transport.take("PING") == []


def test_unix_time_is_that_of_the_vehicles_day():
    bench = Bench()
    bench.wait(2.5)
    time = bench.one(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME)
    assert (time.time_unix_usec, time.time_boot_ms) == (10**15 + 2_500_000, 2500)


def test_time_since_boot_wraps_as_its_field_does():
    bench = Bench()
    bench.ticks = round(2**32 / 1000 * 100) + 100
    assert bench.one(mavlink.MAVLINK_MSG_ID_SYSTEM_TIME).time_boot_ms == pytest.approx(1000, abs=10)
    assert math.isfinite(bench.one(mavlink.MAVLINK_MSG_ID_ATTITUDE).roll)
