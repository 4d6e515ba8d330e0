"""Imports of commands: a run costs what it uses."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.main import get_command

from seatrial.cli.commands import commands, loaded
from seatrial.cli.main import app

HEAVY = {
    "can", "cantools", "casadi", "dronecan", "fmpy", "jinja2", "lark", "lxml", "nmea2000", "numpy",
    "pint", "plotly", "pydantic", "pymavlink", "pythonfmu", "scipy",
}  # fmt: skip
PROGRAM = """
import json, sys
from seatrial.cli import main
try:
    main()
except SystemExit:
    pass
print(json.dumps(sorted({name.partition(".")[0] for name in sys.modules})), file=sys.stderr)
"""


def imported(*arguments: str, cwd: Path) -> set[str]:
    """Return the packages that a command imports."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout
    return set(json.loads(done.stderr.splitlines()[-1])) & HEAVY


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_help_and_version_import_nothing_heavy(option: str, tmp_path: Path) -> None:
    assert imported(option, cwd=tmp_path) == set()


def test_the_listing_imports_no_component(tmp_path: Path) -> None:
    assert imported("list", cwd=tmp_path) <= {"numpy", "pydantic"}  # typer imports the latter


RUN = ("run", "hydrone-open-landing", "--set", "stop=0.1 s", "--out", "run")
OFTEN = {"jinja2", "lark", "numpy", "pydantic"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "own"), [("direct", {"casadi"}), ("fmu", {"casadi", "fmpy", "lxml", "pythonfmu"})]
)
def test_a_run_imports_what_it_uses(engine: str, own: set[str], tmp_path: Path) -> None:
    """Without other people's links, the registry of units and a plotting library."""
    found = imported(*RUN, "--engine", engine, cwd=tmp_path)
    assert found > OFTEN
    assert found <= OFTEN | own | {"pythonfmu"}
    assert (tmp_path / "run" / "report.html").is_file()


@pytest.mark.parametrize("name", sorted(commands()))
def test_the_listing_says_what_the_command_says(name: str) -> None:
    listed = get_command(app).commands[name].help  # type: ignore[attr-defined]
    said = (loaded(name).help or "").partition("\n")[0]
    assert listed == said == commands()[name].help
