"""Terminals in what the FMU commands show and write."""

from __future__ import annotations

import contextlib
import re
import socket
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from seatrial.cli.fmu import fmu_app
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from tests.command import seatrial
from tests.fmi.boats import BARGE
from tests.fmi.native import changed
from tests.kit import needs_kits

LOOSE = re.sub(r"\n    terminals = {.*?\n    }\n", "\n", BARGE, flags=re.S)
"""The same without terminals."""


def shown(*arguments: str) -> str:
    done = CliRunner().invoke(fmu_app, list(arguments), env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    return done.output


@pytest.fixture
def barge(write, monkeypatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    write("barge.py", BARGE)
    write("loose.py", LOOSE.replace("Barge", "Loose"))


def test_a_component_and_its_fmu_show_the_same_terminals(barge: None) -> None:
    built = shown("build", "--osp", "barge.py:Barge", "loose.py:Loose")
    assert "Barge_OspModelDescription.xml" in built
    assert "note: Loose has no terminals" in built
    assert Path("Barge_OspModelDescription.xml").is_file()
    assert not Path("Loose_OspModelDescription.xml").exists()
    tables = [
        shown("describe", name).partition("terminal ")[2]
        for name in ("barge.py:Barge", "Barge.fmu")
    ]
    assert tables[0] == tables[1]
    rows = [line.split() for line in tables[0].splitlines()]
    assert ["wrench", "plug", "force", "force", "(3", "terms)", "input"] in rows
    assert ["heel", "attitude.phi", "output"] in rows


def test_terminals_that_an_fmu_could_have_are_a_rig(barge: None, write) -> None:
    shown("build", "loose.py:Loose")
    proposal = shown("describe", "Loose.fmu").partition("[components]")
    write("loose.toml", "".join(proposal[1:]))
    assert tomllib.loads("".join(proposal[1:]))["shows"] == {
        "motion": {"position": "Loose.position", "attitude": "Loose.attitude"},
        "reading": {"depth": "Loose.depth"},
    }
    write(
        "sea.toml",
        'step = "100 ms"\n[components]\nhull = { rig = "loose.toml" }\n'
        'gnss = { fmu = "gnss" }\n[connections]\n"hull.motion.position" = "gnss.position"\n',
    )
    system = assemble(load_rig("sea.toml"))
    system.free()
    assert {c.source for c in system.connections} == {
        ("hull.Loose", f"position.{axis}") for axis in "xyz"
    }


def test_names_in_any_case_and_other_units_are_proposed(
    native_fmu, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    replaced = (('name="echo"', 'name="Wind_Speed"'), ('name="x"', 'name="Depth"'))
    pressure = ('name="y" valueReference="8" causality="output"><Real/>',
                'name="pressure" valueReference="8" causality="output"><Real unit="deg"/>')  # fmt: skip
    changed(native_fmu("fmi2"), tmp_path / "my boat.fmu", *replaced, pressure)
    assert shown("describe", "my boat.fmu").endswith(
        'reading = { wind_speed = "my_boat.Wind_Speed", depth = "my_boat.Depth" }\n'
    )


def test_a_file_without_a_class_is_answered_with_its_classes(tmp_path: Path) -> None:
    (tmp_path / "boat.py").write_text("class Hull(Plant):\n    pass\n\n\nclass Plain:\n    pass\n")
    (tmp_path / "empty.py").write_text("x = 1\n")
    done = seatrial("fmu", "build", "boat.py", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "seatrial: boat.py: a class is needed: boat.py:Hull\n"
    done = seatrial("fmu", "build", "empty.py", cwd=tmp_path)
    assert "a class is needed, as in empty.py:Boat, and the file has none" in done.stderr
    done = seatrial("fmu", "build", "none.py", cwd=tmp_path)
    assert f"none.py: there is no file {tmp_path / 'none.py'}" in done.stderr


@needs_kits("can", "mavlink")
def test_a_check_opens_no_link(tmp_path: Path) -> None:
    """The gateway's own port is in use: by another run, or somebody else."""
    with socket.socket() as other:
        with contextlib.suppress(OSError):  # somebody has it already
            other.bind(("127.0.0.1", 29536))
            other.listen()
        done = seatrial("fmu", "check", "can-gateway", "mavlink", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "can-gateway: not run, since it would open its links" in done.stdout + done.stderr
    assert done.stdout.count("no problem found") == 2
