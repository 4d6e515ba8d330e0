import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import OTHER_STATION, STATION, Bench

SET, GET = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAV_CMD_GET_MESSAGE_INTERVAL
ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE
OK, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
UNSUPPORTED, FAILED = mavlink.MAV_RESULT_UNSUPPORTED, mavlink.MAV_RESULT_FAILED


def count(bench, seconds, kind="ATTITUDE", link=STATION.link):
    bench.transport.take()
    bench.wait(seconds)
    return len(bench.transport.take(kind, link))


def interval_of(bench, number, result=OK):
    assert bench.command(GET, number) == result
    (reported,) = bench.transport.take("MESSAGE_INTERVAL", STATION.link)
    assert reported.message_id == number
    return reported.interval_us


def test_what_a_ground_station_needs_comes_unasked():
    bench = Bench()
    bench.measure(voltage=16.0)
    bench.wait(4.0)
    received = {m.get_type() for m in bench.transport.take(link=0)}
    assert received >= {
        "HEARTBEAT",
        "SYS_STATUS",
        "SYSTEM_TIME",
        "GLOBAL_POSITION_INT",
        "LOCAL_POSITION_NED",
        "ATTITUDE",
        "ATTITUDE_QUATERNION",
        "GPS_RAW_INT",
        "VFR_HUD",
        "RC_CHANNELS",
        "ALTITUDE",
        "SERVO_OUTPUT_RAW",
        "BATTERY_STATUS",
        "HOME_POSITION",
        "EXTENDED_SYS_STATE",
        "EKF_STATUS_REPORT",
        "SCALED_IMU",
        "HIGHRES_IMU",
        "CURRENT_MODE",
    }


@pytest.mark.parametrize("rate", [1, 3, 4, 10, 20, 50, 100])
def test_a_message_comes_at_the_rate_requested(rate):
    bench = Bench()
    assert bench.command(SET, ATTITUDE, round(1e6 / rate)) == OK
    assert count(bench, 10.0) == pytest.approx(10 * rate, abs=1)


def test_rates_belong_to_the_link_that_requested():
    bench = Bench()
    usual = count(bench, 5.0)
    assert bench.command(SET, ATTITUDE, 20_000, sender=OTHER_STATION) == OK
    assert count(bench, 5.0, link=STATION.link) == usual
    assert count(bench, 5.0, link=OTHER_STATION.link) == pytest.approx(250, abs=1)


def test_a_stream_is_stopped_and_restored():
    bench = Bench()
    usual = interval_of(bench, ATTITUDE)
    assert usual == 100_000
    assert bench.command(SET, ATTITUDE, -1) == OK
    assert interval_of(bench, ATTITUDE) == -1
    assert count(bench, 5.0) == 0
    assert bench.command(SET, ATTITUDE, 0) == OK
    assert interval_of(bench, ATTITUDE) == usual


def test_a_message_that_is_not_there_has_no_interval():
    bench = Bench()
    assert bench.command(SET, 300, 1e6) == DENIED
    assert interval_of(bench, 300, FAILED) == 0


@pytest.mark.parametrize(
    "parameters",
    [
        (ATTITUDE, -2),
        (ATTITUDE, 999),
        (ATTITUDE, 1e10),
        (ATTITUDE, float("nan")),
        (float("inf"), 1e5),
        (0, 1e5),
    ],
    ids=["negative", "below 1 ms", "no 32 bits", "no interval", "no message", "heartbeat"],
)
def test_intervals_that_cannot_be_are_denied(parameters):
    bench = Bench()
    assert bench.command(SET, *parameters) == DENIED
    assert count(bench, 5.0, "HEARTBEAT") == 5


def test_an_interval_below_the_period_is_one_per_instant():
    bench = Bench()
    assert bench.command(SET, ATTITUDE, 1000) == OK
    assert count(bench, 1.0) == 100
    assert bench.command(SET, ATTITUDE, 1e9) == OK
    assert interval_of(bench, ATTITUDE) == 60_000_000  # at most, as an ArduPilot has it


@pytest.mark.parametrize(
    ("group", "kind"),
    [
        (mavlink.MAV_DATA_STREAM_ALL, "VFR_HUD"),
        (mavlink.MAV_DATA_STREAM_EXTRA1, "ATTITUDE"),
        (mavlink.MAV_DATA_STREAM_POSITION, "GLOBAL_POSITION_INT"),
        (mavlink.MAV_DATA_STREAM_EXTENDED_STATUS, "GPS_RAW_INT"),
    ],
)
def test_groups_of_streams(group, kind):
    bench = Bench()
    bench.receive(mavlink.MAVLink_request_data_stream_message(7, 1, group, 25, 1))
    assert count(bench, 4.0, kind) == pytest.approx(100, abs=1)
    bench.receive(mavlink.MAVLink_request_data_stream_message(7, 1, group, 25, 0))
    assert count(bench, 4.0, kind) == 0


def test_a_group_leaves_the_others_alone():
    bench = Bench()
    usual = count(bench, 4.0, "VFR_HUD")
    group = mavlink.MAV_DATA_STREAM_EXTRA1
    bench.receive(mavlink.MAVLink_request_data_stream_message(7, 1, group, 25, 1))
    assert count(bench, 4.0, "VFR_HUD") == usual


def test_a_new_link_starts_with_the_usual_streams():
    bench = Bench()
    bench.command(SET, ATTITUDE, -1)
    bench.transport.there = [1]
    bench.tick()
    bench.transport.there = [0, 1]  # not the same peer any more: links are never used again
    assert count(bench, 5.0) == 50


def test_messages_on_request_go_to_the_requester():
    bench = Bench()
    assert bench.command(mavlink.MAV_CMD_REQUEST_MESSAGE, ATTITUDE, sender=OTHER_STATION) == OK
    assert len(bench.transport.take("ATTITUDE", OTHER_STATION.link)) == 1
    assert bench.transport.take("ATTITUDE", STATION.link) == []


@pytest.mark.parametrize(
    "number",
    [
        397,  # COMPONENT_METADATA
        395,  # COMPONENT_INFORMATION
        float("nan"),
        -5,
        1e30,
    ],
)
def test_messages_that_are_not_there_are_refused(number):
    assert Bench().command(mavlink.MAV_CMD_REQUEST_MESSAGE, number) == FAILED
    px4 = Bench(autopilot="px4")
    assert px4.command(mavlink.MAV_CMD_REQUEST_MESSAGE, number) == UNSUPPORTED


def test_a_message_with_nothing_to_say_is_denied():
    result, messages = Bench(valid=False).request(mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT)
    assert (result, messages) == (DENIED, [])
