"""Missions of ArduPilot's own firmware, where SEATRIAL_ARDUPILOT names the folder of its programs.

They are ``ardurover`` and ``ardusub``, built from their public source for SITL. They listen at port
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

import pytest

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
