"""Telemetry logs read: whose channels, whose clock, and what is left out."""

import struct

import numpy as np
import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.trial.logs.formats import format_of, read_log
from seatrial.trial.logs.quantities import defaults
from seatrial_kits.mavlink.tlog import TelemetryLog

UNIX_US = 1_714_564_770_000_000
BOAT = mavlink.MAVLink(None, 1, 1)


@pytest.fixture
def read(tmp_path):
    """Return a function that reads the log of entries (time in s, message, sender)."""

    def read(*entries, end=b""):
        path = tmp_path / "boat.tlog"
        stamped = (struct.pack(">Q", UNIX_US + round(1e6 * t)) + m.pack(by) for t, m, by in entries)
        path.write_bytes(b"".join(stamped) + end)
        return read_log(path)

    return read


def heartbeat(autopilot=3):
    return mavlink.MAVLink_heartbeat_message(11, autopilot, 0, 0, 4, 3)


def attitude(ms, yaw):
    return mavlink.MAVLink_attitude_message(ms, 0.1, -0.2, yaw, 0, 0, 0)


def gps(fix, lat=634000000):
    return mavlink.MAVLink_gps_raw_int_message(0, fix, lat, 104000000, 0, 0, 0, 150, 9000, 8)


def test_times_are_the_vehicles_on_the_recorders_clock(read):
    delays = (0.30, 0.05, 0.90)
    found = read(*((k + d, attitude(4000 + 1000 * k, 0.1 * k), BOAT) for k, d in enumerate(delays)))
    yaw = found.channels["ATTITUDE.yaw"]
    np.testing.assert_allclose(np.diff(yaw.time), [1.0, 1.0])
    assert yaw.time[1] == pytest.approx(1.05 - 0.30)  # the shortest delay; 0 is the first stamp
    assert yaw.unit == "rad"
    assert found.start.isoformat() == "2024-05-01T11:59:30.300000+00:00"


def test_after_a_restart_times_are_those_of_reception(read):
    found = read(
        (0.0, attitude(60_000, 0), BOAT),
        (1.0, attitude(500, 0), BOAT),
        (2.0, attitude(1500, 0), BOAT),
    )
    assert found.channels["ATTITUDE.yaw"].time.tolist() == [0.0, 1.0, 2.0]
    assert found.notes[0].startswith("1 restarts of 1.1: its times are those at which")


def test_the_autopilot_keeps_the_plain_names(read):
    camera, second = mavlink.MAVLink(None, 1, 100), mavlink.MAVLink(None, 2, 1)
    found = read((0.0, attitude(0, 9.0), camera), (0.0, heartbeat(8), camera), (0.1, heartbeat(), second),
                 (0.2, attitude(0, 2.0), second), (0.3, heartbeat(), BOAT), (0.4, attitude(0, 1.0), BOAT))  # fmt: skip
    yaws = {name: each.values[0] for name, each in found.channels.items() if name.endswith("yaw")}
    assert yaws == {"1.100/ATTITUDE.yaw": 9.0, "2.1/ATTITUDE.yaw": 2.0, "ATTITUDE.yaw": 1.0}


def test_units_and_what_is_unknown(read):
    place = mavlink.MAVLink_global_position_int_message(
        10, 634000001, -104000000, 0, -2500, 0, 0, 0, 65535
    )
    status = mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 12000, 550, 50, 0, 0, 0, 0, 0, 0)
    imu = mavlink.MAVLink_raw_imu_message(0, 1000, 0, -1000, 0, 0, 0, 0, 0, 0)
    found = read((0.0, place, BOAT), (0.1, status, BOAT), (0.2, imu, BOAT), (0.3, gps(3), BOAT))
    values = {name: (each.values[0], each.unit) for name, each in found.channels.items()}
    assert values["GLOBAL_POSITION_INT.lat"] == (pytest.approx(63.4000001, abs=1e-12), "deg")
    assert values["GLOBAL_POSITION_INT.relative_alt"] == (-2500, "mm")
    assert np.isnan(values["GLOBAL_POSITION_INT.hdg"][0])
    assert values["SYS_STATUS.power"] == (pytest.approx(66.0), "W")
    assert values["RAW_IMU.xacc"] == (pytest.approx(9.80665), "m/s2")
    served = {what: column.name for what, column in defaults(found).items()}
    assert served["depth"] == "-GLOBAL_POSITION_INT.relative_alt"


@pytest.mark.parametrize(("reverse", "expected"), [(0, [1.0, -1.0, 0.5]), (1, [-1.0, 1.0, -0.5])])
def test_the_helm_is_that_of_the_parameters(read, reverse, expected):
    names = {
        "SERVO3_FUNCTION": 26,
        "SERVO3_MIN": 1000,
        "SERVO3_TRIM": 1400,
        "SERVO3_MAX": 2000,
        "SERVO3_REVERSED": reverse,
    }
    entries = [
        (0.0, mavlink.MAVLink_param_value_message(n.encode(), v, 9, 5, 0), BOAT)
        for n, v in names.items()
    ]
    for k, pulse in enumerate((2000, 1000, 1700, 0)):
        entries.append(
            (k, mavlink.MAVLink_servo_output_raw_message(0, 0, 1500, 1500, pulse, *[0] * 5), BOAT)
        )
    helm = read(*entries).channels["servo.ground_steering"].values
    np.testing.assert_allclose(helm[:3], expected)
    assert np.isnan(helm[3])


def test_what_is_broken_is_skipped_and_counted(read):
    good = (0.0, attitude(0, 1.0), BOAT)
    whole = struct.pack(">Q", UNIX_US) + attitude(1000, 2.0).pack(BOAT)
    found = read(good, (0.5, gps(1), BOAT), end=b"some noise" + whole + whole[:-20])
    assert found.channels["ATTITUDE.yaw"].values.tolist() == [1.0, 2.0]
    assert found.notes == (
        "1 places without a readable frame are skipped",
        "1 record at the end is cut",
        "1 messages GPS_RAW_INT without a fix are left out",
    )


def test_our_own_logs_are_read(tmp_path):
    log = TelemetryLog(UNIX_US)
    log.open(tmp_path / "boat.tlog")
    for k in range(3):
        log.now = 0.1 * k
        log.write(attitude(100 * k, 0.5 * k).pack(BOAT))
    log.close()
    assert format_of(tmp_path / "boat.tlog") == "tlog"
    assert read_log(tmp_path / "boat.tlog").channels["ATTITUDE.yaw"].values.tolist() == [
        0.0,
        0.5,
        1.0,
    ]


def test_no_tlog(tmp_path):
    (tmp_path / "boat.tlog").write_bytes(bytes(100))
    with pytest.raises(InputError, match="no frame of MAVLink"):
        read_log(tmp_path / "boat.tlog", "tlog")
