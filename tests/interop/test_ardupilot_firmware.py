"""Missions of ArduPilot's own firmware, where SEATRIAL_ARDUPILOT names the folder of its programs.

They are ``ardurover``, ``ardusub`` and ``arducopter``, built from their public source for SITL. They listen at port
5760 of every interface: each mission has a network of its own.
"""

from __future__ import annotations

import csv
import itertools
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pymavlink import mavutil

from seatrial.trial.records.run_folder import Run, load_run
from tests.command import SEATRIAL

from .test_dronecan_multicast import ROOT, alone, can_be_alone

pytestmark = [pytest.mark.interop, pytest.mark.long]
FOLDER = os.environ.get("SEATRIAL_ARDUPILOT", "")

if not FOLDER:
    pytest.skip("SEATRIAL_ARDUPILOT names no folder of programs", allow_module_level=True)
if not can_be_alone():
    pytest.skip("no network of one's own here", allow_module_level=True)

Place = tuple[float, float, float]
"""North, east and depth, m."""

SQUARE: tuple[Place, ...] = ((40, 0, 0), (40, 40, 0), (0, 40, 0), (0, 0, 0))
MILES: tuple[Place, ...] = ((3000, 0, 0), (6000, 0, 0), (8500, 2500, 0), (11500, 2500, 0))
MARKS: tuple[Place, ...] = ((0, 100, 0), (40, 160, 0), (80, 190, 0), (80, 270, 0))
"""On one tack in a wind to the north: before it ArduPilot keeps a wing sail on its side."""
DEPTHS: tuple[Place, ...] = ((10, 0, 3), (10, 10, 5), (0, 10, 5), (0, 0, 2))
MISSIONS = {
    # vehicle: (firmware, waypoints, how near it comes to each m, options)
    "hydrone": ("rover", SQUARE, 3.0, ()),
    "otter": ("rover", SQUARE, 5.0, ()),
    "mariner": ("rover", MILES, 600.0, ("--set", "stop=3600 s")),
    "gloria": ("rover", MARKS, 20.0, ("--choose", "servos=pulse", "--set", "stop=1800 s")),
    "bluerov2": ("sub", DEPTHS, 3.0, ("--choose", "step=2.5 ms")),
}
SPEEDUP = "20"


def mission(vehicle: str, out: Path, engine: str = "direct") -> dict[str, list[str]]:
    """Send a vehicle on its mission, and return what the ground station printed."""
    firmware, places, _, options = MISSIONS[vehicle]
    program = Path(FOLDER, f"ardu{firmware}").resolve()
    command = [
        sys.executable, "-m", "tests.interop.ardupilot_mission", firmware,
        *(",".join(map(str, place)) for place in places), "--",
        SEATRIAL, "run", "under-ardupilot", "--vehicle", vehicle,
        "--autopilot", f"ardupilot={program}", "--out", out, "--engine", engine,
        "--set", f"autopilot.sitl.ardupilot.speedup={SPEEDUP}", *options,
    ]  # fmt: skip
    quoted = subprocess.list2cmdline(list(map(str, command)))
    done = subprocess.run(alone(quoted), cwd=ROOT, capture_output=True, text=True, timeout=1500)
    assert done.returncode == 0, done.stdout + done.stderr
    found: dict[str, list[str]] = json.loads(done.stdout.splitlines()[-1])
    return found


def track(run: Path) -> list[Place]:
    """Return the positions of a run."""
    with (run / "signals.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(file)
        names = [n for n in rows.fieldnames or () if ".position." in n]
        return [(float(row[names[0]]), float(row[names[1]]), float(row[names[2]])) for row in rows]


@pytest.mark.parametrize("vehicle", sorted(MISSIONS))
def test_a_mission_is_driven_without_a_failsafe(vehicle: str, tmp_path: Path) -> None:
    _, places, near, _ = MISSIONS[vehicle]
    found = mission(vehicle, tmp_path / "run")
    assert [*found["reached"]] == [str(number) for number in range(1, len(places) + 1)]
    assert not [text for text in found["texts"] if "ailsafe" in text or "EKF variance" in text]
    path = track(tmp_path / "run")
    for place in places:
        assert min(math.dist(place, at) for at in path) < near
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["status"] == "stopped"
    assert all(math.isfinite(value) for value in itertools.chain.from_iterable(path))
    assert list((tmp_path / "run" / "autopilot.sitl.ardupilot" / "logs").glob("*.BIN"))


ROUND = {
    # vehicle: (firmware, options, time to come back at most, s)
    "hydrone": ("rover", (), 240.0),
    "otter": ("rover", (), 190.0),
    "mariner": ("rover", (), 3000.0),
    "bluerov2": ("sub", ("--choose", "step=2.5 ms"), 150.0),
    "videoray": ("sub", ("--choose", "step=2.5 ms"), 150.0),
}


def rounded(vehicle: str, firmware: str, out: Path, *options: str) -> Path:
    """Send a vehicle round its square, where it comes back, and return the run's folder."""
    command = [
        SEATRIAL, "run", "square", "--vehicle", vehicle,
        "--autopilot", f"ardupilot={Path(FOLDER, f'ardu{firmware}').resolve()}", "--out", out,
        "--engine", "direct", "--set", f"autopilot.sitl.ardupilot.speedup={SPEEDUP}", *options,
    ]  # fmt: skip
    quoted = subprocess.list2cmdline(list(map(str, command)))
    done = subprocess.run(alone(quoted), cwd=ROOT, capture_output=True, text=True, timeout=1500)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


@pytest.mark.parametrize("vehicle", ROUND)
def test_the_trial_square(vehicle: str, tmp_path: Path) -> None:
    firmware, options, at_most = ROUND[vehicle]
    run = load_run(rounded(vehicle, firmware, tmp_path / "run", *options))
    assert run.manifest["status"] == "complete"
    assert run.time[-1] < at_most


@pytest.mark.skipif(not Path(FOLDER, "arducopter").is_file(), reason="no arducopter there")
@pytest.mark.parametrize(("drone", "seed"), [("huauv", 1), ("huauv", 2), ("huauv", 3), ("x500", 1)])
def test_a_copter_lands_on_a_boat_each_under_its_own_firmware(
    drone: str, seed: int, tmp_path: Path
) -> None:
    rover, copter = (Path(FOLDER, f"ardu{name}").resolve() for name in ("rover", "copter"))
    command = [
        SEATRIAL, "run", "hydrone-drone-ardupilot", "--engine", "native", "--set", f"seed={seed}",
        "--autopilot", f"ardupilot={rover}", "--choose", f"copter={copter}", "--choose",
        f"drone={drone}", "--out", tmp_path / "run",
        "--set", f"drone.ardupilot.speedup={SPEEDUP}",
        "--set", f"keeper.firmware.sitl.ardupilot.speedup={SPEEDUP}",
    ]  # fmt: skip
    quoted = subprocess.list2cmdline(list(map(str, command)))
    done = subprocess.run(alone(quoted), cwd=ROOT, capture_output=True, text=True, timeout=900)
    # Status 0: on the pad within 0.30 m, at less than 1 m/s, at rest there 4 s later.
    assert done.returncode == 0, done.stdout + done.stderr
    for name in ("keeper.firmware.sitl.ardupilot", "drone.ardupilot"):
        assert list((tmp_path / "run" / name / "logs").glob("*.BIN"))


def test_log_and_record_have_one_clock(tmp_path: Path) -> None:
    """The truth as the firmware logs it is that of the record 11 to 14 ms later: a step and a bit."""
    run = load_run(rounded("otter", "rover", tmp_path / "run"))
    (path,) = (tmp_path / "run" / "autopilot.sitl.ardupilot" / "logs").glob("*.BIN")
    log = mavutil.mavlink_connection(str(path))
    rows = []
    while (row := log.recv_match(type="SIM2")) is not None:
        rows.append((row.TimeUS / 1e6, row.PN, row.PE))
    logged = np.array(rows)
    north, east = (run.signals[f"vehicle.hull.position.{axis}"] for axis in "xy")
    for part in np.array_split(logged, 3):

        def off(late: float, part: np.ndarray = part) -> float:
            x, y = (np.interp(part[:, 0] + late, run.time, each) for each in (north, east))
            return float(np.mean((x - part[:, 1]) ** 2 + (y - part[:, 2]) ** 2))

        candidates = np.arange(-0.1, 0.1, 0.001)
        assert 0.005 < candidates[np.argmin([off(late) for late in candidates])] < 0.02


FAULT = """
rig     = "square"
choices = {{ vehicle = "{vehicle}", autopilot = "ardupilot", program = "{program}", step = "{step}" }}
stop    = "{stop} s"
[set]
"autopilot.sitl.ardupilot.speedup" = {speedup}
[record]
signals = ["vehicle.motion.*", "marks.*", "mission.station.*"]
every   = "200 ms"
[[{table}]]
at  = "{at} s"
{what}
"""
HOLD, AUTO_ROVER, AUTO_SUB = 4, 10, 3
GNSS, COMPASS = (
    f'set = {{ "mission.station.without.{name}" = true }}' for name in ("gnss", "compass")
)


def after(what: str, vehicle: str, at: float, stop: float, folder: Path) -> Run:
    """Sail the square with a fault on the way, and return the run."""
    sub = vehicle == "bluerov2"
    program = Path(FOLDER, "ardusub" if sub else "ardurover").resolve()
    trial = folder / "fault.toml"
    trial.write_text(
        FAULT.format(
            vehicle=vehicle, program=program, at=at, stop=stop, what=what, speedup=SPEEDUP,
            table="events" if what.startswith("set") else "faults",
            step="2.5 ms" if sub else "10 ms",
        )
    )  # fmt: skip
    command = [SEATRIAL, "run", trial, "--engine", "direct", "--out", folder / "run"]
    quoted = subprocess.list2cmdline(list(map(str, command)))
    done = subprocess.run(alone(quoted), cwd=folder, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    return load_run(folder / "run")


def at_the_end(run: Run) -> tuple[int, bool, bool]:
    """Return the mode, and whether it is armed and had a failsafe."""
    found = [run.signals[f"mission.station.{name}"][-1] for name in ("mode", "armed", "failsafe")]
    return int(found[0]), bool(found[1]), bool(found[2])


def test_without_gnss_the_hydrone_holds_after_8_s(tmp_path: Path) -> None:
    run = after(GNSS, "hydrone", 100, 150, tmp_path)
    assert at_the_end(run) == (HOLD, True, True)
    failed = run.time[np.argmax(run.signals["mission.station.failsafe"] > 0)]
    assert 106.0 < failed < 112.0
    assert abs(run.signals["vehicle.hull.velocity.u"][-1]) < 0.05


def test_without_compasses_the_hydrone_comes_back(tmp_path: Path) -> None:
    run = after(COMPASS, "hydrone", 100, 220, tmp_path)
    assert at_the_end(run)[2] is False
    assert run.signals["marks.passed"][-1] == 4


def test_with_one_thruster_the_otter_lies_still_and_armed(tmp_path: Path) -> None:
    run = after('where = "vehicle.port_propeller"\nwhat = "off"', "otter", 80, 150, tmp_path)
    assert at_the_end(run) == (AUTO_ROVER, True, False)
    assert run.signals["marks.passed"][-1] == 1
    assert abs(run.signals["vehicle.hull.velocity.u"][-1]) < 0.05


def test_with_a_stuck_rudder_the_mariner_circles(tmp_path: Path) -> None:
    run = after('where = "vehicle.machine"\nwhat = "stuck"', "mariner", 700, 1900, tmp_path)
    assert at_the_end(run) == (AUTO_ROVER, True, False)
    turned = run.signals["vehicle.ship.attitude.psi"]
    assert abs(turned[-1] - turned[np.argmin(abs(run.time - 700))]) > 4.0
    assert run.signals["marks.passed"][-1] == 1


def test_without_gnss_the_bluerov2_drifts_off_at_its_depth(tmp_path: Path) -> None:
    run = after(GNSS, "bluerov2", 70, 160, tmp_path)
    assert at_the_end(run) == (AUTO_SUB, True, False)
    x, y, z = (run.signals[f"vehicle.hull.position.{axis}"] for axis in "xyz")
    assert max(abs(x[-1]), abs(y[-1])) > 15.0
    assert 2.0 < z[-1] < 8.0


def test_with_a_thruster_less_the_bluerov2_goes_on(tmp_path: Path) -> None:
    run = after('where = "vehicle.thrusters.t1"\nwhat = "off"', "bluerov2", 70, 160, tmp_path)
    assert at_the_end(run) == (AUTO_SUB, True, False)
    assert run.signals["marks.passed"][-1] >= 3
