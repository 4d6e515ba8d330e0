import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from seatrial_kits.mavlink.modes import dialect

from .bench import STATION, Bench


@pytest.mark.parametrize(
    ("submerged", "numbers"),
    [(False, mavutil.mode_mapping_rover), (True, mavutil.mode_mapping_sub)],
)
def test_ardupilot_numbers_are_those_of_ground_stations(submerged, numbers):
    modes = dialect("ardupilotmega", submerged=submerged).modes
    assert {mode.custom_mode: mode.shown for mode in modes}.items() <= numbers.items()


# Names that ground stations know PX4's modes by.
PX4_NAMES = {
    "manual": "MANUAL",
    "hold": "LOITER",
    "auto": "MISSION",
    "return": "RTL",
    "guided": "OFFBOARD",
    "depth-hold": "ALTCTL",
    "stabilize": "STABILIZED",
    "surface": "LAND",
}


@pytest.mark.parametrize("submerged", [False, True])
def test_px4_numbers_are_those_of_ground_stations(submerged):
    for mode in dialect("px4", submerged=submerged).modes:
        flags = 0x51 if mode.name == "manual" else 0x1D
        assert mavutil.interpret_px4_mode(flags, mode.custom_mode) == PX4_NAMES[mode.name]


@pytest.mark.parametrize("autopilot", ["ardupilotmega", "px4"])
@pytest.mark.parametrize("submerged", [False, True])
def test_numbers_and_names_are_unique_and_found(autopilot, submerged):
    kind = dialect(autopilot, submerged=submerged)
    for mode in kind.modes:
        assert kind.mode(mode.name) is mode
        assert kind.by_custom_mode(mode.custom_mode) is mode


@pytest.mark.parametrize("autopilot", ["ardupilotmega", "px4"])
def test_modes_are_reported_one_by_one_or_all_at_once(autopilot):
    bench = Bench(autopilot=autopilot, submerged=True)
    number, modes = mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES, bench.vehicle.dialect.modes

    def reported(index):
        bench.transport.take()
        result = bench.command(mavlink.MAV_CMD_REQUEST_MESSAGE, number, index)
        found = bench.transport.take("AVAILABLE_MODES", STATION.link)
        assert all(m.number_modes == len(modes) for m in found)
        return result, [(m.mode_index, m.custom_mode, m.mode_name) for m in found]

    each = [(n, mode.custom_mode, mode.shown) for n, mode in enumerate(modes, 1)]
    assert reported(0) == (mavlink.MAV_RESULT_ACCEPTED, each)
    assert reported(NAN) == (mavlink.MAV_RESULT_ACCEPTED, each)
    for index, mode in enumerate(each, 1):
        assert reported(index) == (mavlink.MAV_RESULT_ACCEPTED, [mode])
    for index in (-1, len(modes) + 1, 255):
        assert reported(index) == (mavlink.MAV_RESULT_DENIED, [])


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize("sub", [0.0, NAN])
def test_ardupilot_reads_one_number(sub):
    assert dialect("ardupilotmega", submerged=False).by_command(15.0, sub).name == "guided"
    assert dialect("ardupilotmega", submerged=True).by_command(19.0, sub).name == "manual"


@pytest.mark.parametrize(
    ("main", "sub", "name"),
    [
        (1.0, NAN, "manual"),
        (4.0, 3.0, "hold"),
        (4.0, 4.0, "auto"),
        (4.0, 5.0, "return"),
        (6.0, 0.0, "guided"),
    ],
)
def test_px4_reads_main_and_sub_mode(main, sub, name):
    assert dialect("px4", submerged=False).by_command(main, sub).name == name


@pytest.mark.parametrize("autopilot", ["ardupilotmega", "px4"])
@pytest.mark.parametrize("main", [NAN, INF, -INF, -1.0, 99.0, 1e30, 2.0**32])
def test_what_is_no_mode_is_none(autopilot, main):
    assert dialect(autopilot, submerged=False).by_command(main, 0.0) is None


def test_modes_of_an_ardupilot_are_no_standard_ones():
    # Stations would set a standard mode by a command that ArduPilots do not know.
    for submerged in (False, True):
        bench = Bench(submerged=submerged)
        _, modes = bench.request(mavlink.MAVLINK_MSG_ID_AVAILABLE_MODES)
        assert {m.standard_mode for m in modes} == {mavlink.MAV_STANDARD_MODE_NON_STANDARD}


def test_standard_modes_of_a_px4_are_set():
    bench = Bench(autopilot="px4", valid=True)
    set_standard = mavlink.MAV_CMD_DO_SET_STANDARD_MODE
    standard = mavlink.MAV_STANDARD_MODE_SAFE_RECOVERY
    assert bench.command(set_standard, standard) == mavlink.MAV_RESULT_ACCEPTED
    assert bench.vehicle.mode.name == "return"
    for unknown in (0, 200, float("nan")):
        assert bench.command(set_standard, unknown) == mavlink.MAV_RESULT_DENIED
    assert bench.vehicle.mode.name == "return"


def test_the_list_of_modes_is_said_to_stay():
    bench = Bench()
    bench.wait(11.0)
    assert {m.seq for m in bench.transport.take("AVAILABLE_MODES_MONITOR", 0)} == {0}
