"""Vehicles of `seatrial new`, without an edit, under ArduPilot's own firmware.

SEATRIAL_ARDUPILOT names the folder of the programs. Each run has a network of its own.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from seatrial.cli.making.new import KINDS
from seatrial.trial.records.run_folder import Run, load_run
from tests.command import SEATRIAL, seatrial
from tests.interop.test_dronecan_multicast import ROOT, alone, can_be_alone

FOLDER = os.environ.get("SEATRIAL_ARDUPILOT", "")
pytestmark = [
    pytest.mark.interop,
    pytest.mark.long,
    pytest.mark.skipif(not FOLDER, reason="SEATRIAL_ARDUPILOT names no folder of programs"),
    pytest.mark.skipif(not can_be_alone(), reason="no network of one's own here"),
]
SEAS = {"calm": (), "wind and waves": ("sea.height=0.3 m", "wind.speed=6 m/s")}
MANUAL, HOLD, GUIDED = 0, 4, 15
"""Modes of ArduPilot Rover."""
DEPTH_HOLD, GUIDED_SUB = 2, 4
"""Modes of ArduSub."""


class Boat(NamedTuple):
    """What a boat does by hand: time of each order, s, least speed, m/s; where it is sent, m."""

    seconds: float
    speed: float
    to: tuple[float, float, float]
    within: float


BOATS = {
    "usv": Boat(20.0, 0.5, (15.0, 15.0, 0.0), 3.0),
    "auv": Boat(30.0, 0.8, (40.0, 40.0, 0.0), 8.0),
    "azimuth": Boat(30.0, 1.0, (40.0, 40.0, 0.0), 6.0),
    "ship": Boat(120.0, 2.0, (500.0, 500.0, 0.0), 80.0),
}


def command(like: str, sea: str, folder: Path, *what: str) -> list[str]:
    """Make a vehicle, and return the command that runs it."""
    for part in ("vehicle", "ardupilot"):
        done = seatrial("new", part, "boat", "--like", like, cwd=folder)
        assert done.returncode == 0, done.stderr
    program = Path(FOLDER, "ardusub" if like == "rov" else "ardurover").resolve()
    step = ("--choose", "step=2.5 ms") if like == "rov" else ()
    settings = (*SEAS[sea], "autopilot.sitl.ardupilot.speedup=20")
    return [
        SEATRIAL, "run", *what, "--autopilot", f"ardupilot={program}", "--engine", "native",
        "--out", str(folder / "run"), *step,
        *(word for setting in settings for word in ("--set", setting)),
    ]  # fmt: skip


def ended(words: list[str], cwd: Path) -> str:
    """Run a command in a network of its own to its end, and return what it printed."""
    quoted = f"PYTHONPATH={ROOT}:$PYTHONPATH {subprocess.list2cmdline(words)}"
    done = subprocess.run(alone(quoted), cwd=cwd, capture_output=True, text=True, timeout=1500)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("sea", SEAS)
@pytest.mark.parametrize("like", KINDS)
def test_it_goes_round_its_square(like: str, sea: str, tmp_path: Path) -> None:
    ended(command(like, sea, tmp_path, "square", "--vehicle", "boat"), tmp_path)
    assert load_run(tmp_path / "run").manifest["status"] == "complete"


def driven(like: str, orders: list[dict[str, object]], folder: Path) -> tuple[Run, list[slice]]:
    """Drive it in wind and waves; return the record, and the rows of each order."""
    firmware = "sub" if like == "rov" else "rover"
    lasts = 300.0 + sum(float(str(order["s"])) for order in orders)
    run = command(like, "wind and waves", folder, "boat", "--set", f"stop={lasts} s")
    words = [sys.executable, "-m", "tests.kits.ardupilot.orders", firmware, json.dumps(orders)]
    printed = json.loads(ended([*words, "--", *run], folder).splitlines()[-1])
    assert not [text for text in printed["texts"] if "ailsafe" in text]
    record = load_run(folder / "run")
    return record, [slice(*np.searchsorted(record.time, times)) for times in printed["times"]]


def away(record: Run, to: tuple[float, float, float], row: int = -1) -> float:
    """Return how far it is from a place, m."""
    here = [record.signals[f"vehicle.hull.position.{axis}"][row] for axis in "xyz"]
    return math.dist(here, to)


@pytest.mark.parametrize("like", BOATS)
def test_a_boat_obeys_the_hand_and_goes_where_it_is_sent(like: str, tmp_path: Path) -> None:
    boat = BOATS[like]
    record, (ahead, turning, held, sent) = driven(
        like,
        [
            {"mode": MANUAL, "s": boat.seconds, "hand": [0.6, 0, 0]},
            {"mode": MANUAL, "s": boat.seconds, "hand": [0.6, 0.4, 0]},
            {"mode": HOLD, "s": 10.0},
            {"mode": GUIDED, "s": 4.0 * boat.seconds, "to": boat.to},
        ],
        tmp_path,
    )
    speed = record.signals["vehicle.hull.velocity.u"]
    assert speed[ahead][-1] > boat.speed
    heading = np.unwrap(record.signals["vehicle.hull.attitude.psi"])
    assert heading[turning][-1] - heading[turning][0] > math.radians(20.0)
    resting = [record.signals[f"autopilot.sitl.ardupilot.pulse.ch{n}"][held][-1] for n in (1, 3)]
    assert resting == pytest.approx([1500e-6, 1500e-6], abs=3e-6)
    assert min(away(record, boat.to, row) for row in range(sent.start, sent.stop)) < boat.within


def test_the_rov_holds_its_depth_and_goes_where_it_is_sent(tmp_path: Path) -> None:
    to = (4.0, 4.0, 3.0)
    record, (dive, hold, ahead, turning, sent) = driven(
        "rov",
        [
            {"mode": DEPTH_HOLD, "s": 10.0, "hand": [0, 0, -0.8]},
            {"mode": DEPTH_HOLD, "s": 20.0, "hand": [0, 0, 0]},
            {"mode": DEPTH_HOLD, "s": 10.0, "hand": [0.5, 0, 0]},
            {"mode": DEPTH_HOLD, "s": 5.0, "hand": [0, 0.5, 0]},
            {"mode": GUIDED_SUB, "s": 60.0, "to": to},
        ],
        tmp_path,
    )
    depth = record.signals["vehicle.hull.position.z"]
    assert depth[dive][-1] > 1.5
    held = depth[hold][len(depth[hold]) // 2 :]
    assert np.ptp(held) < 0.2
    assert record.signals["vehicle.hull.velocity.u"][ahead][-1] > 0.2
    heading = np.unwrap(record.signals["vehicle.hull.attitude.psi"])
    assert heading[turning][-1] - heading[turning][0] > math.radians(20.0)
    assert away(record, to, sent.stop - 1) < 0.5
