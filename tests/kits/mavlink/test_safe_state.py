"""Ground stations, pymavlink's own, of a vehicle whose process is killed: the last they receive."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as mavlink

from tests.command import SEATRIAL

from ...cli.test_stop import child_of

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are not copied there")

PHRASE = "correct horse"
FORCED = 21196.0
RIG = """
step = "10 ms"
[components]
boat = {{ fmu = "mavlink", isolated = {isolated}, set = {{ links = "udpin:127.0.0.1:0 tcpin:127.0.0.1:0" {signing} }} }}
"""
SIGNING = ', signing_key_file = "key.txt", state_file = "state.json"'


@pytest.fixture
def run(write, tmp_path: Path) -> Iterator[Any]:
    """Return a function that starts a vehicle; it returns the process and the vehicle's URLs."""
    processes = []

    def start(signed: bool, isolated: bool) -> tuple[subprocess.Popen[str], list[str]]:
        signing = SIGNING if signed else ""
        write("key.txt", f"{PHRASE}\n")
        write("rig.toml", RIG.format(isolated=str(isolated).lower(), signing=signing))
        write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
        command = [
            SEATRIAL,
            "run",
            "trial.toml",
            "--engine",
            "direct",
            "--real-time",
            "1",
            "--out",
            "run",
        ]
        process = subprocess.Popen(
            command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )  # fmt: skip
        processes.append(process)
        assert process.stdout is not None
        assert "boat" in process.stdout.readline()
        return process, [process.stdout.readline().strip() for _ in range(2)]

    yield start
    for process in processes:
        process.kill()
        process.communicate()


def station(url: str, signed: bool) -> Any:
    """Return a ground station that is connected, and that the vehicle sends to."""
    found = mavutil.mavlink_connection(url, source_system=255, dialect="all")
    if signed:
        found.setup_signing(hashlib.sha256(PHRASE.encode()).digest())
    return found


def received_by(stations: list[Any]) -> list[list[Any]]:
    """Return the heartbeats that have arrived at each; pymavlink drops what is badly signed."""
    found = []
    for each in stations:
        found.append([])
        while (message := each.recv_match(type="HEARTBEAT", blocking=False)) is not None:
            found[-1].append(message)
    return found


def bound(url: str) -> str:
    """Return a URL as the vehicle has it."""
    kind, _, place = url.partition(":")
    return f"{kind.removesuffix('out')}in:{place}"


def is_armed(heartbeat: Any) -> bool:
    return bool(heartbeat.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("signed", "isolated"),
    [
        pytest.param(False, False, id="unsigned", marks=pytest.mark.interop),
        pytest.param(True, False, id="signed"),
        pytest.param(True, True, id="isolated", marks=pytest.mark.interop),
    ],
)
def test_the_last_heartbeat_says_disarmed(signed: bool, isolated: bool, run, monkeypatch) -> None:
    monkeypatch.setenv("MAVLINK20", "1")  # pymavlink's first frame has no signature otherwise
    process, urls = run(signed, isolated)
    stations = [station(url, signed) for url in urls]
    last: list[Any] = [None, None]
    deadline = time.monotonic() + 60
    while not all(beat is not None and is_armed(beat) for beat in last):
        assert time.monotonic() < deadline, last
        for each in stations:
            each.mav.heartbeat_send(6, 8, 0, 0, 4)
        stations[0].mav.command_long_send(1, 1, 400, 0, 1, FORCED, 0, 0, 0, 0, 0)
        time.sleep(0.1)
        last = [
            (beats or [before])[-1]
            for beats, before in zip(received_by(stations), last, strict=True)
        ]
    child = child_of(process)
    os.kill(child, signal.SIGKILL)
    _, message = process.communicate(timeout=60)
    assert process.returncode == 3, message
    for each, beats, url in zip(stations, received_by(stations), urls, strict=True):
        assert beats, message
        assert not is_armed(beats[-1])
        assert beats[-1].system_status == mavlink.MAV_STATE_STANDBY
        assert bool(beats[-1].get_signed()) == signed
        assert isolated or f"sent the safe state of boat to {bound(url)}" in message
        each.close()
