"""The autopilot `px4`: trials of the shipped vehicles under a stand-in for the firmware."""

from __future__ import annotations

import csv
import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from seatrial.system.profile.profile import load_profile
from seatrial_kits.px4.firmware import PORT, read_parameters
from tests.command import SEATRIAL, seatrial

ROOT = Path(__file__).parents[3]
NAME = "autopilot.sitl.px4"
TRIAL = """
rig     = "sil"
choices = {{ vehicle = "{vehicle}", autopilot = "px4" }}
stop    = "3 s"
[set]
"{name}.speedup" = 1000
[record]
signals = ["vehicle.motion.*", "{name}.pulse.*"]
"""
FRAMES = {"hydrone": (102, 101), "otter": (102, 101)}
"""Functions of a differential rover's motors by channel: left is PX4's motor 2, right its 1."""


def instance() -> int:
    """Return the number of an instance whose port nobody has."""
    first = 50 + os.getpid() % 190
    for number in [*range(first, 250), *range(50, first)]:
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", PORT + number))
            except OSError:
                continue
            return number
    raise OSError("no free port")


def at(number: int) -> tuple[str, str]:
    return ("--set", f"{NAME}.link=tcpin:127.0.0.1:{PORT + number}")


@pytest.fixture
def program(tmp_path: Path) -> Path:
    """A program in a folder as a build for SITL leaves it."""
    start = tmp_path / "build" / "etc" / "init.d-posix" / "rcS"
    start.parent.mkdir(parents=True)
    start.touch()
    path = tmp_path / "build" / "bin" / "px4"
    path.parent.mkdir()
    python = f'PYTHONPATH="{ROOT}:$PYTHONPATH" exec {sys.executable}'
    path.write_text(f'#!/bin/sh\n{python} -m tests.kits.px4.peer "$@"\n')
    path.chmod(0o755)
    return path


def flown(vehicle: str, program: Path, out: str, *more: str) -> Path:
    """Run a vehicle under the program, and return the run's folder."""
    folder = program.parents[2]
    (folder / "trial.toml").write_text(TRIAL.format(vehicle=vehicle, name=NAME))
    done = seatrial(
        "run", "trial.toml", "--autopilot", f"px4={program}", "--out", out, *at(instance()), *more,
        cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / out


def last_row(folder: Path) -> dict[str, float]:
    with (folder / "signals.csv").open(encoding="utf-8") as file:
        return {name: float(value) for name, value in list(csv.DictReader(file))[-1].items()}


def has_ended(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.mark.slow
def test_a_program_is_started_in_the_run_folder_and_ended_with_it(program: Path) -> None:
    folder = flown("hydrone", program, "run", "--engine", "direct")
    own = folder / NAME
    assert (own / "log" / "2026-01-01" / "00_00_00.ulg").read_bytes() == b"ULog"
    pid, etc, *variables = (own / "output.txt").read_text().splitlines()
    assert has_ended(int(pid.split()[1]))
    assert Path(etc.split()[1]) == program.parents[1] / "etc"
    given = dict(line.split("=") for line in variables)
    assert given["PX4_SYS_AUTOSTART"] == "50000"
    assert given["PX4_SIMULATOR"] == "none"
    wanted = read_parameters(load_profile("hydrone").parameters("links.px4")["defaults"])
    assert {n: given[f"PX4_PARAM_{n}"] for n in wanted} == wanted
    assert given["PX4_PARAM_EKF2_GPS_POS_Z"] == "-0.3"
    row = last_row(folder)
    assert row["vehicle.hull.position.x"] > 0.5  # it drove ahead when the actuators came
    assert row["vehicle.hull.attitude.psi"] == pytest.approx(0.0, abs=0.01)


@pytest.mark.slow
def test_it_runs_as_an_fmu(program: Path) -> None:
    row = last_row(flown("otter", program, "run", "--engine", "fmu"))
    assert row[f"{NAME}.pulse.ch1"] == pytest.approx(1700e-6)
    assert row["vehicle.hull.velocity.u"] > 0.2


@pytest.mark.parametrize("vehicle", sorted(FRAMES))
def test_parameter_files_have_the_channels_of_the_profile(vehicle: str) -> None:
    """PX4's differential rover numbers its motors right, left."""
    profile = load_profile(vehicle)
    values = read_parameters(profile.parameters("links.px4")["defaults"])
    channels = {name: each.channel for name, each in profile.file.actuators.items()}
    found = [values[f"PWM_MAIN_FUNC{channels[side]}"] for side in ("port", "starboard")]
    assert tuple(map(int, found)) == FRAMES[vehicle]
    assert values["MAV_TYPE"] == "11"


def test_a_program_that_ends_fails_the_run_with_what_it_said(program: Path) -> None:
    program.write_text("#!/bin/sh\necho no such airframe\nexit 3\n")
    done = seatrial(
        "run", "under-px4", "--autopilot", f"px4={program}", *at(instance()), "--out", "run",
        cwd=program.parents[2],
    )  # fmt: skip
    assert done.returncode == 3
    assert f"{NAME}: PX4 ended with status 3; " in done.stderr
    assert "no such airframe" in done.stderr


@pytest.mark.parametrize(
    ("autopilot", "said"),
    [
        ("px4=nowhere/px4", "program: there is no file"),
        ("px4=/bin/sh", "is of no build of PX4 for SITL"),
    ],
)
def test_what_cannot_be_started_is_bad_input(tmp_path: Path, autopilot: str, said: str) -> None:
    done = seatrial("run", "under-px4", "--autopilot", autopilot, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_run_that_waits_says_what_to_start_and_can_be_stopped(tmp_path: Path) -> None:
    command = [SEATRIAL, "run", "under-px4", *at(instance()), "--out", "run", "--engine", "direct"]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        said = process.stderr.readline() + process.stderr.readline()
        assert "start PX4, in a folder of its own:" in said
        assert "PX4_SYS_AUTOSTART=50000 " in said
        process.send_signal(signal.SIGINT)
        begun = time.monotonic()
        assert process.wait(20.0) == 3
        assert time.monotonic() - begun < 5.0
    finally:
        process.kill()
        process.communicate()
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["status"] == "stopped"
