"""The trial `square`: with a stand-in for ArduPilot, and with what is built in."""

from __future__ import annotations

import csv
import json
import socket
import sys
from pathlib import Path

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from tests.command import seatrial
from tests.interop.running import free_port
from tests.kit import needs_kits, vehicles

pytestmark = needs_kits("ardupilot")

ROOT = Path(__file__).parents[2]
SHORT = """
title  = "a course"
source = "this test"
[square]
count      = { value = 2, unit = "1", source = "this test", mark = "assumed" }
waypoint_1 = { value = [8, 0, 0], unit = "m", source = "this test", mark = "assumed" }
waypoint_2 = { value = [8, 6, 0], unit = "m", source = "this test", mark = "assumed" }
radius     = { value = 1, unit = "m", source = "this test", mark = "assumed" }
"""
ANY_PORT = ("--set", "autopilot.sitl.ardupilot.link=udpin:127.0.0.1:0")


@pytest.fixture
def sea(tmp_path: Path) -> Path:
    """A folder with a short course, and a firmware that knows its MAVLink."""
    (tmp_path / "vehicles").mkdir()
    (tmp_path / "vehicles" / "short.toml").write_text(SHORT)
    program = tmp_path / "ardurover"
    module = f"{sys.executable} -m tests.kits.mavlink.ground_station.vehicle"
    program.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}:$PYTHONPATH" exec {module} "$@"\n')
    program.chmod(0o755)
    return tmp_path


@pytest.mark.slow
def test_a_firmware_is_sent_round_and_its_true_track_decides(sea: Path) -> None:
    port = free_port(socket.SOCK_STREAM)
    done = seatrial(
        "run", "square", "--autopilot", "ardupilot=ardurover", "--choose", "course=short.square",
        "--choose", f"serial0=tcpclient:127.0.0.1:{port}",
        "--set", f"mission.station.link=tcpin:127.0.0.1:{port}",
        "--set", "autopilot.sitl.ardupilot.speedup=100", "--set", "stop=90 s",
        "--engine", "direct", "--out", "run", *ANY_PORT,
        cwd=sea,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    with (sea / "run" / "signals.csv").open(encoding="utf-8") as file:
        *_, last = csv.DictReader(file)
    assert (float(last["marks.passed"]), float(last["marks.left"])) == (2.0, 0.0)
    assert float(last["vehicle.hull.position.x"]) == pytest.approx(8.0, abs=1.6)
    assert float(last["vehicle.hull.position.y"]) == pytest.approx(6.0, abs=1.6)
    manifest = json.loads((sea / "run" / "manifest.json").read_text())
    assert manifest["status"] == "complete"
    assert float(last["time"]) < 90.0  # it ends with the last waypoint


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "home"), [("220 N/m", (0.0, 0.2)), ("0 N/m", (1.5, 4.0))])
def test_in_a_current_its_mission_does_not_drift(
    stiffness: str, home: tuple[float, float], sea: Path
) -> None:
    """The stand-in takes its home from where it is after 12 s: 2 m off, but for the mooring."""
    port = free_port(socket.SOCK_STREAM)
    done = seatrial(
        "run", "square", "--autopilot", "ardupilot=ardurover", "--choose", "course=short.square",
        "--choose", f"serial0=tcpclient:127.0.0.1:{port}",
        "--set", f"mission.station.link=tcpin:127.0.0.1:{port}",
        "--set", "autopilot.sitl.ardupilot.speedup=100", "--set", "stop=90 s",
        "--set", "current.speed=0.2", "--set", "current.direction=90 deg",
        "--set", f"autopilot.mooring.stiffness={stiffness}",
        "--engine", "direct", "--out", "run", *ANY_PORT,
        cwd=sea,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    run = load_run(sea / "run")
    least, most = home
    assert least < run.signals["marks.home_error"][-1] < most
    assert run.signals["marks.error"].max() < 0.05  # it knows where it is
    page = (sea / "run" / "report.html").read_text("utf-8")
    assert "home of the autopilot, from the origin" in page
    assert "mark 2 (8 m north, 6 m east)" in page


@pytest.mark.slow
def test_a_firmware_that_says_nothing_ends_the_run(sea: Path) -> None:
    peer = ROOT / "tests" / "kits" / "ardupilot" / "peer.py"
    (sea / "ardurover").write_text(f'#!/bin/sh\nexec {sys.executable} {peer} "$@"\n')
    port = free_port(socket.SOCK_STREAM)
    done = seatrial(
        "run", "square", "--autopilot", "ardupilot=ardurover", "--out", "run", "--engine", "direct",
        "--set", f"mission.station.link=tcpin:127.0.0.1:{port}", "--choose", "step=50 ms", *ANY_PORT,
        cwd=sea,
    )  # fmt: skip
    assert done.returncode == 3
    assert "mission.station: no heartbeat within 60 s; the vehicle said: nothing" in done.stderr


def test_an_autopilot_that_takes_no_waypoints_is_refused(tmp_path: Path) -> None:
    done = seatrial("run", "square", "--autopilot", "station-keeping", cwd=tmp_path)
    assert done.returncode == 2
    assert "unknown rig 'missions/station-keeping'" in done.stderr


def sailed(folder: Path, **changes: str) -> None:
    """Run the trial to its end, where all criteria hold."""
    trial = load_trial("square", changes={k.replace("__", "."): v for k, v in changes.items()})
    result = run_trial(trial, folder / "run", engine="direct")
    assert (result.status, result.passed) == ("complete", True), result.verdicts


@pytest.mark.interop
@pytest.mark.parametrize("vehicle", vehicles("hydrone", "otter", "videoray", "bluerov2"))
def test_pilots_on_a_course(vehicle: str, tmp_path: Path) -> None:
    sailed(tmp_path, choices__vehicle=vehicle)


@pytest.mark.interop
@pytest.mark.parametrize("autopilot", ["nmea0183", "nmea2000", "hydrone-can"])
def test_pilots_on_a_course_with_other_links(autopilot: str, tmp_path: Path) -> None:
    given = {"choices__autopilot": autopilot}
    if autopilot == "nmea0183":
        given["autopilot__instruments__links"] = ""
    sailed(tmp_path, **given)


@pytest.mark.interop
@pytest.mark.parametrize("vehicle", vehicles("hydrone", "otter", "videoray"))
def test_vehicles_under_a_ground_station(vehicle: str, tmp_path: Path) -> None:
    links = {"autopilot__mavlink__links": "tcpin:127.0.0.1:0"}
    sailed(tmp_path, choices__vehicle=vehicle, choices__autopilot="mavlink", **links)


@pytest.mark.long
@pytest.mark.parametrize("autopilot", ["guidance", "mavlink"])
@pytest.mark.parametrize("vehicle", vehicles("mariner", "gloria", "bluerov2"))
def test_the_slow_ones(vehicle: str, autopilot: str, tmp_path: Path) -> None:
    links = {"autopilot__mavlink__links": "tcpin:127.0.0.1:0"} if autopilot == "mavlink" else {}
    sailed(tmp_path, choices__vehicle=vehicle, choices__autopilot=autopilot, **links)
