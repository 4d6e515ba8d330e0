"""Local variables of FMUs as outputs of a rig and of packages."""

from __future__ import annotations

import csv
import math
import zipfile
from pathlib import Path

import pytest
from lxml import etree

from seatrial import Simulation
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.interchange.export import export_osp, export_ssp
from seatrial_kits.interchange.ssp.reading import read_ssp

from ..fmi.models import build_model_fmu
from ..kits.interchange.ssp_natives import component, connection, connector, elements, package, ssd

RIG = """
step = "0.1 s"
[components]
a = {{ fmu = "{fmu}", locals = {locals}, set = {{ k = 1.3 }}, interface = "model exchange" }}
b = {{ fmu = "{fmu}" }}
[connections]
"a.dx" = "b.u"
"""


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return one with x' = dx = -k x from 1, and y = 2 u."""
    return build_model_fmu(2, tmp_path_factory.mktemp("fmu"))


@pytest.fixture
def rig(fmu: Path, write) -> Path:
    return write("rig.toml", RIG.format(fmu=fmu, locals='["dx"]'))


def test_they_are_recorded_and_feed_inputs(rig: Path, write, tmp_path: Path) -> None:
    trial = write("t.toml", 'rig = "rig.toml"\nstop = "1 s"\n')
    folder = run_trial(load_trial(str(trial)), tmp_path / "run").folder
    with (folder / "signals.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 11
    for row in rows:
        slope = -1.3 * math.exp(-1.3 * float(row["time"]))
        assert float(row["a.dx"]) == pytest.approx(slope, abs=1e-6)
        assert float(row["b.y"]) == pytest.approx(2.0 * slope, abs=2e-6)


def test_without_the_key_they_are_none(fmu: Path, write) -> None:
    path = write("rig.toml", RIG.format(fmu=fmu, locals="[]"))
    with pytest.raises(InputError, match="dx"):
        Simulation(path, engine="fmu")


@pytest.mark.parametrize("name", ["dy", "x", "u"])
def test_what_is_no_local_variable_is_refused(fmu: Path, write, name: str) -> None:
    path = write("rig.toml", RIG.format(fmu=fmu, locals=f'["{name}"]'))
    message = rf"rig\.toml: components\.a\.fmu: .*\.fmu: locals: unknown local variable '{name}'"
    with pytest.raises(InputError, match=message):
        Simulation(path, engine="fmu")


def test_a_component_in_python_has_none(write) -> None:
    path = write("rig.toml", 'step = "1 ms"\ncomponents.c = { fmu = "compass", locals = ["x"] }\n')
    with pytest.raises(InputError, match="compass is a component in Python: the key 'locals' is"):
        Simulation(path)


def test_packages_read_and_write_them(rig: Path, tmp_path: Path) -> None:
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp", version="2.0")
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    kinds = {
        one.get("name"): one.get("kind")
        for one in root.iterfind(".//{*}Component[@name='a']/{*}Connectors/{*}Connector")
    }
    assert (kinds["dx"], kinds["x"]) == ("local", "output")
    read = read_ssp(path).rig
    assert read.components["a"].entry.locals == ["dx"]
    assert [*read.file.connections] == ["a.dx"]


def test_what_no_package_can_say_is_refused(rig: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a\.dx is a local variable, from which version 1\.0 of"):
        export_ssp(str(rig), tmp_path / "x.ssp")
    with pytest.raises(InputError, match=r"a\.dx is a local variable, from which OSP-IS has no"):
        export_osp(str(rig), tmp_path / "osp")
    assert list(tmp_path.glob("[xo]*")) == []


@pytest.mark.parametrize("declared", [True, False])
def test_a_connector_of_a_package_makes_them_outputs(fmu, tmp_path: Path, declared: bool) -> None:
    """A connection may name a variable without a connector too."""
    dx = [connector("dx", "local")] if declared else []
    inside = elements(
        component("a", connector("x", "output"), *dx, fmu="model"),
        component("b", connector("u", "input"), fmu="model"),
        connections=connection("a/dx", "b/u"),
    )
    members = {"resources/model.fmu": fmu.read_bytes()}
    path = package(tmp_path / "x.ssp", ssd(inside, version="2.0"), members)
    with Simulation(path, engine="fmu") as simulation:
        assert simulation.get("b.u") == simulation.get("a.dx")
