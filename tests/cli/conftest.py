"""Fixtures of runs with a gateway to a vehicle."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.command import SEATRIAL

from .gateway import RIG, SAFE, TALKER, Start, Vehicle


@pytest.fixture
def vehicle() -> Iterator[Vehicle]:
    vehicle = Vehicle()
    yield vehicle
    vehicle.close()


@pytest.fixture
def start(write, tmp_path: Path, vehicle: Vehicle) -> Iterator[Start]:
    """Return a function that starts a run with a gateway to the vehicle."""
    processes = []

    def start(
        isolated: bool = False, start_takes: float = 0.0, out: str = "run"
    ) -> subprocess.Popen[str]:
        write("talker.py", TALKER)
        write("rig.toml", RIG.format(
            isolated=str(isolated).lower(), device=vehicle.device, safe=SAFE.hex(), start_takes=start_takes
        ))  # fmt: skip
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
            out,
        ]
        command.append("--hardware")  # the terminal is this test's, which a run cannot know
        pipe = subprocess.PIPE
        processes.append(
            subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True)
        )
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.communicate()
