"""The commands of docs/autopilots.md, as they are there, with the stand-in for the firmware."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from tests.command import seatrial

HERE = Path(__file__).parent
PAGE = HERE.parents[2] / "docs" / "autopilots.md"
COMMANDS = re.findall(r"^\$ (seatrial run .*)$", PAGE.read_text("utf-8"), re.MULTILINE)
QUICK = ("--set", "stop=1 s", "--set", "autopilot.sitl.ardupilot.link=udpin:127.0.0.1:0")
"""What a test adds: a short trial, and a port that no other test has."""


@pytest.mark.parametrize("command", [c for c in COMMANDS if "ardupilot=" in c])
def test_what_the_page_says_runs(command: str, tmp_path: Path) -> None:
    program = tmp_path / "build" / "sitl" / "bin" / "ardurover"
    program.parent.mkdir(parents=True)
    program.write_text(f'#!/bin/sh\nexec {sys.executable} {HERE / "peer.py"} "$@"\n')
    program.chmod(0o755)
    done = seatrial(*shlex.split(command)[1:], *QUICK, "--out", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    own = tmp_path / "run" / "autopilot.sitl.ardupilot"
    assert (own / "eeprom.bin").is_file()
    assert (own / "output.txt").is_file()
    assert (tmp_path / "run" / "signals.csv").is_file()


def test_the_page_has_both_ways_to_start() -> None:
    assert [("ardupilot=" in c) for c in COMMANDS] == [True, False]
