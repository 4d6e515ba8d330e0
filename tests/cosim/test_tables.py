"""CSV and Parquet files as components of rigs, with every engine, and of SSP packages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from seatrial.errors import InputError
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.system import Engine
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.native.engine import carry_natively

from ..kits.interchange.ssp_files import BINDING, HULL, Yard, description, rows, system

FORCES = "time,force [kN],turn [deg],on,count [integer]\n0,0,0,false,1\n1,0.004,90,true,2\n2,0.004,90,true,3\n"
"""A force that grows to 4 N within a second."""
RIG = """step = "10 ms"
[components]
inputs = { fmu = "inputs.csv" }
hull = { fmu = "boats.py:Hull" }
[connections]
"inputs.force" = "hull.force"
"inputs.turn" = "hull.angle"
"inputs.on" = "hull.on"
"inputs.count" = "hull.count"
"""


@pytest.fixture(scope="module")
def yard(tmp_path_factory: pytest.TempPathFactory) -> Yard:
    return Yard(tmp_path_factory.mktemp("yard"))


def rig(folder: Path, text: str = RIG, forces: str = FORCES) -> Path:
    from ..kits.interchange.ssp_files import BOATS

    (folder / "boats.py").write_text(BOATS, "utf-8")
    (folder / "inputs.csv").write_text(forces, "utf-8")
    (folder / "rig.toml").write_text(text, "utf-8")
    return folder / "rig.toml"


def speeds(found: list[dict[str, Any]], start: float = 1.0, mass: float = 2.0) -> None:
    """Compare with Euler's sums of the force at the start of each step."""
    v = start
    for k, row in enumerate(found):
        v += 0.01 * min(4.0, 4.0 * k * 0.01) / mass
        assert row["hull.v"] == pytest.approx(v, rel=1e-13), k


@pytest.mark.parametrize("engine", ["direct", "fmu", "native"])
def test_it_feeds_a_rig_with_every_engine(engine: Engine, tmp_path: Path) -> None:
    made = assemble(load_rig(str(rig(tmp_path))), engine)
    carry_natively(made)
    found = rows(made, 200)
    speeds(found)
    assert found[49]["hull.turned"] == pytest.approx(3.141592653589793 / 4, rel=1e-14)
    assert [found[k]["inputs.count"] for k in (98, 99, 198, 199)] == [1, 2, 2, 3]
    assert [found[k]["inputs.on"] for k in (98, 99)] == [False, True]


def test_isolated_it_gives_the_same(tmp_path: Path) -> None:
    text = RIG.replace('"inputs.csv"', '"inputs.csv", isolated = true')
    speeds(rows(assemble(load_rig(str(rig(tmp_path, text)))), 20))


def test_a_bad_file_is_an_error_of_the_rig(tmp_path: Path) -> None:
    path = rig(tmp_path, forces="time,force\n0,1\n1,much\n")
    with pytest.raises(InputError, match=r"components\.inputs\.fmu: .*inputs\.csv, line 3, column"):
        assemble(load_rig(str(path)))


@pytest.mark.slow
def test_a_rig_with_a_table_is_one_fmu(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from seatrial.cli.fmu import fmu_app

    path = rig(tmp_path)
    done = CliRunner().invoke(fmu_app, ["build", "--rig", str(path), "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    (fmu,) = tmp_path.glob("*.fmu")
    box = open_instance(load_fmu(fmu), "box")
    box.initialise(0.0, 1.0)
    box.begin()
    for k in range(50):
        box.step(k * 0.01, 0.01)
    (wanted,) = rows(assemble(load_rig(str(path)), "direct"), 50)[-1:]
    name = next(one for one in box.variables if one.endswith("v"))
    assert box.reader([name])() == [wanted["hull.v"]]
    box.free()


TABLE = """<ssd:Component name="bc" type="{type}" source="resources/{file}"><ssd:Connectors>
<ssd:Connector name="force" kind="output"><ssc:Real{unit}/></ssd:Connector>
<ssd:Connector name="count" kind="output"><ssc:{count}/></ssd:Connector>
</ssd:Connectors></ssd:Component>"""
PUSHED = HULL.replace(BINDING, "").replace(
    "<ssd:Connectors>",
    '<ssd:Connectors><ssd:Connector name="count" kind="input"><ssc:Integer/></ssd:Connector>',
)
PUSH = "".join(
    f'<ssd:Connection startElement="bc" startConnector="{name}" endElement="hull" '
    f'endConnector="{name}"/>'
    for name in ("force", "count")
)
NEWTONS = "time,force,count\n0,0,1\n1,4,2\n2,4,3\n"


def pushed(yard: Yard, path: Path, content: str = NEWTONS, **said: str) -> Path:
    usual = {"type": "text/csv", "file": "force.csv", "count": "Integer", "unit": ""}
    table = TABLE.format(**(usual | said))
    ssd = description(system(table + PUSHED, PUSH))
    return yard.package(path, ssd, {"resources/force.csv": content})


@pytest.mark.parametrize("kind", ["text/csv", "application/table"])
def test_an_ssp_component_may_be_a_table(yard: Yard, kind: str, tmp_path: Path) -> None:
    """As OMSimulator 3 and 2 write it; connectors say which columns are integers."""
    path = pushed(yard, tmp_path / "x.ssp", type=kind)
    packaged = read_ssp(path)
    assert packaged.notes == ()
    found = rows(assemble(packaged.rig), 200)
    speeds(found)
    assert [found[k]["bc.count"] for k in (98, 99, 199)] == [1, 2, 3]
    assert type(found[0]["bc.count"]) is int


def test_an_unpacked_ssp_with_a_table(yard: Yard, tmp_path: Path) -> None:
    import zipfile

    with zipfile.ZipFile(pushed(yard, tmp_path / "x.ssp")) as archive:
        archive.extractall(tmp_path / "x")
    speeds(rows(assemble(read_ssp(tmp_path / "x").rig), 20))


@pytest.mark.parametrize(
    ("content", "said", "message"),
    [
        ("time,force,count\n0,0,1.5\n", {}, r"line \d+.*force\.csv, line 2, column 'count'"),
        (NEWTONS, {"file": "force.txt"}, r"there is no such file"),
        (NEWTONS, {"file": "Hull.fmu"}, r"the name of a table must end in \.csv or \.parquet"),
        (NEWTONS, {"type": "text/tsv"}, r"components of type 'text/tsv' are not supported"),
        ("time,other,count\n0,0,1\n", {}, r"unknown connector 'force'"),
    ],
)
def test_tables_of_packages_that_are_refused(
    content: str, said: dict[str, str], message: str, yard: Yard, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        read_ssp(pushed(yard, tmp_path / "x.ssp", content, **said))
