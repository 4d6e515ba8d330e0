"""The commands of docs/kits/px4/px4.md, as they are there, with a stand-in for the firmware."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

from tests.command import seatrial

from .test_assembly import NAME, ROOT, at, instance, program  # noqa: F401  a fixture

PAGE = (ROOT / "docs/kits/px4/px4.md").read_text("utf-8")
COMMANDS = re.findall(r"^\$ (seatrial .*)$", PAGE, re.MULTILINE)
SQUARE, STARTED, WAITS = COMMANDS


def test_the_page_has_both_ways_to_start() -> None:
    assert " square " in SQUARE
    assert [("px4=" in each) for each in COMMANDS] == [True, True, False]


@pytest.mark.slow
def test_what_the_page_says_runs(program: Path, tmp_path: Path) -> None:  # noqa: F811
    shutil.copytree(program.parents[1], tmp_path / "build" / "px4_sitl_default")
    quick = ("--set", "stop=2 s", "--set", f"{NAME}.speedup=100", *at(instance()))
    done = seatrial(*shlex.split(STARTED)[1:], *quick, "--out", "run", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "run" / NAME / "output.txt").is_file()
    assert list((tmp_path / "run" / NAME / "log").glob("*/*.ulg"))


@pytest.mark.parametrize("file", sorted(set(re.findall(r"`(hil_profiles/\S+\.px4)`", PAGE))))
def test_files_that_the_page_names_are_there(file: str) -> None:
    assert (ROOT / file).is_file()
