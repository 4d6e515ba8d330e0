"""Failure injection, by pymavlink's own list of units and types."""

import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.model.faults.catalogue import FAILURES as FAULTS
from seatrial.model.faults.catalogue import KINDS
from seatrial.model.faults.text import read_text
from seatrial_kits.mavlink.services.failures import UNITS, failing_units

from .bench import Bench
from .test_component import connect, received, started, until  # noqa: F401  fixtures

INJECT = mavlink.MAV_CMD_INJECT_FAILURE
ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
UNSUPPORTED = mavlink.MAV_RESULT_UNSUPPORTED
GPS, MAG = mavlink.FAILURE_UNIT_SENSOR_GPS, mavlink.FAILURE_UNIT_SENSOR_MAG
MOTOR, SERVO = mavlink.FAILURE_UNIT_SYSTEM_MOTOR, mavlink.FAILURE_UNIT_SYSTEM_SERVO
OK, OFF, STUCK = range(3)


def entries(enum):
    """Return the names of an enumeration of MAVLink's, by number, as they are written here."""
    named = {n: e.name for n, e in mavlink.enums[enum].items() if not e.name.endswith("ENUM_END")}
    prefix = f"{enum}_"
    return {n: name.removeprefix(prefix).lower() for n, name in named.items()}


def bench(failures="gps mag motor1 motor2", **more):
    return Bench(failures=failing_units(failures), **more)


def test_failures_of_devices_are_those_of_mavlink():
    ok, *failures = entries("FAILURE_TYPE").values()
    assert (ok, tuple(failures)) == ("ok", FAULTS)


def test_units_are_named_as_mavlink_names_them():
    names = [name.split("_", 1)[1] for name in entries("FAILURE_UNIT").values()]
    assert {name.rstrip("12345678") for name in UNITS} <= set(names)


@pytest.mark.parametrize("unit", entries("FAILURE_UNIT"))
@pytest.mark.parametrize("kind", entries("FAILURE_TYPE"))
def test_only_what_is_connected_fails(unit, kind):
    boat = bench()
    connected = {GPS: ["gps"], MAG: ["mag"], MOTOR: ["motor1", "motor2"]}.get(unit)
    assert boat.command(INJECT, unit, kind, 0) == (ACCEPTED if connected else UNSUPPORTED)
    failure = ["none", *FAULTS][kind]
    for name, found in boat.node.failures.failing.items():
        assert found == (failure if name in (connected or []) else "none")


def test_an_instance_fails_alone_and_nought_or_none_means_all():
    boat = bench("motor1 motor2 motor4")
    failing = boat.node.failures.failing
    assert boat.command(INJECT, MOTOR, OFF, 2) == ACCEPTED
    assert failing == {"motor1": "none", "motor2": "off", "motor4": "none"}
    assert boat.command(INJECT, MOTOR, STUCK, math.nan) == ACCEPTED
    assert set(failing.values()) == {"stuck"}
    assert boat.command(INJECT, MOTOR, OK, 4) == ACCEPTED
    assert failing == {"motor1": "stuck", "motor2": "stuck", "motor4": "none"}
    for absent in (3, 9, -1, 1e6):
        assert boat.command(INJECT, MOTOR, OFF, absent) == UNSUPPORTED
    assert boat.command(INJECT, SERVO, OFF, 1) == UNSUPPORTED


def test_the_only_one_of_its_kind_is_number_one():
    boat = bench()
    assert boat.command(INJECT, GPS, OFF, 2) == UNSUPPORTED
    assert boat.command(INJECT, GPS, OFF, 1) == ACCEPTED


def test_status_texts_report_what_fails_and_what_is_cleared():
    boat = bench()
    boat.texts()
    boat.command(INJECT, MOTOR, STUCK)
    assert boat.texts() == ["Failure: motor1, motor2 stuck"]
    boat.command(INJECT, MOTOR, STUCK)
    assert boat.texts() == []
    boat.command(INJECT, MOTOR, OK, 1)
    assert boat.texts() == ["Cleared: motor1"]
    boat.command(INJECT, mavlink.FAILURE_UNIT_SENSOR_VIO, OFF)
    assert "".join(boat.texts()) == "No failure injected: this vehicle has no such unit to fail"


@pytest.mark.parametrize("parameters", [(GPS, 8), (GPS, -1), (GPS, math.nan), (GPS, 1e30)])
def test_a_type_that_there_is_not_is_denied(parameters):
    boat = bench()
    assert boat.command(INJECT, *parameters) == DENIED
    assert set(boat.node.failures.failing.values()) == {"none"}


@pytest.mark.parametrize("unit", [math.nan, math.inf, -1, 99, 1e30])
def test_a_unit_that_there_is_not_is_unsupported(unit):
    assert bench().command(INJECT, unit, OFF) == UNSUPPORTED


def test_a_vehicle_without_connections_for_failures_has_none():
    assert bench("").command(INJECT, GPS, OFF) == UNSUPPORTED


def test_px4s_switch_turns_them_off_and_on():
    boat = bench(autopilot="px4")
    parameters = next(s.table for s in boat.node.services if hasattr(s, "table"))
    assert parameters["SYS_FAILURE_EN"] == 1.0
    assert parameters.put("SYS_FAILURE_EN", 0.0) is None
    assert boat.command(INJECT, GPS, OFF) == DENIED
    assert "No failure injected: SYS_FAILURE_EN is 0" in boat.texts()
    assert parameters.put("SYS_FAILURE_EN", 1.0) is None
    assert boat.command(INJECT, GPS, OFF) == ACCEPTED


def test_units_that_there_are_not_are_refused(started):  # noqa: F811
    assert failing_units(" gps  motor8 ") == ["gps", "motor8"]
    with pytest.raises(InputError, match="unknown unit of failures 'gsp'; did you mean 'gps'"):
        failing_units("gyro gsp")
    with pytest.raises(InputError, match="unknown unit of failures 'motor9'"):
        started(failures="motor9")


def test_they_come_out_at_ports_and_back_in_telemetry(started, connect):  # noqa: F811
    boat = started(failures="gps gyro")
    station = connect(boat.urls[0])
    assert set(boat.get("failure")) == {"none"}
    for kind, name in ((OFF, "off"), (OK, "none")):
        station.mav.command_long_send(1, 1, INJECT, 0, GPS, kind, 1, 0, 0, 0, 0)
        until(boat, lambda name=name: boat.get("failure.gps") == name)
        # As the receiver does it.
        boat.set("position_valid", name == "none")
        fix = mavlink.GPS_FIX_TYPE_3D_FIX if name == "none" else mavlink.GPS_FIX_TYPE_NO_FIX
        received(boat, station, "GPS_RAW_INT", lambda m, fix=fix: m.fix_type == fix)
    boat.set("imu_valid", False)
    boat.set("gyro_valid", False)
    bits = mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO | mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    status = received(
        boat, station, "SYS_STATUS", lambda m: not m.onboard_control_sensors_health & bits
    )
    assert status.onboard_control_sensors_present & bits == bits


SIM = [
    ({"SIM_GPS1_ENABLE": 0}, "gps", "off"),
    ({"SIM_GPS1_JAM": 1}, "gps", "intermittent"),
    ({"SIM_MAG1_FAIL": 1}, "mag", "off"),
    ({"SIM_BARO_DISABLE": 1}, "baro", "off"),
    ({"SIM_BARO_FREEZE": 1}, "baro", "stuck"),
    ({"SIM_BARO_GLITCH": 2}, "baro", "bias of=depth value=-2.0 at=0.0"),
    ({"SIM_GYR1_BIAS_Z": 0.1}, "gyro", "bias of=gyro value=0.0,0.0,0.1 at=0.0"),
    ({"SIM_ENGINE_FAIL": 2}, "motor2", "off"),
]


@pytest.mark.parametrize(("parameters", "unit", "text"), SIM)
def test_simulation_parameters_are_faults_of_the_catalogue(parameters, unit, text):
    boat = bench("gps mag baro gyro motor1 motor2")
    for name, value in parameters.items():
        assert boat.parameters.put(name, value) is None
    found = dict(boat.node.failures.texts(0.0))
    assert found.pop(unit) == text
    assert set(found.values()) == {"none"}
    assert read_text(text).what in KINDS


def test_a_glitch_in_degrees_moves_the_position_by_their_length():
    """A degree of latitude is 111.3 km on this sphere, one of longitude half of that at 60 N."""
    boat = bench("gps")
    for axis, value in zip("XYZ", (0.001, -0.001, 3.0), strict=True):
        boat.parameters.put(f"SIM_GPS1_GLTCH_{axis}", value)
    fault = read_text(boat.node.failures.texts(math.radians(60.0))["gps"])
    assert (fault.what, fault.of) == ("bias", "position_n")
    assert fault.settings["value"] == pytest.approx([111.32, -55.66, -3.0], rel=1e-4)


def test_a_command_goes_before_a_parameter_and_only_units_that_fail_have_one():
    boat = bench("gps motor1")
    boat.parameters.put("SIM_GPS1_ENABLE", 0)
    boat.command(INJECT, GPS, STUCK)
    assert boat.node.failures.texts(0.0)["gps"] == "stuck"
    boat.command(INJECT, GPS, OK)
    assert boat.node.failures.texts(0.0)["gps"] == "off"
    names = set(boat.parameters.names)
    assert {"SIM_GPS1_ENABLE", "SIM_ENGINE_FAIL", "SIM_ENGINE_MUL"} <= names
    assert not {"SIM_MAG1_FAIL", "SIM_BARO_FREEZE"} & names
    assert not any(n.startswith("SIM_GPS1") for n in bench("gps", autopilot="px4").parameters.names)
