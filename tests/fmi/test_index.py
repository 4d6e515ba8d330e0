"""Components by name: the index, and those that installed packages add."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.fmi.components import index
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.components.source import shipped_sources
from seatrial.model.component import Component
from tests.packages import installed

SENSOR = '''
"""Echo sounders of a maker."""

from acme_scale import SCALE
from seatrial.model.component import Component, Input, Output, Parameter


class Sounder(Component):
    """Depth in units of its own."""

    scale = Parameter(2.0, "1", "units in a metre", min=0.1)
    depth = Input("m", "true depth")
    reading = Output("1", "what it shows")
    feedthrough = {"reading": ("depth",)}

    def outputs(self, t):
        self.reading = self.scale * self.depth * SCALE
'''

RIG = """
step = "100 ms"
profile = "boat.toml"
[components]
sounder = { fmu = "acme-sounder", profile = "sensors.sounder", set = { depth = "3 m" } }
"""
TRIAL = 'rig = "rig.toml"\nstop = "1 s"\n[[criteria]]\nname = "reads"\ncheck = "sounder.reading > 14.9"\n'

PROFILE = """
title = "A boat"
[identity]
system_id = 1
component_id = 1
vehicle_type = "surface_boat"
autopilot_type = "px4"
firmware_version = "1.0.0"
uid = 1
[home]
latitude = "0 deg"
longitude = "0 deg"
altitude = "0 m"
date = 2026-01-01
source = "test"
[sensors.sounder]
kind = "acme-sounder"
scale = SCALE
source = "data sheet"
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Return a folder with an installed package ``acme`` that adds a component."""
    folder = tmp_path / "site"
    (folder / "acme").mkdir(parents=True)
    target = "acme.sounders:Sounder"
    installed(
        folder, "acme_scale", {"seatrial.components": {"acme-sounder": target}}, "SCALE = 1.0\n"
    )
    (folder / "acme/__init__.py").write_text('"""Acme."""\n')
    (folder / "acme/sounders.py").write_text(SENSOR)
    return folder


def seatrial(site: Path, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(site), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", "from seatrial.cli import main; main()", *arguments]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "trial.toml").write_text(TRIAL)
    (tmp_path / "boat.toml").write_text(PROFILE.replace("SCALE", "5.0"))
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_a_packages_component_runs_in_a_rig_with_its_profile(
    engine: str, site: Path, folder: Path
) -> None:
    done = seatrial(site, "run", "trial.toml", "--engine", engine, "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert (folder / "out/signals.csv").read_text().splitlines()[-1].endswith(",15.0")


@pytest.mark.slow
def test_its_fmu_carries_its_package(site: Path, folder: Path) -> None:
    assert "acme-sounder" in seatrial(site, "fmu", "list", cwd=folder).stdout
    done = seatrial(site, "fmu", "build", "acme-sounder", "--out", "built", cwd=folder)
    assert done.returncode == 0, done.stderr
    built = folder / "built/acme-sounder.fmu"

    with zipfile.ZipFile(built) as archive:
        names = archive.namelist()
        needed = archive.read("resources/requirements.txt").decode()
    assert any(name.endswith("/acme/sounders.py") for name in names)
    assert "acme_scale" in needed  # a package of its own: named, for the target to install


def test_a_profile_names_what_its_sensor_refuses(site: Path, folder: Path) -> None:
    (folder / "boat.toml").write_text(PROFILE.replace("SCALE", "0.01"))
    done = seatrial(site, "profile", "check", "./boat.toml", cwd=folder)
    assert done.returncode == 2
    assert "boat.toml: sensors.sounder.scale: at least 0.1" in done.stderr


def test_every_shipped_name_is_a_component_with_a_title() -> None:
    assert len(components().shipped) >= 30
    for name, source in shipped_sources().items():
        assert issubclass(component_class(name), Component)
        assert source.title
        assert source.title[0].isupper() or source.title[0].isdigit() or name == source.title


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("boat = {", "index.toml: "),
        ('boat = { class = "a:B" }', "boat: "),
        ('boat = { class = "nowhere", title = "x" }', "'module:Class' needed, found 'nowhere'"),
        ('boat = { class = "a b:C", title = "x" }', "'module:Class' needed"),
    ],
)
def test_mistakes_in_the_index_are_named(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "index.toml").write_text(text)
    monkeypatch.setattr(index, "shipped_folder", lambda _: tmp_path)
    index._index.cache_clear()
    index.components.cache_clear()
    try:
        with pytest.raises(InputError, match=message):
            components()
    finally:
        index._index.cache_clear()
        index.components.cache_clear()
