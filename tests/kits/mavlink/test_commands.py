"""Commands, arming and modes."""

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.transport import Sender

from .bench import STATION, Bench

ARM, MODE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE
OK, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
UNSUPPORTED, FAILED = mavlink.MAV_RESULT_UNSUPPORTED, mavlink.MAV_RESULT_FAILED
NAN = float("nan")
UNKNOWN_COMMAND = 7  # of FTP's errors


# ------------------------------------------------------------------ dispatch


@pytest.mark.parametrize("number", [0, 16, 999, 65535])
def test_an_unknown_command_is_answered(number):
    bench = Bench()
    assert bench.command(number) == UNSUPPORTED
    assert bench.command_int(number, frame=0, x=0, y=0, z=0) == UNSUPPORTED


@pytest.mark.parametrize(
    ("system", "component", "answered"),
    [(7, 1, True), (7, 0, True), (0, 0, True), (8, 1, False), (8, 0, False), (7, 2, True)],
)
def test_only_what_is_meant_for_us_is_answered(system, component, answered):
    bench = Bench()
    result = bench.command(ARM, 1, system=system, component=component)
    assert (result == OK) is answered
    assert bench.vehicle.armed is answered


def test_components_that_are_there_answer_for_themselves():
    bench = Bench()
    bench.heartbeat(Sender(7, 2, 0), mavlink.MAV_TYPE_CAMERA)
    assert bench.command(ARM, 1, system=7, component=2) is None
    assert bench.command(ARM, 1, system=7, component=3) == OK  # as an ArduPilot
    assert Bench(autopilot="px4").command(ARM, 1, system=7, component=3) is None


def test_the_answer_goes_over_the_link_of_the_command():
    bench = Bench()
    bench.receive(mavlink.MAVLink_command_long_message(7, 1, 999, 0, *[0] * 7), Sender(255, 1, 1))
    ((link, _),) = bench.transport.sent
    assert link == 1


def test_what_seems_to_come_from_ourselves_is_not_received():
    bench = Bench()
    assert bench.command(ARM, 1, sender=Sender(7, 1, 0)) is None
    assert not bench.vehicle.armed


# ------------------------------------------------------------------ arming


def test_arming_and_disarming():
    bench = Bench()
    for _ in range(2):
        assert bench.command(ARM, 1) == OK
        assert bench.vehicle.armed
    assert bench.texts() == ["Armed"]
    for _ in range(2):
        assert bench.command(ARM, 0) == OK
        assert not bench.vehicle.armed
    assert bench.texts() == ["Disarmed"]


@pytest.mark.parametrize(
    ("missing", "reason"),
    [({"position_valid": False}, "no position"), ({"heading_valid": False}, "no heading")],
)
def test_a_boat_that_lacks_something_says_what(missing, reason):
    bench = Bench()
    bench.measure(**missing)
    assert bench.command(ARM, 1) == FAILED
    assert not bench.vehicle.armed
    assert bench.texts() == [f"PreArm: {reason}"]


def test_a_submarine_arms_without_a_position():
    bench = Bench(submerged=True)
    bench.measure(position_valid=False)
    assert bench.command(ARM, 1) == OK


def test_force_arms_against_all_reasons_and_says_so():
    bench = Bench(valid=False)
    assert bench.command(ARM, 1, 21196) == OK
    assert bench.vehicle.armed
    assert bench.texts() == ["Armed by force, against: no position, no heading"]


@pytest.mark.parametrize("wanted", [2, -1, 0.5, NAN])
def test_neither_arming_nor_disarming_is_denied(wanted):
    bench = Bench()
    bench.arm()
    assert bench.command(ARM, wanted) == UNSUPPORTED
    assert bench.vehicle.armed


def test_a_reason_that_comes_later_does_not_disarm():
    bench = Bench()
    bench.arm()
    bench.measure(position_valid=False)
    bench.wait(1.0)
    assert bench.vehicle.armed
    assert bench.command(ARM, 1) == OK  # it is armed already


def test_checks_on_request():
    bench = Bench(valid=False)
    assert bench.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS) == OK
    assert bench.texts() == ["PreArm: no position", "PreArm: no heading"]
    bench.measure(position_valid=True, heading_valid=True)
    assert bench.command(mavlink.MAV_CMD_RUN_PREARM_CHECKS) == OK
    assert bench.texts() == ["Ready to arm"]
    assert not bench.vehicle.armed


def test_the_health_bit_follows_the_checks():
    bench = Bench(valid=False)
    bit = mavlink.MAV_SYS_STATUS_PREARM_CHECK
    for valid in (False, True, False):
        bench.measure(position_valid=valid, heading_valid=valid)
        bench.tick()
        status = bench.one(mavlink.MAVLINK_MSG_ID_SYS_STATUS)
        assert status.onboard_control_sensors_present & bit
        assert bool(status.onboard_control_sensors_health & bit) is valid


@pytest.mark.parametrize(
    ("number", "why"),
    [
        (mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, "simulated"),
        (mavlink.MAV_CMD_PREFLIGHT_CALIBRATION, "belong to the trial"),
        (mavlink.MAV_CMD_DO_SET_RELAY, "no relays"),
        (mavlink.MAV_CMD_DO_REPEAT_RELAY, "no relays"),
    ],
)
def test_what_it_cannot_do_is_refused_with_the_reason(number, why):
    bench = Bench()
    assert bench.command(number, 1, 1500) == DENIED
    bench.tick()
    assert why in "".join(m.text for m in bench.transport.take("STATUSTEXT"))


@pytest.mark.parametrize(
    ("number", "result"),
    [
        (mavlink.MAV_CMD_DO_SET_SERVO, FAILED),
        (mavlink.MAV_CMD_DO_GRIPPER, FAILED),
        (mavlink.MAV_CMD_PREFLIGHT_STORAGE, DENIED),
    ],
)
def test_equipment_that_is_not_there_fails_as_with_an_ardupilot(number, result):
    bench = Bench()
    assert bench.command(number, 1, 1500) == result
    bench.tick()
    assert bench.transport.take("STATUSTEXT")


def test_no_key_is_taken_over_a_link():
    bench = Bench()
    bench.receive(mavlink.MAVLink_setup_signing_message(7, 1, [1] * 32, 1))
    bench.tick()
    assert "signing_key_file" in "".join(m.text for m in bench.transport.take("STATUSTEXT"))


@pytest.mark.parametrize("number", [395, 397])  # COMPONENT_INFORMATION, COMPONENT_METADATA
def test_descriptions_of_components_are_refused_at_once(number):
    assert Bench().command(mavlink.MAV_CMD_REQUEST_MESSAGE, number) == FAILED
    px4 = Bench(autopilot="px4")
    assert px4.command(mavlink.MAV_CMD_REQUEST_MESSAGE, number) == UNSUPPORTED


# ------------------------------------------------------------------ modes


@pytest.mark.parametrize(
    ("options", "parameters", "name"),
    [
        ({}, (1, 0), "manual"),
        ({}, (1, 15), "guided"),  # as MAVProxy requests it
        ({}, (129, 11, 0), "return"),  # as MAVSDK requests it
        ({"submerged": True}, (1, 19), "manual"),
        ({"submerged": True}, (1, 2), "depth-hold"),
        ({"submerged": True}, (1, 0), "stabilize"),
        ({"autopilot": "px4"}, (129, 1, 0), "manual"),
        ({"autopilot": "px4"}, (129, 6, NAN), "guided"),
        ({"autopilot": "px4"}, (129, 4, 5, NAN, NAN, NAN, NAN), "return"),
    ],
)
def test_modes_by_command(options, parameters, name):
    bench = Bench(**options)
    assert bench.command(MODE, *parameters) == OK
    assert bench.vehicle.mode.name == name


@pytest.mark.parametrize("parameters", [(1, 99), (0, 15), (NAN, 15), (1, NAN), (1, -1), (-1, 15)])
def test_what_is_no_mode_is_refused(parameters):
    assert Bench(autopilot="px4").command(MODE, *parameters) == DENIED
    bench = Bench()
    assert bench.command(MODE, *parameters) == (FAILED if parameters[0] == 1 else DENIED)
    assert bench.vehicle.mode.name == "hold"


def test_modes_by_message():
    bench = Bench()
    bench.receive(mavlink.MAVLink_set_mode_message(7, 1, 0))
    assert bench.vehicle.mode.name == "manual"
    bench.receive(mavlink.MAVLink_set_mode_message(7, 0, 15))  # no custom mode
    bench.receive(mavlink.MAVLink_set_mode_message(8, 1, 15))  # not us
    bench.receive(mavlink.MAVLink_set_mode_message(7, 1, 99))
    assert bench.vehicle.mode.name == "manual"
    assert bench.texts() == ["Mode MANUAL", "There is no mode 99"]


@pytest.mark.parametrize("number", [5, 11, 15])
def test_modes_that_need_a_position_are_refused_without(number):
    bench = Bench(valid=False)
    assert bench.command(MODE, 1, number) == FAILED
    assert bench.vehicle.mode.name == "hold"
    (sent,) = bench.texts()
    assert sent.endswith("refused: no position")
    assert bench.command(MODE, 1, 0) == OK  # manual needs none


def test_return_to_launch():
    assert Bench().command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == OK
    submarine = Bench(submerged=True)
    assert submarine.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == UNSUPPORTED


@pytest.mark.parametrize("submerged", [False, True])
def test_all_modes_are_listed(submerged):
    bench = Bench(submerged=submerged)
    result, listed = bench.request(mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES)
    assert result == OK
    modes = bench.vehicle.dialect.modes
    assert [m.mode_index for m in listed] == list(range(1, len(modes) + 1))
    assert {m.number_modes for m in listed} == {len(modes)}
    assert [m.mode_name for m in listed] == [mode.shown for mode in modes]
    for each in listed:  # and each can be entered by its number
        if each.mode_name in ("AUTO", "Mission"):
            continue  # there is no mission yet
        assert bench.command(MODE, 1, each.custom_mode) == OK
        assert bench.one(mavlink.MAVLINK_MSG_ID_CURRENT_MODE).custom_mode == each.custom_mode


def test_leaving_a_mode_forgets_its_set_point():
    bench = Bench()
    bench.enter("guided")
    sender = STATION
    bench.receive(
        mavlink.MAVLink_set_position_target_local_ned_message(
            0, 7, 1, 1, 0xDF8, 5, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0
        ),
        sender,
    )
    assert bench.vehicle.target is not None
    bench.enter("hold")
    assert bench.vehicle.target is None
