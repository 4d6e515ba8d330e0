"""An FMU in a host without Python: a C program, with libpython preloaded."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fmpy import extract, read_model_description

from seatrial.cli.doctor import preload_line
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import shipped_sources
from seatrial.fmi.direct import DirectInstance

STEPS, H, FORCE = 50, 0.01, 40.0


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler = shutil.which("cc")
    assert compiler, "a C compiler is needed: on Debian, apt install gcc"
    program = tmp_path_factory.mktemp("host") / "host"
    source = Path(__file__).with_name("host.c")
    flags = ["-std=c11", "-D_DEFAULT_SOURCE", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([compiler, *flags, str(source), "-o", str(program), "-ldl"], check=True)
    return program


def test_a_c_program_steps_a_plant_like_we_do(host: Path, tmp_path: Path) -> None:
    source = shipped_sources()["marine-craft"]
    path = build_fmu(source, tmp_path / "craft.fmu", {"mass": 20.0, "inertia": [3, 2, 5, 0, 0, 0]})
    description = read_model_description(str(path))
    folder = Path(extract(str(path), str(tmp_path / "craft")))
    vr = {v.name: str(v.valueReference) for v in description.modelVariables}
    outputs = ["position.x", "velocity.u", "acceleration.x"]
    identifier = description.coSimulation.modelIdentifier
    command = [
        str(host), str(folder / "binaries" / "linux64" / f"{identifier}.so"), description.guid,
        (folder / "resources").as_uri(), str(STEPS), str(H), vr["force_1.x"], str(FORCE),
        *(vr[name] for name in outputs),
    ]  # fmt: skip
    # The line that `seatrial doctor` prints is what is tested.
    preload = dict(item.split("=", 1) for item in shlex.split(preload_line()))
    environment = {**os.environ, **preload}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    lives = [[float(x) for x in line.split()] for line in done.stdout.splitlines()]
    instance = DirectInstance(source.component_class()("craft"))
    instance.set_start({"mass": 20.0, "inertia.xx": 3.0, "inertia.yy": 2.0, "inertia.zz": 5.0})
    instance.initialise(0.0, 1.0)
    instance.begin()
    instance.writer(["force_1.x"])([FORCE])
    for k in range(STEPS):
        instance.step(k * H, H)
    expected = instance.reader(outputs)()
    assert lives == [expected, expected]
    # and against the closed form: a free mass of 20 kg under 40 N for half a second
    assert expected == pytest.approx([0.25, 1.0, 2.0], rel=1e-12)


def test_without_the_preload_there_is_a_message(host: Path, tmp_path: Path) -> None:
    path = build_fmu(shipped_sources()["servo"], tmp_path / "servo.fmu")
    folder = Path(extract(str(path), str(tmp_path / "servo")))
    library = folder / "binaries" / "linux64" / "servo.so"
    resources = (folder / "resources").as_uri()
    command = [str(host), str(library), "guid", resources, "1", "0.01", "0", "0", "0"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert "undefined symbol" in done.stderr
    assert sys.version_info >= (3, 11)
