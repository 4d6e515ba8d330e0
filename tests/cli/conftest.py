"""Fixtures of runs with a gateway to a vehicle."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.command import SEATRIAL

from .gateway import RIG, SAFE, TALKER, Launched, Start, Vehicle


@pytest.fixture
def vehicle() -> Iterator[Vehicle]:
    vehicle = Vehicle()
    yield vehicle
    vehicle.close()


@pytest.fixture
def launched(tmp_path: Path) -> Iterator[Launched]:
    """Return a function that starts a command in the test's folder; it ends with the test."""
    processes: list[subprocess.Popen[str]] = []

    def launch(*command: str, **options: Any) -> subprocess.Popen[str]:
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        processes.append(subprocess.Popen(command, cwd=tmp_path, text=True, **pipes, **options))
        return processes[-1]

    yield launch
    for process in processes:
        process.kill()
        process.communicate()


@pytest.fixture
def start(write, vehicle: Vehicle, launched: Launched) -> Start:
    """Return a function that starts a run with a gateway to the vehicle."""

    def start(
        isolated: bool = False, start_takes: float = 0.0, out: str = "run"
    ) -> subprocess.Popen[str]:
        write("talker.py", TALKER)
        values = {"isolated": str(isolated).lower(), "device": vehicle.device, "safe": SAFE.hex()}
        write("rig.toml", RIG.format(**values, start_takes=start_takes))
        write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')
        # The terminal is this test's, which a run cannot know.
        options = ("--engine", "direct", "--real-time", "1", "--out", out, "--hardware")
        return launched(SEATRIAL, "run", "trial.toml", *options)

    return start
