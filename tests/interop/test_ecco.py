"""Energy-conserving step control: every step and every value are those of libcosim's ecco.

libcosim reads no system structure with more than one power bond: its check of their number stands
in the loop that makes them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from seatrial.fmi.loading.load import load_fmu
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial_kits.interchange.export import export_osp
from seatrial_kits.interchange.osp.reading import read_osp
from tests.cosim.bodies import TEXT

from .test_osp_system import run

pytestmark = pytest.mark.interop

HULL = '''

class Hull(Plant):
    """m v' = F + G - d v."""

    force = Input("N", "force")
    pull = Input("N", "another")
    x = State("m", "position", start=1.0)
    v = State("m/s", "velocity")

    def equations(self, x, u, p):
        return {"x": x.v, "v": (u.force + u.pull - 30.0 * x.v) / 100.0}, {}
'''
RIG = """
step = "2 s"
algorithm = "ecco"
[ecco]
step = "0.1 ms"
min_step = "1 us"
max_step = "2 s"
safety_factor = 0.99
absolute_tolerance = TOLERANCE
[bonds]
axle = ["appendage.v_hull", "hull.force"]
[components]
hull = { fmu = "bodies.py:Hull", set = { max_step = "1 ms" } }
appendage = { fmu = "bodies.py:Appendage", set = { max_step = "1 ms" } }
tender = { fmu = "bodies.py:Appendage", set = { mass = 3.0, max_step = "1 ms" } }
[connections]
"hull.x" = ["appendage.x_hull", "tender.x_hull"]
"hull.v" = ["appendage.v_hull", "tender.v_hull"]
"appendage.force" = "hull.force"
"tender.force" = "hull.pull"
"""


def our_steps(file: Path) -> tuple[list[list[Any]], list[str]]:
    """Return time, ns, and outputs after each step but the last, which a communication point cuts."""
    system = assemble(read_osp(file).rig)
    try:
        master = Master(system)
        master.initialise()
        rows: list[list[Any]] = []
        instance = system.parts["hull"].instance
        taken = instance.step

        def step(t: float, h: float) -> None:
            rows.append([round(t * 1e9), *master.signals])
            taken(t, h)

        instance.step = step  # type: ignore[method-assign]
        master.step()
        return rows[1:], [".".join(name) for name in master.names]
    finally:
        system.free()


@pytest.mark.parametrize("tolerance", ["1e-4", "1e-6"])
def test_steps_and_values_are_those_of_libcosim(tolerance: str, tmp_path: Path) -> None:
    (tmp_path / "bodies.py").write_text(TEXT + HULL, "utf-8")
    (tmp_path / "rig.toml").write_text(RIG.replace("TOLERANCE", tolerance), "utf-8")
    folder, _ = export_osp(str(tmp_path / "rig.toml"), tmp_path / "osp")
    rows, names = our_steps(folder)
    groups = [
        (owner, [name for name in names if name.startswith(f"{owner}.")])
        for owner in ("hull", "appendage", "tender")
    ]
    watch = []
    for owner, of_owner in groups:
        variables = load_fmu(folder / f"{owner}.fmu").variables
        ports = [name.partition(".")[2] for name in of_owner]
        watch.append([owner, "real", [variables[port].reference for port in ports]])
    file = str(folder / "OspSystemStructure.xml")
    theirs = run({"file": file, "steps": len(rows), "watch": watch, "times": True})
    places = [1 + names.index(name) for _, of_owner in groups for name in of_owner]
    ours = [[row[0], *(row[place] for place in places)] for row in rows]
    assert len(ours) > 500
    assert [row[0] for row in ours] == [row[0] for row in theirs]
    assert ours == theirs
