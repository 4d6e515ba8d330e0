"""FMUs that allow one instance for each process: each further one has a process of its own.

The slaves here are made so that all instances in a process are one, in memory that keeps what a run
has left in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from seatrial import Simulation
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.system.assembling.assembly import assemble
from seatrial_kits.interchange.osp.reading import read_osp
from seatrial_kits.interchange.ssp.reading import read_ssp

from ..kits.interchange.osp_files import HEAD
from ..kits.interchange.ssp_natives import component, elements, package, ssd
from .models import build_model_fmu
from .native import sharing

KINDS = ("fmi1", "fmi2", "fmi3")
_DECAYS = """
step = "100 ms"
[components]
a = {{ fmu = "{fmu}" }}
b = {{ fmu = "{fmu}", set = {{ k = 2.0 }} }}
c = {{ fmu = "{fmu}", set = {{ k = 3.0 }} }}
"""


@pytest.fixture
def only(native_fmu, tmp_path: Path):
    """Return a function that makes a slave for one instance per process."""

    def make(kind: str) -> Path:
        to = tmp_path / f"only-{kind}.fmu"
        if kind == "fmi1":
            path = build_model_fmu(1, tmp_path, "co-simulation")
            flag = 'canHandleVariableCommunicationStepSize="true"'
            return sharing(path, to, flag, "model.c", "-DFMI=1")
        word = "State" if kind == "fmi3" else "state"
        flag = f'canGetAndSetFMU{word}="true"'
        return sharing(native_fmu(kind), to, flag, f"{kind}.c")

    return make


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_three_in_a_rig_are_three(kind: str, only, write) -> None:
    with Simulation(write("rig.toml", _DECAYS.format(fmu=only(kind))), engine="fmu") as simulation:
        simulation.run(1.0)
        found = [simulation.get(f"{name}.x") for name in "abc"]
    assert found == pytest.approx([math.exp(-k) for k in (1, 2, 3)], rel=1e-12)


@pytest.mark.slow
def test_a_run_finds_nothing_that_another_in_this_process_has_left(only, write) -> None:
    rig = write("rig.toml", f'step = "100 ms"\n[components]\na = {{ fmu = "{only("fmi2")}" }}\n')
    gains = []
    for settings in ({"a.q[1]": 3.0}, {}):
        with Simulation(rig, engine="fmu", set=settings) as simulation:
            simulation.run(0.5)
            gains.append((simulation.get("a.p[1]"), simulation.get("a.x")))
    assert gains[0][0] == 2 * 3.0
    assert gains[1] == (0.0, pytest.approx(math.exp(-0.5), rel=1e-12))


@pytest.mark.slow
def test_those_in_rigs_within_a_rig_are_isolated_too(only, write) -> None:
    fmu = only("fmi2")
    write("inner.toml", f'step = "100 ms"\n[components]\na = {{ fmu = "{fmu}" }}\n')
    outer = '[components]\none = { rig = "inner.toml" }\ntwo = { rig = "inner.toml" }\n'
    rig = write("outer.toml", f'step = "100 ms"\n{outer}')
    with Simulation(rig, engine="fmu", set={"two.a.k": 2.0}) as simulation:
        simulation.run(1.0)
        found = [simulation.get("one.a.x"), simulation.get("two.a.x")]
    assert found == pytest.approx([math.exp(-1), math.exp(-2)], rel=1e-12)


def _packages(fmu: Path, folder: Path) -> Iterator:
    inside = elements(component("a", fmu="only"), component("b", fmu="only"))
    path = package(folder / "x.ssp", ssd(inside), {"resources/only.fmu": fmu.read_bytes()})
    yield read_ssp(path)
    simulators = "".join(f'<Simulator name="{name}" source="{fmu.name}"/>' for name in "ab")
    structure = folder / "OspSystemStructure.xml"
    structure.write_text(
        f"{HEAD}<BaseStepSize>0.1</BaseStepSize><Simulators>{simulators}</Simulators>"
        "</OspSystemStructure>",
        "utf-8",
    )
    yield read_osp(folder)


@pytest.mark.slow
def test_packages_of_other_tools_have_as_many_as_they_say(only, tmp_path: Path) -> None:
    for read in _packages(only("fmi2"), tmp_path):
        system = assemble(read.rig)
        try:
            instances = [part.instance for part in system.parts.values()]
            shared = [one for one in instances if not isinstance(one, IsolatedInstance)]
            assert len(instances) == 2
            assert len(shared) <= 1
        finally:
            system.free()
