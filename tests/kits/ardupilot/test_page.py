"""The commands of docs/kits/ardupilot/autopilots.md, as they are there, with stand-ins for the firmware."""

from __future__ import annotations

import re
import shlex
import socket
import sys
from pathlib import Path

import pytest

from tests.command import seatrial
from tests.interop.running import free_port

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs/kits/ardupilot/autopilots.md"
COMMANDS = re.findall(r"^\$ (seatrial .*)$", PAGE.read_text("utf-8"), re.MULTILINE)
HULL, OTHERS = COMMANDS[:4], COMMANDS[4:]
"""From nothing to a hull under ArduPilot, and what follows."""
ANY_PORT = ("--set", "autopilot.sitl.ardupilot.link=udpin:127.0.0.1:0")
"""What a test adds: a port that no other test has."""


def built(folder: Path, module: str) -> None:
    """Make a program where the page says that ArduPilot's is."""
    program = folder / "build" / "sitl" / "bin" / "ardurover"
    program.parent.mkdir(parents=True)
    python = f'PYTHONPATH="{ROOT}:$PYTHONPATH" exec {sys.executable}'
    program.write_text(f'#!/bin/sh\n{python} -m {module} "$@"\n')
    program.chmod(0o755)


@pytest.mark.long
@pytest.mark.interop
def test_from_nothing_to_a_hull_under_ardupilot(tmp_path: Path) -> None:
    built(tmp_path, "tests.kits.mavlink.ground_station.vehicle")
    port = free_port(socket.SOCK_STREAM)
    more = (
        *ANY_PORT, "--set", f"mission.station.link=tcpin:127.0.0.1:{port}",
        "--choose", f"serial0=tcpclient:127.0.0.1:{port}",
        "--set", "autopilot.sitl.ardupilot.speedup=100",
    )  # fmt: skip
    for command in HULL:
        added = more if "ardupilot=" in command else ()
        done = seatrial(*shlex.split(command)[1:], *added, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("PASS") == 3
    for name in ("hil_profiles/my-boat.parm", "harness/rigs/ardupilot/my-boat.toml"):
        assert (tmp_path / name).is_file()
        assert f"`{name}`" in PAGE.read_text("utf-8")


@pytest.mark.parametrize("command", [c for c in OTHERS if "ardupilot=" in c])
def test_what_the_page_says_runs(command: str, tmp_path: Path) -> None:
    built(tmp_path, "tests.kits.ardupilot.peer")
    quick = ("--set", "stop=1 s", *ANY_PORT)
    done = seatrial(*shlex.split(command)[1:], *quick, "--out", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    own = tmp_path / "run" / "autopilot.sitl.ardupilot"
    assert (own / "eeprom.bin").is_file()
    assert (own / "output.txt").is_file()
    assert (tmp_path / "run" / "signals.csv").is_file()


def test_the_page_has_both_ways_to_start() -> None:
    assert [("ardupilot=" in c) for c in HULL] == [False, False, False, True]
    assert [("ardupilot=" in c) for c in OTHERS] == [True, False]
