"""pymavlink scripts at a running trial, over TCP: services that no ground station here asks for."""

from __future__ import annotations

import math
import socket
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from pymavlink import mavftp, mavparm, mavutil
from pymavlink.dialects.v20 import all as mavlink

from tests.kits.mavlink.ground import north_of

from .running import HOST, free_port, running, wait_for

WAIT_S = 60.0
OK, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
FAILED = mavlink.MAV_RESULT_FAILED
POSITION_ONLY, ATTITUDE_ONLY = 0xDF8, 0x07


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """Yield a connection to the vehicle of a running trial, which has a position by now."""
    port, folder = free_port(socket.SOCK_STREAM), tmp_path_factory.mktemp("script")
    links = f"tcpin:{HOST}:{port}"
    with running("hydrone-mission", folder, factor=4.0, autopilot__mavlink__links=links) as trial:
        wait_for(lambda: trial.is_running, "the trial's first step")
        connection = mavutil.mavlink_connection(f"tcp:{HOST}:{port}", dialect="all", retries=10)
        connection.wait_heartbeat(timeout=WAIT_S)
        receive(connection, "GPS_RAW_INT", lambda m: m.fix_type >= 3)
        yield connection
        connection.close()


def receive(boat: Any, kind: str, wanted: Callable[[Any], bool] = lambda m: True) -> Any:
    """Return the next message of a kind that is as wanted, or fail; say meanwhile that we are."""
    end = time.monotonic() + WAIT_S
    while time.monotonic() < end:
        boat.mav.heartbeat_send(6, 8, 0, 0, 4)
        message = boat.recv_match(type=kind, blocking=True, timeout=1.0)
        if message is not None and wanted(message):
            return message
    raise AssertionError(f"no {kind} as wanted")


def command(boat: Any, number: int, *parameters: float) -> int:
    boat.mav.command_long_send(1, 1, number, 0, *parameters, *[0.0] * (7 - len(parameters)))
    return int(receive(boat, "COMMAND_ACK", lambda m: m.command == number).result)


def reports(boat: Any, text: str) -> None:
    receive(boat, "STATUSTEXT", lambda m: text in m.text)


def is_at(boat: Any, north: float, east: float) -> None:
    receive(boat, "LOCAL_POSITION_NED", lambda m: math.hypot(m.x - north, m.y - east) < 3.0)


def test_parameters_by_pymavlinks_own_means(boat: Any) -> None:
    parameters = mavparm.MAVParmDict()
    assert parameters.mavset(boat, "WP_RADIUS", 2.5, retries=10)
    boat.param_fetch_one("WP_RADIUS")
    assert receive(boat, "PARAM_VALUE", lambda m: m.param_id == "WP_RADIUS").param_value == 2.5
    boat.mav.param_set_send(1, 1, b"WP_RADIUS", -1.0, 9)
    reports(boat, "WP_RADIUS stays 2.5")


def test_modes_are_those_that_pymavlink_knows(boat: Any) -> None:
    number, found, count = mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES, {}, 1
    boat.mav.command_long_send(1, 1, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, number, *[0] * 6)
    while len(found) < count:
        answer = receive(boat, "AVAILABLE_MODES")
        found[answer.mode_name], count = answer.custom_mode, answer.number_modes
    assert found.items() <= boat.mode_mapping().items()


def test_rates_are_reported_as_they_are_set(boat: Any) -> None:
    number = mavlink.MAVLINK_MSG_ID_VFR_HUD
    boat.mav.request_data_stream_send(1, 1, mavlink.MAV_DATA_STREAM_ALL, 2, 1)
    boat.mav.command_long_send(1, 1, mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, 0, number, *[0] * 6)
    answer = receive(boat, "MESSAGE_INTERVAL")
    assert (answer.message_id, answer.interval_us) == (number, 500_000)
    assert command(boat, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, 100_000) == OK
    times = [receive(boat, "VFR_HUD") and receive(boat, "ATTITUDE").time_boot_ms for _ in range(3)]
    assert times == sorted(times)


def test_folders_are_listed(boat: Any) -> None:
    client = mavftp.MAVFTP(boat, 1, 1)
    begun = boat.messages["SYSTEM_TIME"].time_boot_ms
    root = client.cmd_list(["/"])
    assert root.error_code == mavftp.FtpError.Success
    assert ("@PARAM", True) in [(entry.name, entry.is_dir) for entry in root.directory_listing]
    inside = client.cmd_list(["@PARAM"])
    assert [(e.name, e.is_dir) for e in inside.directory_listing] == [("param.pck", False)]
    assert client.cmd_list(["/nowhere"]).error_code == mavftp.FtpError.FileNotFound
    assert receive(boat, "SYSTEM_TIME").time_boot_ms >= begun


def test_origin_and_home(boat: Any) -> None:
    boat.mav.set_gps_global_origin_send(1, 0, 0, 0)
    origin = receive(boat, "GPS_GLOBAL_ORIGIN")
    assert (origin.latitude, origin.longitude) == (-317800000, -522600000)  # it stays
    assert command(boat, mavlink.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, -31.7801, -52.2601, 0.0) == OK
    home = receive(boat, "HOME_POSITION", lambda m: m.latitude != origin.latitude)
    assert (home.latitude, home.longitude) == pytest.approx((-317801000, -522601000), abs=20)
    assert command(boat, mavlink.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, -31.78, -52.26, 0.0) == OK


def test_what_there_is_not_is_refused(boat: Any) -> None:
    assert command(boat, mavlink.MAV_CMD_DO_SET_SERVO, 1, 1900) == FAILED
    reports(boat, "No servo is set")
    assert command(boat, mavlink.MAV_CMD_IMAGE_START_CAPTURE) == FAILED
    for number in (395, 397):  # COMPONENT_INFORMATION, COMPONENT_METADATA
        asked = command(boat, mavlink.MAV_CMD_REQUEST_MESSAGE, number)
        assert asked == FAILED


def test_guided_by_three_kinds_of_messages(boat: Any) -> None:
    assert command(boat, mavlink.MAV_CMD_RUN_PREARM_CHECKS) == OK
    reports(boat, "Ready to arm")
    boat.set_mode("GUIDED")
    receive(boat, "HEARTBEAT", lambda m: m.custom_mode == 15)
    assert command(boat, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == OK

    latitude, longitude = north_of(12.0)
    x, y = round(latitude * 1e7), round(longitude * 1e7)
    item = mavlink.MAVLink_mission_item_int_message(1, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, x, y, 0.0, 0)
    boat.mav.send(item)
    assert receive(boat, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    is_at(boat, 12.0, 0.0)

    east = round(north_of(12.0, 12.0)[1] * 1e7)

    def further(m: Any) -> bool:
        fields = (0.0,) * 9
        boat.mav.set_position_target_global_int_send(0, 1, 1, 6, POSITION_ONLY, x, east, *fields)
        return math.hypot(m.x - 12.0, m.y - 12.0) < 3.0

    receive(boat, "LOCAL_POSITION_NED", further)

    def southwards(m: Any) -> bool:
        boat.mav.set_attitude_target_send(
            0, 1, 1, ATTITUDE_ONLY, [0.0, 0.0, 0.0, 1.0], 0, 0, 0, 0.3
        )
        return abs(math.remainder(m.yaw - math.pi, math.tau)) < 0.1

    receive(boat, "ATTITUDE", southwards)
    reports(boat, "Set-points have stopped")
    assert command(boat, mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0) == OK
