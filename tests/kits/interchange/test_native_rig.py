"""Rigs of FMUs in C: tables on connections, calculated parameters, start values of states."""

from __future__ import annotations

import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest

from seatrial.errors import InputError
from seatrial.sim.actions import action
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from ...fmi.native import SLAVES
from .ssp_natives import build

RIG = """
step = "10 ms"
[components]
a = {{ fmu = "calc.fmu", set = {{ i = 3, u = 2.0, x = 5.0 }} }}
b = {{ fmu = "two.fmu" }}
[connections]
{}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("rig")
    for name, data in build(found / "slaves").items():
        (found / Path(name).name).write_bytes(data)
    return found


@pytest.fixture
def started(folder: Path):
    systems = []

    def start(connections: str) -> Master:
        (folder / "rig.toml").write_text(RIG.format(connections), "utf-8")
        systems.append(assemble(load_rig(str(folder / "rig.toml"))))
        master = Master(systems[-1])
        master.initialise()
        return master

    yield start
    for system in systems:
        system.free()


def test_a_connection_maps_integers_by_pairs(started) -> None:
    master = started('"a.j" = { to = "b.i", mapping = [[6, -1], [2, 3]] }')
    assert master.values("b", ["i", "j"]) == [-1, -2]


def test_a_calculated_parameter_feeds_a_fixed_one_and_stays(started) -> None:
    master = started('"a.y" = { to = "b.k", factor = 2.0 }')
    assert master.values("b", ["k"]) == [8.0]
    assert master.values("a", ["x"]) == [5.0]  # a state starts from what is set
    for kind in ("set", "override"):
        with pytest.raises(InputError, match=r"b\.k (is fed by|has its value from the start)"):
            action(master.system, kind, "b.k", 1.0, "test")


@pytest.mark.parametrize(
    ("connection", "reason"),
    [
        ('"a.j" = { to = "b.i", mapping = [[6]] }', "pairs of integers are needed, found [6]"),
        ('"a.j" = { to = "b.i", mapping = [[true, 1]] }', "pairs of integers are needed"),
        ('"a.j" = { to = "b.i", mapping = [[1, 2], [1, 3]] }', "1 is mapped twice"),
        ('"a.x" = { to = "b.u", mapping = [[1, 2]] }', "it is a number"),
        ('"a.x" = "b.k"', "b.k is fixed parameter, input or tunable parameter is needed"),
    ],
)
def test_mistakes_are_named(connection: str, reason: str, started) -> None:
    with pytest.raises(InputError) as caught:
        started(connection)
    assert reason in str(caught.value)


def test_parameters_that_an_fmu_loses_on_its_way_are_given_again(tmp_path: Path) -> None:
    # 20-sim's FMUs, such as the crane of libcosim's demo, return to their own start values.
    source = (SLAVES / "fmi2.c").read_text("utf-8")
    entering = "fmi2EnterInitializationMode(fmi2Component c) {\n    Slave *s = c;\n"
    assert entering in source
    lossy = source.replace(entering, f"{entering}    s->real[K] = 1.0; s->real[GAIN] = 2.0;\n")
    (tmp_path / "fmi2.c").write_text(lossy, "utf-8")
    headers = Path(fmpy.__file__).parent / "c-code"
    library = tmp_path / "fmi2.so"
    subprocess.run(
        ["cc", "-shared", "-fPIC", "-w", f"-I{headers}", tmp_path / "fmi2.c", "-o", library, "-lm"],
        check=True,
    )
    with zipfile.ZipFile(tmp_path / "two.fmu", "w") as archive:
        archive.write(SLAVES / "fmi2.xml", "modelDescription.xml")
        archive.write(library, f"binaries/{fmpy.platform}/fmi2.so")
    rig = 'step = "10 ms"\n[components]\na = { fmu = "two.fmu", set = { k = 3.0, u = 1.0 } }\n'
    (tmp_path / "rig.toml").write_text(rig, "utf-8")
    system = assemble(load_rig(str(tmp_path / "rig.toml")))
    try:
        master = Master(system)
        master.initialise()
        assert master.values("a", ["k", "gain", "y"]) == [3.0, 2.0, 2.0]
    finally:
        system.free()
