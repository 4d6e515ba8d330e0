"""Kits: found by entry points, read from manifests, left out with a reason."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from pkgutil import resolve_name

import pytest

from seatrial import kits as of_kits
from seatrial.cli.commands import commands, loaded
from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class, components
from seatrial.kits import KINDS, kits, lacking, read_kit
from seatrial.moved import MOVED
from seatrial.plugins import offered, service
from seatrial.shipped import provided_place
from seatrial.trial.logs.formats import Format
from tests.kit import needs_kits
from tests.packages import installed

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
OWN = sorted(path.parent.name for path in (ROOT / "src/seatrial_kits").glob("*/kit.toml"))
SONAR = 'title = "Sonars"\napi = 1\n'


@pytest.fixture
def kit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """Return a function that installs a kit, and returns its folder."""

    def install(name: str, manifest: str, package: str = "") -> Path:
        site = tmp_path / f"site_{name}"
        installed(site, f"{name}_dist", {"seatrial.kits": {name: package or f"{name}_kit"}})
        folder = site / f"{name}_kit"
        folder.mkdir()
        (folder / "__init__.py").write_text('raise AssertionError("imported")\n')
        (folder / "kit.toml").write_text(manifest)
        monkeypatch.syspath_prepend(site)
        return folder

    return install


def test_every_kit_of_this_distribution_has_its_entry_point() -> None:
    points = PROJECT["project"]["entry-points"]["seatrial.kits"]
    assert points == {name: f"seatrial_kits.{name}" for name in OWN}
    assert {kit.name for kit in kits().found} >= set(OWN)
    assert not kits().left_out


def test_every_part_of_a_kit_is_there() -> None:
    for kit in kits().found:
        for kind, entries in kit.entries.items():
            assert kind in KINDS
            for entry in entries:
                part = resolve_name(entry.target)
                assert callable(part) or isinstance(part, Format), entry


(CONTRACT,) = [
    c for c in PROJECT["tool"]["importlinter"]["contracts"] if c["type"] == "independence"
]


@needs_kits(*(module.rpartition(".")[2] for module in CONTRACT["modules"]))
def test_the_contract_has_what_the_manifests_need() -> None:
    needed = {
        f"seatrial_kits.{kit.name}.** -> seatrial_kits.{each}.**"
        for kit in kits().found
        for each in kit.needs
        if kit.name in OWN
    }
    assert set(CONTRACT["ignore_imports"]) == needed
    assert CONTRACT["modules"] == [f"seatrial_kits.{name}" for name in OWN]


def test_a_kit_is_found_and_not_imported(kit: Callable[..., Path], tmp_path: Path) -> None:
    manifest = (
        '[components]\nsonar = { class = "sonar_kit.sonar:Sonar", title = "A sonar" }\n'
        '[commands]\nsweep = { call = "sonar_kit.command:sweep", help = "Sweep." }\n'
        '[services]\n"sonar.sweep" = "math:tau"\n'
    )
    folder = kit("sonar", SONAR + manifest)
    assert "sonar" in components().names()
    assert commands()["sweep"].place == "sonar_kit.command:sweep"
    assert service("sonar.sweep") == pytest.approx(6.283185307179586)
    (folder / "content" / "trials").mkdir(parents=True)
    trial = folder / "content" / "trials" / "sonar-sweep.toml"
    trial.write_text("")
    place = provided_place("harness/trials", "sonar-sweep")
    assert place is not None
    assert place.path == trial


def test_a_name_of_two_kits_is_refused(kit: Callable[..., Path]) -> None:
    manifest = '[components]\ncompass = { class = "a:B", title = "Another" }\n'
    folder = kit("sonar", SONAR + manifest)
    with pytest.raises(InputError, match=r"from seatrial itself .* and from the kit sonar"):
        component_class("compass")
    (folder / "content" / "vehicles").mkdir(parents=True)
    (folder / "content" / "vehicles" / "otter.toml").write_text("")
    with pytest.raises(
        InputError, match=r"'otter' is ambiguous: .*otter\.toml and .*otter.vehicle\.toml"
    ):
        provided_place("vehicles", "otter")


def test_a_command_of_two_is_refused(kit: Callable[..., Path]) -> None:
    kit("sonar", SONAR + '[commands]\nrun = { call = "a:b", help = "Run." }\n')
    with pytest.raises(
        InputError, match=r"the command 'run' is seatrial\.cli\.running\.run:run and, of the"
    ):
        loaded("run")
    assert loaded("doctor").name == "doctor"


@pytest.mark.parametrize(
    ("manifest", "why"),
    [
        ('title = "T"\napi = 2\n', r"api = 2, this seatrial has kits of api = 1"),
        ('title = "T"\n', r"api = None, this seatrial has kits of api = 1"),
        ("api = 1\n", r"title: a text is needed, found None"),
        (SONAR + "[component]\n", r"unknown key 'component'; did you mean 'components'\?"),
        (SONAR + 'needs = "can"\n', r"needs: names of kits are needed, found 'can'"),
        (SONAR + 'needs = ["lidar"]\n', r"it needs the kit lidar, which is not there"),
        (
            SONAR + '[components]\nx = "a:B"\n',
            r'components\.x: \{ class = "\.\.\.", title = "\.\.\."',
        ),
        (SONAR + '[algorithms]\nx = "no place"\n', r"algorithms\.x: 'module:attribute' is needed"),
        ("title =\n", r"not TOML"),
        (SONAR + 'commands = "sweep"\n', r"commands: a table is needed, found 'sweep'"),
        (SONAR + "libraries = 1\n", r"libraries: a table of texts is needed, found 1"),
    ],
)
def test_a_kit_that_cannot_be_used_is_left_out_and_named(
    kit: Callable[..., Path], manifest: str, why: str
) -> None:
    kit("sonar", manifest)
    assert "sonar" not in {one.name for one in kits().found}
    assert re.search(why, kits().left_out["sonar"])
    with pytest.raises(
        InputError, match=rf"(?s)unknown FMU 'sonar'.*the kit sonar is left out: .*{why}"
    ):
        components().target("sonar")
    assert offered("sonar.sweep") is None
    with pytest.raises(InputError, match=r"needs the kit 'sonar', which is not installed; the kit"):
        service("sonar.sweep")


def test_what_needs_a_kit_that_is_left_out_is_left_out(kit: Callable[..., Path]) -> None:
    kit("array", SONAR + 'needs = ["sonar"]\n')
    kit("sonar", SONAR + 'needs = ["lidar"]\n')
    assert kits().left_out == {
        "array": "it needs the kit sonar, which is not there",
        "sonar": "it needs the kit lidar, which is not there",
    }


@pytest.mark.slow
def test_the_entry_point_of_a_removed_kit_is_no_error(
    kit: Callable[..., Path], tmp_path: Path
) -> None:
    kit("sonar", SONAR, package="seatrial_kits.sonar")
    assert "its package seatrial_kits.sonar is not there" in kits().left_out["sonar"]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site_sonar")}
    command = [sys.executable, "-c", "from seatrial.cli import main; main()", "doctor"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "kits: sonar is left out: its package seatrial_kits.sonar is not" in done.stdout


@needs_kits("gprs")
def test_a_kit_without_metadata_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from seatrial.cli.doctor import kits_here

    known = kits()
    rest = tuple(kit for kit in known.found if kit.name != "gprs")
    monkeypatch.setattr("seatrial.cli.doctor.kits", lambda: of_kits.Kits(rest, {}))
    good, text = kits_here()
    assert not good
    assert text == "gprs is new: install seatrial again for its entry point"


def test_a_manifest_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"kit\.toml: No such file"):
        read_kit("x", tmp_path)


@pytest.mark.slow
@needs_kits("can", "mavlink", "native", "search")
def test_old_import_paths_are_the_same_modules() -> None:
    modules = "\n".join(
        f"import importlib\nassert importlib.import_module({f'seatrial.{old}'!r}) is "
        f"importlib.import_module({new!r})"
        for old, new in MOVED.items()
    )
    code = f"import warnings\nwarnings.simplefilter('ignore')\n{modules}\n"
    code += "warnings.simplefilter('error')\nimport seatrial.links.can.component\n"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "DeprecationWarning: seatrial.links.can.component is seatrial_kits.can" in done.stderr


def test_a_library_that_lacks_a_shared_library_is_no_error_of_ours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The interpreter's own error, of an extension module that the loader refuses."""
    package = tmp_path / "pygraphviz"
    package.mkdir()
    (package / "__init__.py").write_text("from ._graphviz import *")
    (package / "_graphviz.abi3.so").write_bytes(b"\x7fELF cut short")
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in [name for name in sys.modules if name.split(".")[0] == "pygraphviz"]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.raises(ImportError) as refused:
        importlib.import_module("pygraphviz")
    said = lacking(refused.value)
    assert said is not None
    assert said.startswith("pygraphviz is installed and does not load: ")
    assert "apt install libglib2.0-0" in said
