"""Missions of PX4's own firmware, where SEATRIAL_PX4 names its program.

That is ``bin/px4`` of a build for SITL, from its public source. It opens UDP ports of every
interface: each run has a network of its own.
"""

from __future__ import annotations

import fcntl
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from seatrial.trial.records.run_folder import Run, load_run
from tests.command import SEATRIAL

from .test_dronecan_multicast import ROOT, alone, can_be_alone

pytestmark = [pytest.mark.interop, pytest.mark.long]
PROGRAM = os.environ.get("SEATRIAL_PX4", "")

if not PROGRAM:
    pytest.skip("SEATRIAL_PX4 names no program", allow_module_level=True)
if not can_be_alone():
    pytest.skip("no network of one's own here", allow_module_level=True)

NAME = "autopilot.sitl.px4"


@pytest.fixture(autouse=True)
def alone_on_this_machine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Wait for the other workers: PX4 locks its instance for the whole machine."""
    with (tmp_path_factory.getbasetemp().parent / "px4.lock").open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


DEPTHS = ((10, 0, 3), (10, 10, 5), (0, 10, 5), (0, 0, 2))
"""Places north, east and deep, m."""
BACK = {"hydrone": 210.0, "otter": 160.0}
"""Time to come back at most, s."""
HOLD, MISSION = 0x03040000, 0x04040000
"""PX4's custom_mode."""


def alone_run(command: list[object], cwd: Path = ROOT) -> str:
    quoted = subprocess.list2cmdline([str(each) for each in command])
    done = subprocess.run(alone(quoted), cwd=cwd, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def with_px4(trial: str, out: Path, *options: object) -> list[object]:
    program = Path(PROGRAM).resolve()
    return [
        SEATRIAL, "run", trial, "--autopilot", f"px4={program}", "--engine", "direct",
        "--out", out, *options,
    ]  # fmt: skip


def rounded(vehicle: str, out: Path, *options: object) -> Run:
    speed = ("--set", f"{NAME}.speedup=20")
    alone_run(with_px4("square", out, "--vehicle", vehicle, *speed, *options))
    return load_run(out)


@pytest.mark.parametrize("vehicle", sorted(BACK))
def test_the_trial_square(vehicle: str, tmp_path: Path) -> None:
    run = rounded(vehicle, tmp_path / "run")
    assert run.manifest["status"] == "complete"
    assert run.time[-1] < BACK[vehicle]
    own = tmp_path / "run" / NAME
    assert [path.stat().st_size > 100_000 for path in own.glob("log/*/*.ulg")] == [True]


def test_faster_sensors_do_as_well(tmp_path: Path) -> None:
    run = rounded("hydrone", tmp_path / "run", "--choose", "step=4 ms")
    assert run.time[-1] < BACK["hydrone"]


def test_a_submarine_is_driven_from_place_to_place(tmp_path: Path) -> None:
    command = with_px4(
        "under-px4", tmp_path / "run", "--vehicle", "bluerov2", "--set", f"{NAME}.speedup=3"
    )
    places = [",".join(map(str, place)) for place in DEPTHS]
    pilot = [sys.executable, "-m", "tests.interop.px4_pilot", *places, "--", *command]
    found = json.loads(alone_run(pilot).splitlines()[-1])
    assert len(found["reached"]) == len(DEPTHS)
    assert not [text for text in found["texts"] if "ailsafe" in text]
    run = load_run(tmp_path / "run")
    path = np.column_stack([run.signals[f"vehicle.hull.position.{axis}"] for axis in "xyz"])
    for place in DEPTHS:
        assert np.linalg.norm(path - place, axis=1).min() < 1.5


FAULT = """
rig     = "square"
choices = {{ vehicle = "hydrone", autopilot = "px4", program = "{program}" }}
stop    = "130 s"
[set]
"{name}.speedup" = 20
[record]
signals = ["vehicle.motion.*", "marks.*", "mission.station.*", "{name}.*"]
every   = "200 ms"
[[events]]
at  = "80 s"
set = {{ {what} }}
"""


def after(what: str, folder: Path) -> Run:
    """Send the Hydrone round with a fault on the way, and return the run."""
    trial = folder / "fault.toml"
    trial.write_text(FAULT.format(program=Path(PROGRAM).resolve(), what=what, name=NAME))
    alone_run([SEATRIAL, "run", trial, "--engine", "direct", "--out", folder / "run"], folder)
    return load_run(folder / "run")


def test_without_gnss_it_has_a_failsafe(tmp_path: Path) -> None:
    run = after(f'"{NAME}.without.gnss" = true', tmp_path)
    failsafe = run.signals["mission.station.failsafe"] > 0
    assert failsafe[-1]
    assert 80.0 < run.time[np.argmax(failsafe)] < 100.0
    assert abs(run.signals["vehicle.hull.velocity.u"][-1]) < 0.1


def test_without_a_compass_it_goes_on(tmp_path: Path) -> None:
    run = after(f'"{NAME}.without.compass" = true', tmp_path)
    assert run.signals["marks.passed"][-1] >= 2
