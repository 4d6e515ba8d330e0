"""Set-up of a vehicle by the rules of the pages of QGroundControl."""

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import STATION, Bench


def listed(**kind):
    """Return a station's parameters after it requested the list."""
    bench = Bench(**kind)
    bench.transport.take()
    bench.receive(mavlink.MAVLink_param_request_list_message(7, 1))
    bench.wait(10.0)
    values = bench.transport.take("PARAM_VALUE", STATION.link)
    assert len(values) == values[0].param_count
    return {m.param_id: m.param_value for m in values}


@pytest.mark.parametrize("submerged", [False, True])
def test_sensors_and_radio_of_an_ardupilot_are_calibrated(submerged):
    found = listed(submerged=submerged)
    assert any(found[f"INS_ACCOFFS_{axis}"] for axis in "XYZ")
    for n in ("", "2", "3"):
        used = found[f"COMPASS_DEV_ID{n}"] and found[f"COMPASS_USE{n}"]
        assert not used or all(found[f"COMPASS_OFS{n}_{axis}"] for axis in "XYZ")
    channels = [int(found[f"RCMAP_{axis}"]) for axis in ("ROLL", "PITCH", "YAW", "THROTTLE")]
    assert all(channels)
    pulses = [[found[f"RC{n}_{what}"] for what in ("MIN", "TRIM", "MAX")] for n in channels]
    assert any(each != [1100, 1500, 1900] for each in pulses)
    assert found["BATT_MONITOR"]


@pytest.mark.parametrize(
    ("submerged", "names"),
    [
        (False, "FS_ACTION FS_THR_ENABLE FS_THR_VALUE FS_GCS_ENABLE FS_CRASH_CHECK FRAME_CLASS"),
        (
            True,
            "FS_GCS_ENABLE FS_LEAK_ENABLE LEAK1_PIN LEAK1_LOGIC FS_EKF_ACTION FS_EKF_THRESH "
            "FS_PILOT_INPUT FS_PILOT_TIMEOUT FS_PRESS_ENABLE FS_PRESS_MAX FS_TEMP_ENABLE "
            "FS_TEMP_MAX FRAME_CONFIG",
        ),
    ],
)
def test_pages_of_safety_find_their_parameters(submerged, names):
    assert set(names.split()) <= listed(submerged=submerged).keys()


@pytest.mark.parametrize("submerged", [False, True])
def test_a_px4_is_set_up(submerged):
    bench = Bench(autopilot="px4", submerged=submerged)
    table = bench.parameters
    assert table["SYS_AUTOSTART"] != 0
    assert table["COM_RC_IN_MODE"] == 1  # no radio
    assert all(table[f"CAL_{sensor}0_ID"] for sensor in ("ACC", "GYRO", "MAG"))


@pytest.mark.parametrize(
    ("value", "armed", "acts"),
    [(0, True, False), (1, True, True), (2, False, True), (3, True, True)],
)
def test_what_a_submarine_does_without_its_pilot(value, armed, acts):
    bench = Bench(submerged=True, failsafe="hold")
    assert bench.parameters.put("FS_PILOT_INPUT", value) is None
    bench.enter("manual")
    bench.arm()
    bench.receive(mavlink.MAVLink_manual_control_message(7, 0, 0, 500, 0, 0))
    bench.wait(4.0)
    assert (bench.vehicle.armed, bench.vehicle.failsafe) == (armed, acts)
    assert bench.vehicle.mode.name == ("hold" if value == 3 else "manual")
