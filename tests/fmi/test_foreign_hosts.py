"""Exported FMUs of every kind in hosts that unpack them anywhere, and call them wrongly."""

from __future__ import annotations

import importlib.util
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import pytest
from typer.testing import CliRunner

from seatrial.cli.fmu import fmu_app
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.compiler import HERE, library_here
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.native.standalone.export import build_standalone_fmu
from tests.command import seatrial

from .conftest import source

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

HOST = Path(__file__).with_name("misbehaving_host.py")
ODD = "Bäu (β) 50% #1 + x"
TANK = '''
"""A tank."""
from seatrial.model.component import Component, Input, Output, Parameter


class Tank(Component):
    """Fills."""

    flow = Input("m3/s", "into it")
    area = Parameter(2.0, "m2", "of its surface")
    label = Parameter("water", "1", "what is written on it")
    level = Output("m", "of what is in it")

    def start(self, t):
        self.volume = 0.0

    def step(self, t, h):
        self.volume += self.flow * h

    def outputs(self, t):
        self.level = self.volume / self.area


class Talker(Component):
    """Says the time, in a text that C does not have."""

    said = Output("1", "the time", type=str)

    def outputs(self, t):
        self.said = str(t)
'''
RIG = """\
step = "10 ms"
[components]
tank = { fmu = "tank.py:Tank" }
"""
LEVELS = [0.3 * 0.01 * k / 2.0 for k in range(1, 21)]

STEP = "the step is"
TIME = "the step begins at"
PYTHON = {
    "step before": "x: fmi{}DoStep: not allowed before the initialisation",
    "exit before": "x: fmi{}ExitInitializationMode: not allowed before the initialisation",
    "step within": "x: fmi{}DoStep: not allowed during the initialisation",
    "get unknown": "x: there is no variable with value reference 99999",
    "set unknown": "x: there is no variable with value reference 99999",
    "get a text as a number": "label is of type str, not float",
    "set output": "level is an output",
    "set fixed": "area is a fixed parameter",
    "set nan": "flow: nan is not a finite number",
    "step -0.01": f"x: fmi{{}}DoStep: {STEP} -0.01 s, allowed are finite ones greater than 0 s",
    "step 0.0": f"x: fmi{{}}DoStep: {STEP} 0 s",
    "step nan": f"x: fmi{{}}DoStep: {STEP} nan s",
    "step inf": f"x: fmi{{}}DoStep: {STEP} inf s",
    "time 1.0": f"x: fmi{{}}DoStep: {TIME} 1.07 s, but 0.07 s was reached",
    "time -0.01": f"x: fmi{{}}DoStep: {TIME} 0.06 s, but 0.07 s was reached",
    "time nan": f"x: fmi{{}}DoStep: {TIME} nan s",
    "enter again": "x: fmi{}EnterInitializationMode: not allowed once the initialisation has ended",
    "half state": "the state has",
    "empty state": "0 bytes are no state",
    "longer state": "the state has",
    "changed state": "their hash differs",
    "other state": "are no state of this FMU",
    "text state": "80 bytes are no state of this FMU",
    "no state": "there is no state",
    "step after": "x: fmi{}DoStep: not allowed once the run has been terminated",
    "set after": "not allowed once the run has been terminated",
    "terminate again": "x: fmi{}Terminate: not allowed once the run has been terminated",
    "get of none": "",
    "step of none": "",
}
NO_STEP = "no step from"
NATIVE = {
    "step before": NO_STEP,
    "exit before": "x: fmi{}ExitInitializationMode: not allowed before the initialisation",
    "enter again": "x: fmi{}EnterInitializationMode: not allowed once the initialisation has ended",
    "step within": NO_STEP,
    "get unknown": "there is no Real with value reference",
    "set unknown": "there is no Real with value reference",
    "get a text as a number": "there is no Real with value reference",
    "set output": "is an output and cannot be set",
    "set fixed": "is a fixed parameter",
    "set nan": "is not a finite number",
    **{f"step {h}": NO_STEP for h in ("-0.01", "0.0", "nan", "inf")},
    "time 1.0": f"{TIME} 1.07 s, but 0.07 s was reached",
    "time -0.01": f"{TIME} 0.06 s, but 0.07 s was reached",
    "time nan": NO_STEP,
    **{name: text for name, text in PYTHON.items() if name.endswith(" state")},
    "step after": NO_STEP,
}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what builds the FMU of a tank once, by its kind."""
    folder = tmp_path_factory.mktemp("kinds")
    (folder / "tank.py").write_text(TANK, "utf-8")
    (folder / "native-rig.toml").write_text(RIG, "utf-8")
    talking = RIG + 'talker = { fmu = "tank.py:Talker" }\n'
    (folder / "python-rig.toml").write_text(talking, "utf-8")
    tank = source(folder / "tank.py", "Tank")

    @cache
    def build(kind: str) -> Path:
        carrier, version = kind.split()
        path = folder / carrier / f"FMI{version}" / "tank.fmu"
        if carrier == "python":
            build_fmu(tank, path, None, int(version), (HERE,), library_here)
        elif carrier == "native":
            build_native_fmu(tank, path, (HERE,), None, library_here, int(version))
        elif carrier == "standalone":
            build_standalone_fmu(tank, path, version=int(version))
        else:
            command = ["fmu", "build", "--rig", f"{carrier}.toml", "--fmi", version]
            done = seatrial(*command, "--out", path.parent.name, cwd=folder)
            assert done.returncode == 0, done.stderr
            return folder / path.parent.name / f"{carrier}.fmu"
        return path

    return build


def _hosted(path: Path, folder: Path, *arguments: str) -> Any:
    command = [sys.executable, str(HOST), str(path), str(folder), *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", ["python 2", "python 3", "native 2", "native 3"])
def test_what_fmi_does_not_allow_is_refused_and_does_no_harm(
    kind: str, built: Callable[[str], Path], tmp_path: Path
) -> None:
    """Below a folder of any name; the levels are those of a closed form."""
    state, below = str(tmp_path / "state"), tmp_path / ODD
    others = [f"{'native' if kind[0] == 'p' else 'python'} {kind[-1]}", kind]
    other, path = (built(each) for each in others)
    levels, _ = _hosted(other, below / "other", state)
    assert levels == pytest.approx(LEVELS, rel=1e-12)
    levels, answers = _hosted(path, below / "it", state, "refused")
    assert levels == pytest.approx(LEVELS, rel=1e-12)
    expected = PYTHON if kind.startswith("python") else NATIVE
    for what, text in expected.items():
        text = text.format(kind[-1])
        answer, messages = answers.pop(what)
        assert "failed with status 3 (error)" in answer, what
        assert any(text in message for message in messages) == bool(text), (what, messages)
    assert not answers


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind",
    [
        *("native-rig 2", "native-rig 3", "python-rig 2", "python-rig 3", "standalone 2"),
        pytest.param("standalone 3", marks=pytest.mark.long),
    ],
)
def test_it_runs_unpacked_anywhere(kind: str, built: Callable[[str], Path], tmp_path: Path) -> None:
    path = built(kind)
    names = {v.name for v in fmpy.read_model_description(str(path)).modelVariables}
    assert any(name.endswith("level") for name in names)
    folder = tmp_path / ODD / "it"
    fmpy.extract(str(path), str(folder))
    script = (
        "import sys, fmpy; r = fmpy.simulate_fmu(sys.argv[1], stop_time=0.2, output_interval=0.01); "
        "print(len(r))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(folder)], capture_output=True, text=True
    )
    assert (done.returncode, done.stdout.strip()) == (0, "21"), done.stderr


def test_without_a_compiler_it_is_built_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "tank.py").write_text(TANK, "utf-8")
    found = importlib.util.find_spec
    hidden = {"ziglang"}
    monkeypatch.setattr(importlib.util, "find_spec", lambda n: None if n in hidden else found(n))
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(fmu_app, ["build", "tank.py:Tank"])
    assert done.exit_code == 0, done.output
    said = " ".join(done.output.split())
    assert "do not check what their host does" in said
    assert "need a compiler to build: pip install 'seatrial[native]'" in said
    levels, _ = _hosted(tmp_path / "Tank.fmu", tmp_path / "plain", str(tmp_path / "state"))
    assert levels == pytest.approx(LEVELS, rel=1e-12)
