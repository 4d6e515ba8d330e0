"""Parameters: what they accept, what they move, and the files that keep them."""

from __future__ import annotations

import math
import random
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavparm
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.links.servos import read_servos
from seatrial_kits.mavlink.parameters.ardupilot import ardupilot_parameters
from seatrial_kits.mavlink.parameters.definition import (
    INT8,
    REAL32,
    Definition,
    fixed,
    shortest,
)
from seatrial_kits.mavlink.parameters.file import ParameterFile
from seatrial_kits.mavlink.parameters.parameters import px4_parameters
from seatrial_kits.mavlink.parameters.table import ParameterTable
from seatrial_kits.mavlink.parameters.tunable import tunable_parameters, with_tunables
from seatrial_kits.mavlink.settings import COMPASS_CHECK, GPS_CHECK, Settings
from seatrial_kits.mavlink.vehicle import Identity

BOAT = Identity(7, 1, mavlink.MAV_TYPE_SURFACE_BOAT, False, "4.5.1", 1, 0)
SUBMARINE = Identity(7, 1, mavlink.MAV_TYPE_SUBMARINE, True, "4.5.1", 1, 0)


def boat(settings: Settings | None = None, **options) -> ParameterTable:
    settings = settings or Settings()
    definitions = ardupilot_parameters(BOAT, settings, {})
    return ParameterTable(definitions, settings, **options)


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_the_shortest_number_is_that_of_numpy(value: float) -> None:
    assert shortest(value) == float(str(np.float32(value)))
    assert struct.pack("<f", shortest(value)) == struct.pack("<f", value)


def test_what_ground_stations_look_for_is_there() -> None:
    table = boat()
    names = "SYSID_THISMAV FRAME_CLASS CRUISE_SPEED WP_SPEED WP_RADIUS ARMING_CHECK FS_ACTION"
    names += " FS_TIMEOUT FS_GCS_ENABLE FS_THR_ENABLE BATT_MONITOR MODE_CH MODE1 MODE6 RCMAP_ROLL"
    names += " RCMAP_THROTTLE RC1_MIN RC8_TRIM SERVO1_FUNCTION SERVO8_MAX COMPASS_USE COMPASS_OFS_X"
    for name in names.split():
        assert name in table
    assert len(set(table.names)) == len(table.names)
    assert [table.index(name) for name in table.names] == list(range(len(table.names)))
    assert (table["SYSID_THISMAV"], table["FRAME_CLASS"]) == (7.0, 2.0)


def test_channels_of_a_catamaran() -> None:
    servos = read_servos("1 port 1100 1500 1900; 3 starboard 1000 1510 2000 reversed")
    settings = Settings()
    table = ParameterTable(ardupilot_parameters(BOAT, settings, servos), settings)
    found = [table[f"SERVO3_{what}"] for what in ("FUNCTION", "MIN", "TRIM", "MAX", "REVERSED")]
    assert found == [74.0, 1000.0, 1510.0, 2000.0, 1.0]  # ThrottleRight
    assert [table[f"SERVO{n}_FUNCTION"] for n in range(1, 9)] == [73, 0, 74, 0, 0, 0, 0, 0]


def test_a_submarine_of_three_motors_is_a_simple_rov() -> None:
    names = ("starboard", "port", "vertical")
    servos = read_servos("; ".join(f"{n} {name} 1100 1500 1900" for n, name in enumerate(names, 1)))
    settings = Settings(waypoint_radius=2.5)
    definitions = ardupilot_parameters(SUBMARINE, settings, servos)
    table = ParameterTable(definitions, settings)
    assert table["FRAME_CONFIG"] == 4.0
    assert [table[f"SERVO{n}_FUNCTION"] for n in (1, 2, 3, 4)] == [33, 34, 35, 0]
    assert table["WPNAV_RADIUS"] == 250.0
    assert table.put("WPNAV_RADIUS", 120.0) is None
    assert settings.waypoint_radius == pytest.approx(1.2, rel=1e-15)


@pytest.mark.parametrize(
    ("name", "value", "setting", "moved"),
    [
        ("CRUISE_SPEED", 1.5, "cruise_speed", 1.5),
        ("WP_SPEED", 0.75, "waypoint_speed", 0.75),
        ("WP_RADIUS", struct.unpack("<f", struct.pack("<f", 2.3))[0], "waypoint_radius", 2.3),
        ("FS_ACTION", 1.0, "failsafe", "return"),
        ("FS_ACTION", 0.0, "failsafe", "none"),
        ("FS_ACTION", 5.0, "failsafe", "disarm"),
        ("FS_TIMEOUT", 1.5, "manual_timeout", 1.5),
        ("FS_GCS_TIMEOUT", 8.0, "station_timeout", 8.0),
        ("FS_GCS_ENABLE", 0.0, "watches_stations", False),
        ("FS_THR_ENABLE", 0.0, "watches_manual_control", False),
        ("GUID_TIMEOUT", 4.0, "target_timeout", 4.0),
        ("ARMING_CHECK", 4.2, "arming_check", 4),
    ],
)
def test_a_parameter_moves_its_setting(name, value, setting, moved) -> None:
    settings = Settings()
    assert boat(settings).put(name, value) is None
    assert getattr(settings, setting) == moved


def test_parameters_start_with_the_settings_and_leave_them() -> None:
    settings = Settings(failsafe="loiter", station_timeout=0.3, waypoint_radius=0.7)
    before = Settings(**vars(settings))
    table = boat(settings)
    assert (table["FS_ACTION"], table["FS_GCS_TIMEOUT"], table["WP_RADIUS"]) == (6.0, 0.3, 0.7)
    assert settings == before


def test_arming_checks_are_a_mask() -> None:
    assert Settings().checks(GPS_CHECK)
    only = Settings(arming_check=COMPASS_CHECK)
    assert (only.checks(GPS_CHECK), only.checks(COMPASS_CHECK), only.checks()) == (
        False,
        True,
        True,
    )
    none = Settings(arming_check=0)
    assert [none.checks(GPS_CHECK), none.checks(COMPASS_CHECK), none.checks()] == [False] * 3


@pytest.mark.parametrize(
    ("name", "value", "error", "reason"),
    [
        ("WP_RADIUS", -0.1, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "0 to 10000"),
        ("WP_RADIUS", math.nan, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "0 to 10000"),
        ("WP_RADIUS", math.inf, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "0 to 10000"),
        ("FS_ACTION", 7.0, mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE, "one of 0, 1, 2, 3, 4, 5"),
        ("SYSID_THISMAV", 9.0, mavlink.MAV_PARAM_ERROR_READ_ONLY, "belongs to the trial"),
    ],
)
def test_what_is_refused_leaves_everything_as_it_was(name, value, error, reason) -> None:
    settings = Settings()
    table = boat(settings)
    before = table[name]
    refusal = table.put(name, value)
    assert refusal is not None
    assert (refusal.error, reason in refusal.reason) == (error, True)
    assert (table[name], settings) == (before, Settings())


def test_px4_takes_whole_seconds_and_says_so() -> None:
    with pytest.raises(
        InputError, match=r"COM_DL_LOSS_T starts with 2\.5, a whole number, 0 to 2\.1"
    ):
        px4_parameters(BOAT, Settings(station_timeout=2.5))
    settings = Settings()
    table = ParameterTable(px4_parameters(BOAT, settings), settings)
    assert table.put("COM_ARM_WO_GPS", 1.0) is None
    assert (settings.checks(GPS_CHECK), settings.checks(COMPASS_CHECK)) == (False, True)
    assert table.put("NAV_DLL_ACT", 2.0) is None
    assert settings.failsafe == "return"


def test_a_failsafe_without_a_number_is_named() -> None:
    with pytest.raises(InputError, match="unknown failsafe of this vehicle 'surface'"):
        ardupilot_parameters(BOAT, Settings(failsafe="surface"), {})


def test_names_and_defaults_are_checked() -> None:
    for name in ("", "lower", "A" * 17, "1A", "A-B"):
        with pytest.raises(InputError, match="capital letters"):
            Definition(name, REAL32, 0.0)
    with pytest.raises(InputError, match="whole number"):
        Definition("A", INT8, 0.5, 0, 1)
    with pytest.raises(InputError, match="A is defined twice"):
        ParameterTable([fixed("A", INT8, 1), fixed("A", INT8, 2)], Settings())


@pytest.mark.parametrize(
    "text",
    ["0 port 1100 1500 1900", "33 port 1100 1500 1900", "x port 1100 1500 1900", "1 port 1100 1500",
     "1 port 1100 1500 1500", "1 port 1100 nan 1900", "1 port 1100 1500 1900 backwards", "1"],
)  # fmt: skip
def test_mistakes_in_actuators_are_named(text: str) -> None:
    with pytest.raises(InputError, match=f"actuator '{text}': a channel from 1 to 32, a name"):
        read_servos(f"2 port 1100 1500 1900; {text}")


# ------------------------------------------------------------------ tunables


def test_tunables_have_names_starts_and_limits() -> None:
    one, other = tunable_parameters("STEER_P 9 0 50; STEER_D 12.5 -1e2 100 ;")
    assert (one.name, one.default, one.low, one.high) == ("STEER_P", 9.0, 0.0, 50.0)
    assert (other.name, other.default, other.low) == ("STEER_D", 12.5, -100.0)
    assert tunable_parameters("  ") == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("STEER_P 9 0", "'STEER_P 9 0': a name, a start value, a low and a high limit"),
        ("STEER_P 9 0 x", "STEER_P: 'x' is no number"),
        ("STEER_P nan 0 1", "STEER_P: 'nan' is no number"),
        ("STEER_P 9 50 0", "low limit 50 is above its high limit 0"),
        ("STEER_P 90 0 50", "STEER_P starts with 90, 0 to 50 is allowed"),
        ("steer 9 0 50", "capital letters"),
        ("; ".join(f"T{n} 0 0 1" for n in range(65)), "65 tunables, at most 64"),
    ],
)
def test_mistakes_in_tunables_are_named(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        tunable_parameters(text)


def test_a_tunable_may_be_one_of_the_vehicles_own() -> None:
    settings = Settings(cruise_speed=1.0)
    definitions = ardupilot_parameters(BOAT, settings, {})
    tunables = tunable_parameters("CRUISE_SPEED 0.8 0 2; STEER_P 9 0 50")
    table = ParameterTable(with_tunables(definitions, tunables, settings), settings)
    assert len(table.names) == len(definitions) + 1
    assert (table["CRUISE_SPEED"], settings.cruise_speed) == (0.8, 0.8)
    assert table.put("CRUISE_SPEED", 2.5) is not None
    assert table.put("CRUISE_SPEED", 1.75) is None
    assert settings.cruise_speed == 1.75
    for name in ("SYSID_THISMAV", "FS_ACTION"):
        with pytest.raises(InputError, match=f"{name} is a parameter of the vehicle already"):
            with_tunables(definitions, tunable_parameters(f"{name} 1 0 2"), settings)


# ------------------------------------------------------------------ files


def test_a_file_keeps_what_was_set_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "boat.param"
    table = boat(file=ParameterFile(path))
    assert not path.exists()
    table.put("WP_RADIUS", struct.unpack("<f", struct.pack("<f", 2.3))[0])
    table.put("FS_ACTION", 1.0)
    table.put("WP_SPEED", -1.0)
    assert path.read_text() == "WP_RADIUS        2.3\nFS_ACTION        1\n"
    settings = Settings()
    again = boat(settings, file=ParameterFile(path))
    assert (again["WP_RADIUS"], settings.waypoint_radius, settings.failsafe) == (2.3, 2.3, "return")
    assert [each.name for each in tmp_path.iterdir()] == ["boat.param"]


def test_files_go_to_and_fro_between_us_and_pymavlink(tmp_path: Path) -> None:
    """pymavlink writes six decimals."""
    theirs, ours = tmp_path / "theirs.param", tmp_path / "ours.param"
    written = mavparm.MAVParmDict()
    written["WP_RADIUS"], written["FS_ACTION"] = 4.25, 2
    written.save(str(theirs))
    settings = Settings()
    boat(settings, file=ParameterFile(theirs))
    assert (settings.waypoint_radius, settings.failsafe) == (4.25, "hold")
    table = boat(file=ParameterFile(ours))
    rng = random.Random(1)
    for name in ("CRUISE_SPEED", "WP_RADIUS", "GUID_TIMEOUT"):
        assert table.put(name, rng.uniform(0.0, 100.0)) is None
    read = mavparm.MAVParmDict()
    assert read.load(str(ours))
    assert dict(read) == {name: table[name] for name in read}
    assert len(read) == 3


def test_a_file_may_have_commas_and_comments(tmp_path: Path) -> None:
    path = tmp_path / "x.param"
    path.write_text("# boat\n\nWP_RADIUS,4 # wide\n\tCRUISE_SPEED\t1.5e0\n")
    table = boat(file=ParameterFile(path))
    assert (table["WP_RADIUS"], table["CRUISE_SPEED"]) == (4.0, 1.5)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "WP_RADIUS 3\nWP_RADIOUS 3\n",
            r"x\.param, line 2: this vehicle has no parameter WP_RADIOUS",
        ),
        ("WP_RADIUS\n", r"line 1: a name and a value are needed, found 'WP_RADIUS'"),
        ("# a\nWP_RADIUS 3 4\n", r"line 2: a name and a value are needed"),
        ("WP_RADIUS three\n", r"line 1: WP_RADIUS: 'three' is no number"),
        ("WP_RADIUS inf\n", r"line 1: WP_RADIUS: 'inf' is no number"),
        ("WP_RADIUS -3\n", r"line 1: WP_RADIUS is -3, 0 to 10000 is allowed"),
        ("WP_RADIUS 3\nWP_RADIUS 3\n", r"line 2: WP_RADIUS is there twice"),
        ("SYSID_THISMAV 7\n", r"line 1: SYSID_THISMAV cannot be set"),
    ],
)
def test_bad_lines_are_refused_with_file_and_line(tmp_path: Path, text, message) -> None:
    path = tmp_path / "x.param"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        boat(file=ParameterFile(path))
    assert path.read_text() == text


def test_a_file_that_cannot_be_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no folder"):
        ParameterFile(tmp_path / "nowhere" / "x.param")
    with pytest.raises(InputError, match="Is a directory"):
        boat(file=ParameterFile(tmp_path))
    (tmp_path / "x.param").write_bytes(b"WP\xff")
    with pytest.raises(InputError, match="not UTF-8"):
        boat(file=ParameterFile(tmp_path / "x.param"))


def test_what_cannot_be_kept_is_not_set(tmp_path: Path) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    settings = Settings()
    table = boat(settings, file=ParameterFile(folder / "x.param"))
    folder.rmdir()
    refusal = table.put("WP_RADIUS", 5.0)
    assert refusal is not None
    assert "cannot be written: No such file" in refusal.reason
    assert (table["WP_RADIUS"], settings.waypoint_radius) == (3.0, 3.0)


KINDS = {
    "rover": (BOAT, ardupilot_parameters),
    "sub": (SUBMARINE, ardupilot_parameters),
    "px4": (BOAT, lambda identity, settings, _: px4_parameters(identity, settings)),
}
EXTREMES = (0.0, -0.0, 5e-324, 1e-30, 1e30, -1e30, 3.4e38, -3.4e38, math.inf, -math.inf, math.nan)
MOST = {"cruise_speed": 100.0, "waypoint_speed": 100.0, "waypoint_radius": 1e4, "fence_depth": 12e3}


@pytest.mark.parametrize("kind", KINDS)
@given(value=st.one_of(st.sampled_from(EXTREMES), st.floats(width=32)))
def test_no_parameter_takes_what_no_vehicle_means(kind: str, value: float) -> None:
    identity, made = KINDS[kind]
    settings = Settings()
    definitions = made(identity, settings, {})
    table = ParameterTable(definitions, settings)
    for one in definitions:
        before = table[one.name]
        refusal = table.put(one.name, value)
        assert math.isfinite(table[one.name])
        assert refusal is None or table[one.name] == before
        if not one.fixed and one.kind == REAL32:
            assert one.high <= 1e6, one.name
    for setting, most in MOST.items():
        assert 0.0 <= getattr(settings, setting) <= most
