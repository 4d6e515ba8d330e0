"""Packages of version 2.0 written: types and arrays of FMI 3, tables and calculated parameters."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmpy.ssp.ssd import read_ssd
from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.loading.load import load_fmu
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.interchange.export import export_ssp
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.interchange.ssp.shapes import Enumeration, Shapes

from ...command import seatrial
from ...fmi.native import changed
from .ssp_files import rows
from .ssp_natives import build

MATRIX = "matrix = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]"
RIG = f"""
step = "10 ms"
algorithm = "plain-jacobi"
[components]
inside = {{ rig = "inside.toml" }}
a = {{ fmu = "three.fmu", set = {{ {MATRIX}, in_Float64 = [1.0, 2.0, 3.0], in_String = ["x y", "", "z"] }} }}
b = {{ fmu = "three.fmu" }}
c = {{ fmu = "calc.fmu", set = {{ u = 2.0, i = 3 }} }}
d = {{ fmu = "two.fmu" }}
[connections]
"a.out_Float64" = "b.in_Float64"
"a.out_Float64[2]" = {{ to = "d.u", factor = 3.0 }}
"c.y" = ["d.k", "inside.k"]
"c.j" = {{ to = "d.i", mapping = [[6, 10]] }}
"c.c" = {{ to = "d.b", mapping = [[true, false]] }}
"""
INSIDE = """
[components]
e = { fmu = "two.fmu" }
[shows]
k = "e.k"
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rig")
    for name, data in build(folder / "slaves").items():
        (folder / Path(name).name).write_bytes(data)
    (folder / "inside.toml").write_text(INSIDE, "utf-8")
    (folder / "rig.toml").write_text(RIG, "utf-8")
    return folder / "rig.toml"


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_what_is_written_reads_back_and_runs_the_same(
    version: str, rig: Path, tmp_path: Path
) -> None:
    path, notes = export_ssp(str(rig), tmp_path / "x.ssp", version=version)
    read = read_ssp(path)
    assert list(read.rig.top.inner) == ["inside"]
    plain = read.rig.changed({"algorithm": "plain-jacobi"})
    found, wanted = rows(assemble(plain), 5), rows(assemble(load_rig(str(rig))), 5)
    assert found == wanted
    assert found[-1]["inside.e.x"] == pytest.approx(2.718281828459045 ** (-4.0 * 0.05))
    beyond = [note for note in notes if "SSP 1.0" in note]
    assert len(beyond) == (2 if version == "1.0" else 0)
    again, _ = export_ssp(str(path), tmp_path / "again" / "x.ssp", version=version)
    with zipfile.ZipFile(path) as one, zipfile.ZipFile(again) as other:
        for name in one.namelist():
            if name.endswith(".ssv"):
                assert one.read(name) == other.read(name)


def test_version_2_has_types_arrays_and_kinds_of_the_fmus(rig: Path, tmp_path: Path) -> None:
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp", version="2.0")
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        values = etree.fromstring(archive.read("resources/a.ssv"))
    assert root.get("version") == values.get("version") == "2.0"
    b = root.find(".//{*}Component[@name='b']/{*}Connectors")
    shapes = {
        one.get("name"): [etree.QName(one[0]).localname, *(size.get("size") for size in one[1:])]
        for one in b
    }
    assert shapes["in_Float64"] == ["Float64", "3"]
    assert shapes["transpose"] == ["Float64", "2", "3"]
    assert shapes["out_UInt16"] == ["UInt16", "3"]
    assert shapes["steps"] == ["Int32"]
    kinds = {one.get("name"): one.get("kind") for one in root.iter("{*}Connector")}
    assert (kinds["y"], kinds["k"], kinds["e_k"]) == ("output", "parameter", "parameter")
    ends = {
        (one.get("endConnector"), one.get("endIndices")): one.get("startIndices")
        for one in root.iter("{*}Connection")
    }
    assert ends["in_Float64", "3"] == "3"
    assert ends["u", None] == "2"
    matrix = values.find(".//{*}Parameter[@name='matrix']")
    assert matrix[0].get("value") == "1.0 2.0 3.0 4.0 5.0 6.0"
    assert [one.get("size") for one in matrix[1:]] == ["3", "2"]
    assert len(root.findall(".//{*}IntegerMappingTransformation/{*}MapEntry")) == 1


SMALL = """
step = "10 ms"
[components]
a = { fmu = "small.fmu", set = { in_Mode = "sail" } }
b = { fmu = "small.fmu" }
c = { fmu = "other.fmu", set = { in_Mode = "drift" } }
d = { fmu = "three.fmu" }
[connections]
"a.out_Mode" = ["b.in_Mode", "d.in_Mode"]
"""


def test_enumerations_of_version_3_are_written_with_their_items(rig: Path, tmp_path: Path) -> None:
    """Two types of one name differ; the values of ``three`` are beyond SSP's."""
    three = rig.parent / "three.fmu"
    changed(three, rig.parent / "small.fmu", ('value="5000000000"', 'value="2"'))
    changed(three, rig.parent / "other.fmu", ('value="5000000000"', 'value="3"'))
    small = rig.parent / "small.toml"
    small.write_text(SMALL, "utf-8")
    path, _ = export_ssp(str(small), tmp_path / "x.ssp", version="2.0")
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        (sail,) = etree.fromstring(archive.read("resources/a.ssv")).iter("{*}Enumeration")
    assert sail.get("value") == "sail"
    defined = {
        one.get("name"): {item.get("name"): item.get("value") for item in one}
        for one in root.iterfind("{*}Enumerations/{*}Enumeration")
    }
    assert defined == {
        "Mode": {"drift": "1", "sail": "2"},
        "c.Mode": {"drift": "1", "sail": "3"},
    }
    types = {
        name: root.find(f".//{{*}}Component[@name='{name}']//{{*}}Connector[@name='out_Mode']")[0]
        for name in "abcd"
    }
    kinds = {name: (etree.QName(one).localname, one.get("name")) for name, one in types.items()}
    assert kinds == {
        "a": ("Enumeration", "Mode"),
        "b": ("Enumeration", "Mode"),
        "c": ("Enumeration", "c.Mode"),
        "d": ("Int64", None),
    }
    read = read_ssp(path).rig.changed({"algorithm": "jacobi"})
    found, wanted = rows(assemble(read), 2), rows(assemble(load_rig(str(small))), 2)
    assert found == wanted
    assert (found[-1]["a.out_Mode"], found[-1]["d.out_Mode"]) == (2, 2)


def test_a_value_that_is_no_item_is_written_as_a_number(rig: Path) -> None:
    """An element for which the FMU gives no start value is 0."""
    mode = load_fmu(rig.parent / "three.fmu").variables["in_Mode"]
    shapes = Shapes(enumerations={"in_Mode": Enumeration("Mode", {"drift": 1, "sail": 2})})
    assert shapes.written(mode, [2, 1]) == ("Enumeration", ["sail", "drift"])
    assert shapes.written(mode, [2, 0]) == ("Int64", [2, 0])


SIZED = """
step = "10 ms"
[components]
a = { fmu = "three.fmu", set = { rows = 2, matrix = [1.0, 2.0, 3.0, 4.0] } }
"""


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_structural_parameters_are_written_and_read(version: str, rig: Path, tmp_path) -> None:
    """The sizes of what follows them are those of the rig: 2 by 2, not the FMU's 3 by 2."""
    sized = rig.parent / "sized.toml"
    sized.write_text(SIZED, "utf-8")
    path, _ = export_ssp(str(sized), tmp_path / "x.ssp", version=version)
    if version == "2.0":
        with zipfile.ZipFile(path) as archive:
            root = etree.fromstring(archive.read("SystemStructure.ssd"))
            (matrix,) = etree.fromstring(archive.read("resources/a.ssv")).iterfind(
                ".//{*}Parameter[@name='matrix']"
            )
        shape = root.find(".//{*}Connector[@name='transpose']")
        assert [one.get("size") for one in shape[1:]] == ["2", "2"]
        assert [one.get("size") for one in matrix[1:]] == ["2", "2"]
    read = read_ssp(path)
    assert read.rig.components["a"].entry.set["rows"] == 2
    found, wanted = rows(assemble(read.rig), 2), rows(assemble(load_rig(str(sized))), 2)
    assert found == wanted
    transpose = {name: one for name, one in found[-1].items() if "transpose" in name}
    assert transpose == {
        "a.transpose[1,1]": 1.0, "a.transpose[1,2]": 3.0,
        "a.transpose[2,1]": 2.0, "a.transpose[2,2]": 4.0,
    }  # fmt: skip


def test_version_1_fits_the_schema_that_fmpy_brings(rig: Path, tmp_path: Path) -> None:
    path, _ = export_ssp(str(rig), tmp_path / "x.ssp")
    assert read_ssd(str(path)).version == "1.0"  # FMPy validates what it reads


def test_version_1_refuses_integers_that_it_cannot_hold(rig: Path, tmp_path: Path) -> None:
    wide = rig.parent / "wide.toml"
    wide.write_text(RIG.replace(MATRIX, 'in_Mode = "sail"'), "utf-8")
    with pytest.raises(InputError, match=r"a\.in_Mode = 5000000000: integers of SSP 1\.0 have 32"):
        export_ssp(str(wide), tmp_path / "x.ssp")
    assert not (tmp_path / "x.ssp").exists()
    path, _ = export_ssp(str(wide), tmp_path / "x.ssp", version="2.0")
    assert read_ssp(path).rig.components["a"].entry.set["in_Mode"] == 5_000_000_000


def test_the_command_takes_a_version_and_a_strict_check(rig: Path, tmp_path: Path) -> None:
    out = tmp_path / "x.ssp"
    done = seatrial("ssp", "export", str(rig), "--out", str(out), "--version", "2.0", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert seatrial("ssp", "export", str(rig), "--version", "3.0", cwd=tmp_path).returncode == 2
    assert (
        "rejects"
        not in seatrial("ssp", "check", str(out), cwd=tmp_path).stdout.partition("omsimulator")[0]
    )
    with zipfile.ZipFile(out, "a") as archive:
        text = archive.read("SystemStructure.ssd").decode()
    odd = tmp_path / "odd.ssp"
    with zipfile.ZipFile(out) as old, zipfile.ZipFile(odd, "w") as new:
        for member in old.infolist():
            data = old.read(member)
            if member.filename == "SystemStructure.ssd":
                data = text.replace('name="d" type', 'name="d" colour="red" type').encode()
            new.writestr(member, data)
    said = seatrial("ssp", "check", str(odd), cwd=tmp_path).stdout
    assert "attribute 'colour' of ssd:Component is not known" in said
    strict = seatrial("ssp", "check", str(odd), "--strict", cwd=tmp_path)
    assert strict.returncode == 1
    assert "rejects" in strict.stdout.partition("omsimulator")[0]
    assert (
        seatrial("ssp", "check", str(odd), "--strict", "--for", "fmpy", cwd=tmp_path).returncode
        == 2
    )
