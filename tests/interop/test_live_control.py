"""Live control of a shipped trial, as its user has it: speed-up, pause, failures."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from .running import HOST, RunningTrial, free_port, running, wait_for

ROOT = Path(__file__).parents[2]
WAIT_S = 60.0
SPEEDUP = "SIM_SPEEDUP"
GPS_BIT, MAG_BIT = mavlink.MAV_SYS_STATUS_SENSOR_GPS, mavlink.MAV_SYS_STATUS_SENSOR_3D_MAG


class Station:
    """A ground station of pymavlink's, that sends its heartbeat each second while it listens."""

    def __init__(self) -> None:
        self.link = mavutil.mavlink_connection(f"udpin:{HOST}:0", source_system=255)
        self.port = self.link.port.getsockname()[1]
        self._beat_at = 0.0

    def listen(self) -> Any:
        """Return the next message, None if there is none for a while."""
        if time.monotonic() - self._beat_at >= 1.0 and self.link.target_system:
            self.link.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4)
            self._beat_at = time.monotonic()
        return self.link.recv_match(blocking=True, timeout=0.1)

    def receive(self, kind: str, accept: Callable[[Any], bool] = lambda m: True) -> Any:
        """Return the next message of a kind that is accepted."""
        end = time.monotonic() + WAIT_S
        while time.monotonic() < end:
            message = self.listen()
            if message is not None and message.get_type() == kind and accept(message):
                return message
        raise TimeoutError(f"no such {kind} within {WAIT_S:g} s")

    def during(self, seconds: float) -> list[Any]:
        """Return all that is received from now on, for so long."""
        while self.link.recv_match() is not None:
            pass
        end, received = time.monotonic() + seconds, []
        while time.monotonic() < end:
            received.append(self.listen())
        return [message for message in received if message is not None]

    def speed_up(self, factor: float) -> None:
        self.link.mav.param_set_send(1, 1, SPEEDUP.encode(), factor, mavlink.MAV_PARAM_TYPE_REAL32)
        self.receive("PARAM_VALUE", lambda m: m.param_id == SPEEDUP and m.param_value == factor)

    def pace(self, seconds: float) -> float:
        """Return simulated seconds per second of wall time."""
        clock = [
            (m.time_boot_ms, m._timestamp)
            for m in self.during(seconds)
            if m.get_type() == "ATTITUDE"
        ]
        (first, begun), (last, ended) = clock[0], clock[-1]
        return (last - first) / 1e3 / (ended - begun)

    def comes_to(self, pace: float, least: float = 0.7) -> None:
        """Wait for that share of a pace; it is never faster. A busy machine is not at once."""
        end, found = time.monotonic() + WAIT_S, 0.0
        while found < least * pace:
            assert time.monotonic() < end, found
            found = self.pace(2.0)
            assert found < 1.3 * pace

    def inject(self, unit: int, failure: int) -> int:
        number = mavlink.MAV_CMD_INJECT_FAILURE
        self.link.mav.command_long_send(1, 1, number, 0, unit, failure, 0, 0, 0, 0, 0)
        return self.receive("COMMAND_ACK", lambda m: m.command == number).result


@pytest.fixture
def station() -> Iterator[Station]:
    station = Station()
    yield station
    station.link.close()


def controlled(trial: RunningTrial, station: Station) -> None:
    """Do all that live control offers, one after the other."""
    wait_for(lambda: trial.is_running, "the trial runs")
    station.receive("HEARTBEAT")
    station.receive("GPS_RAW_INT", lambda m: m.fix_type == mavlink.GPS_FIX_TYPE_RTK_FIXED)
    station.comes_to(1.0)
    station.speed_up(4.0)
    # A busy machine may not keep up with it, but it is faster than before.
    station.comes_to(4.0, least=1.5 / 4.0)
    station.speed_up(0.0)
    still = station.during(3.5)
    assert sum(m.get_type() == "HEARTBEAT" for m in still) >= 2
    assert not any(m.get_type() == "ATTITUDE" for m in still)
    station.link.mav.timesync_send(0, 99)
    stands_at = station.receive("TIMESYNC", lambda m: m.ts1 == 99).tc1
    station.link.mav.timesync_send(0, 100)
    assert station.receive("TIMESYNC", lambda m: m.ts1 == 100).tc1 == stands_at
    station.speed_up(1.0)
    # It goes on from there, and does not catch up.
    assert station.receive("ATTITUDE").time_boot_ms <= stands_at / 1e6 + 2000
    station.comes_to(1.0)
    gps, mag = mavlink.FAILURE_UNIT_SENSOR_GPS, mavlink.FAILURE_UNIT_SENSOR_MAG
    for failure, health, fix in (
        (mavlink.FAILURE_TYPE_OFF, 0, mavlink.GPS_FIX_TYPE_NO_FIX),
        (mavlink.FAILURE_TYPE_OK, GPS_BIT, mavlink.GPS_FIX_TYPE_RTK_FIXED),
    ):
        assert station.inject(gps, failure) == mavlink.MAV_RESULT_ACCEPTED
        station.receive("GPS_RAW_INT", lambda m, fix=fix: m.fix_type == fix)
        station.receive(
            "SYS_STATUS",
            lambda m, health=health: m.onboard_control_sensors_health & GPS_BIT == health,
        )
    assert station.inject(mag, mavlink.FAILURE_TYPE_OFF) == mavlink.MAV_RESULT_ACCEPTED
    station.receive("SYS_STATUS", lambda m: not m.onboard_control_sensors_health & MAG_BIT)
    assert station.inject(103, mavlink.FAILURE_TYPE_OFF) == mavlink.MAV_RESULT_UNSUPPORTED


@pytest.mark.parametrize("engine", ["direct", pytest.param("fmu", marks=pytest.mark.long)])
def test_a_station_changes_the_pace_pauses_and_breaks_things(
    engine: str, station: Station, tmp_path: Path
) -> None:
    links = f"udpout:{HOST}:{station.port}"
    with running(
        "hydrone-mission", tmp_path, factor=None, engine=engine, autopilot__mavlink__links=links
    ) as trial:
        controlled(trial, station)
        # A signal ends a pause, and the run.
        station.speed_up(0.0)
        run = trial.stop()
    assert trial.process.returncode == 3
    assert run.manifest["status"] == "stopped"
    assert run.timing["pacing"]["paused_s"] >= 3.5
    assert run.timing["pacing"]["overruns"]["longest_s"] < 3.5
    assert "off" in run.signals["autopilot.mavlink.failure.gps"]


@pytest.mark.long  # tests/kits/mavlink/test_pause.py has it in simulated wall time
def test_a_pause_that_nobody_can_end_is_over(station: Station, tmp_path: Path) -> None:
    links = f"udpout:{HOST}:{station.port}"
    sets = {"autopilot__mavlink__links": links, "autopilot__mavlink__station_timeout": "2 s"}
    with running("hydrone-mission", tmp_path, factor=None, stop="10 s", **sets) as trial:
        wait_for(lambda: trial.is_running, "the trial runs")
        station.receive("HEARTBEAT")
        station.speed_up(0.0)
        assert trial.process.wait(WAIT_S * 2) in (0, 1)
        run = trial.signals()
    assert run.manifest["status"] == "complete"
    assert run.timing["pacing"]["paused_s"] >= 2.0


@pytest.mark.parametrize("dialect", ["ardupilotmega", "px4"])
def test_mavsdk_injects_failures(dialect: str, tmp_path: Path) -> None:
    port = free_port()
    sets = {
        "autopilot__mavlink__links": f"udpout:{HOST}:{port}",
        "autopilot__mavlink__autopilot_type": dialect,
    }
    with running("hydrone-mission", tmp_path, factor=None, **sets) as trial:
        wait_for(lambda: trial.is_running, "the trial runs")
        done = subprocess.run(
            [sys.executable, "-m", "tests.interop.mavsdk_failures", f"udpin://{HOST}:{port}", dialect],
            cwd=ROOT, capture_output=True, text=True, timeout=4 * WAIT_S,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
