"""Algebraic loops through FMUs in C of every version, in this process and isolated."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from seatrial.errors import SimulationError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from tests.fmi.models import build_model_fmu

PORTS = {1: ("y", "u"), 2: ("y", "u"), 3: ("out_Float64[1]", "in_Float64[1]")}


@pytest.fixture(scope="module")
def fmus(native_fmu: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Slaves with an output y that is 2 u at once, in one folder."""
    folder = tmp_path_factory.mktemp("loops")
    shutil.copyfile(build_model_fmu(1, folder, "co-simulation"), folder / "fmi1.fmu")
    for name in ("fmi2", "fmi3"):
        shutil.copyfile(native_fmu(name), folder / f"{name}.fmu")
    return folder


def rig(fmus: Path, version: int, back: str, *, isolated: bool) -> Master:
    file = fmus / "loop.toml"
    y, u = PORTS[version]
    own = f'fmu = "fmi{version}.fmu"'
    file.write_text(
        f'step = "10 ms"\n[components]\na = {{ {own} }}\n'
        f"b = {{ {own}, isolated = {str(isolated).lower()} }}\n"
        f'[connections]\n"a.{y}" = {{ to = "b.{u}", offset = 1.0 }}\n'
        f'"b.{y}" = {{ to = "a.{u}", {back} }}\n'
    )
    return Master(assemble(load_rig(str(file))))


@pytest.mark.sampled(2)
@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize("version", [1, 2, 3])
def test_a_loop_that_repels_iteration_is_solved(fmus: Path, version: int, isolated: bool) -> None:
    """a.y = 2 (b.y + 1), b.y = 2 (a.y + 1): gain 4, so that no relaxation settles it."""
    master = rig(fmus, version, "offset = 1.0", isolated=isolated)
    master.initialise()
    for _ in range(3):
        for component in "ab":
            found = master.signals[master.names.index((component, PORTS[version][0]))]
            assert found == pytest.approx(-2.0, rel=1e-10)
        master.step()
    master.system.free()


@pytest.mark.parametrize("version", [1, 2, 3])
def test_a_loop_without_a_solution_is_named(fmus: Path, version: int) -> None:
    """a.y = a.y + 2."""
    master = rig(fmus, version, "factor = 0.25", isolated=False)
    with pytest.raises(SimulationError, match=r"the loop through a\..+, b\..+ does not settle"):
        master.initialise()
    master.system.free()
