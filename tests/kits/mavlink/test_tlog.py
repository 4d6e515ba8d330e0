"""Telemetry logs, read by pymavlink."""

from __future__ import annotations

from pathlib import Path

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import SimulationError
from seatrial_kits.mavlink.tlog import TelemetryLog

MIDNIGHT_US = 1_770_249_600_000_000  # 2026-02-05


def test_pymavlink_reads_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "boat.tlog"
    log = TelemetryLog(MIDNIGHT_US)
    log.write(b"before it is open")
    log.open(path)
    vehicle, station = mavlink.MAVLink(None, 7, 1), mavlink.MAVLink(None, 255, 190)
    for k in range(1000):
        log.now = k / 100
        attitude = mavlink.MAVLink_attitude_message(10 * k, k / 1e3, 0.0, 0.0, 0.0, 0.0, 0.0)
        log.write(attitude.pack(vehicle))
        vehicle.seq = (vehicle.seq + 1) % 256
        if k % 100 == 0:
            log.write(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(station))
    log.close()
    reader = mavutil.mavlink_connection(str(path), dialect="all")
    got = []
    while (message := reader.recv_match()) is not None:
        got.append(message)
    reader.close()
    attitudes = [m for m in got if m.get_type() == "ATTITUDE"]
    assert [m.time_boot_ms for m in attitudes] == [10 * k for k in range(1000)]
    assert [m._timestamp for m in attitudes] == [
        pytest.approx(MIDNIGHT_US / 1e6 + k / 100, abs=1e-6) for k in range(1000)
    ]
    beats = [m for m in got if m.get_type() == "HEARTBEAT"]
    assert [m.get_srcSystem() for m in beats] == [255] * 10
    assert len(got) == 1010


def test_a_frame_is_on_disk_at_once_with_its_time_highest_byte_first(tmp_path: Path) -> None:
    path = tmp_path / "boat.tlog"
    log = TelemetryLog(0x0102030405060700)
    log.open(path)
    log.now = 8e-6
    log.write(b"frame")
    assert path.read_bytes() == b"\x01\x02\x03\x04\x05\x06\x07\x08frame"
    log.close()


def test_an_older_log_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "boat.tlog").write_bytes(b"old")
    with pytest.raises(SimulationError, match=r"boat\.tlog: File exists"):
        TelemetryLog(0).open(tmp_path / "boat.tlog")
    assert (tmp_path / "boat.tlog").read_bytes() == b"old"
