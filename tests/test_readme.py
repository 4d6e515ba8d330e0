"""The README word for word: its component, rig, trial and commands."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.command import Done, seatrial

pytestmark = pytest.mark.interop

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def block(after: str, language: str, number: int = 0) -> str:
    """Return the code block in ``language`` that follows the text ``after``."""
    text = README[README.index(after) :]
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)[number]


def run(line: str, folder: Path) -> Done:
    words = shlex.split(line.partition("#")[0].removeprefix("$ "))
    assert words[0] == "seatrial"
    return seatrial(*words[1:], cwd=folder)


def test_the_component_of_twenty_lines(tmp_path: Path) -> None:
    section = "## Write your own component"
    component = block(section, "python")
    assert len([line for line in component.splitlines() if line.strip()]) <= 20
    (tmp_path / "my_boat.py").write_text(component)
    (tmp_path / "pool.toml").write_text(block(section, "toml", 0))
    (tmp_path / "dash.toml").write_text(block(section, "toml", 1))
    for line in block(section, "console").splitlines():
        done = run(line, tmp_path)
        assert done.returncode == 0, done.stderr + done.stdout
    assert (tmp_path / "Boat.fmu").is_file()


TRIALS = block("## Run trials", "console").splitlines()[1:8]
LONG = ("seatrial run gloria-triangle", "seatrial run hydrone-pads", "seatrial campaign")
"""Minutes of sailing, seven cases, a hundred."""


@pytest.mark.parametrize(
    "line",
    [
        pytest.param(line, marks=pytest.mark.long if any(each in line for each in LONG) else ())
        for line in TRIALS
    ],
)
def test_commands_that_run_trials(line: str, tmp_path: Path) -> None:
    done = run(line, tmp_path)
    assert done.returncode in (0, 1), done.stderr
    assert "seatrial:" not in done.stderr  # nothing but progress


def test_commands_for_other_tools(tmp_path: Path) -> None:
    section = "## Use the FMUs in another tool"
    for line in block(section, "console").splitlines():
        done = run(line, tmp_path)
        assert done.returncode == 0, done.stderr
    script = block(section, "python") + "\nprint(len(result))\n"
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "101"


def test_links_lead_somewhere() -> None:
    for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text("utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"
