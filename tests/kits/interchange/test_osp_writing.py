"""System structures of OSP-IS that are written, read back."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial_kits.interchange.export import export_osp, export_ssp
from seatrial_kits.interchange.osp.reading import read_osp
from tests.kits.interchange.osp_files import write_osp


def stepped(path: Path, steps: int = 12) -> dict[str, list[object]]:
    """Return the outputs of the FMUs after every step."""
    system = assemble(read_osp(path).rig)
    try:
        master = Master(system)
        master.initialise()
        rows = [list(master.signals)]
        for _ in range(steps):
            master.step()
            rows.append(list(master.signals))
        names = [".".join(name) for name in master.names]
        table = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
        sums = [name for name, part in system.parts.items() if part.is_sum]
        return {name: of for name, of in table.items() if name.split(".")[0] not in sums}
    finally:
        system.free()


def test_a_structure_written_and_read_is_the_same(tmp_path: Path) -> None:
    file = write_osp(tmp_path / "in")
    folder, notes = export_osp(str(file), tmp_path / "out")
    assert not any("cannot be said" in note for note in notes)
    assert stepped(folder) == stepped(file)
    names = {path.name for path in folder.iterdir()}
    assert {"slave_uno.fmu", "fmi2_OspModelDescription.xml", "OspSystemStructure.xml"} <= names
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    export_osp(str(file), folder)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_ssp_has_no_sums(tmp_path: Path) -> None:
    file = write_osp(tmp_path / "in")
    with pytest.raises(InputError, match="total is a sum of 3, which SSP does not have"):
        export_ssp(str(file), tmp_path / "x.ssp")


RIG = """
step = "10 ms"
[components]
a = {{ fmu = "{0}" }}
b = {{ fmu = "{0}" }}
total = {{ sum = {{ inputs = 2 }} }}
[connections]
{1}
"""


@pytest.mark.parametrize(
    ("connections", "message"),
    [
        ('"a.x" = "b.gain"', "OSP-IS has no connections to parameters"),
        ('"a.j" = "b.u"', "libcosim connects variables of one type only"),
        ('"a.mode" = "b.mode_in"', "libcosim connects no enumerations"),
        ('"a.x" = "total.in[0]"\n"total.out" = "b.u"', r"total.in\[1\]: nothing feeds it"),
        (
            '"a.x" = { to = "total.in[0]", factor = 2.0 }\n"a.y" = "total.in[1]"\n"total.out" = "b.u"',
            "libcosim connects no function to another",
        ),
    ],
)
def test_what_libcosim_cannot_take_is_refused(
    connections: str, message: str, write, tmp_path: Path
) -> None:
    write_osp(tmp_path)
    rig = write("rig.toml", RIG.format(tmp_path / "fmi2.fmu", connections))
    with pytest.raises(InputError, match=message):
        export_osp(str(rig), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_nothing_replaces_what_it_is_made_from(tmp_path: Path) -> None:
    write_osp(tmp_path)
    with pytest.raises(InputError, match="would replace what it is made from"):
        export_osp(str(tmp_path), tmp_path)
