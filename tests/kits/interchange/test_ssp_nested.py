"""Rigs in rigs as packages: systems in systems, for tools that take them, and one for others."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from fmpy.ssp.ssd import read_ssd
from lxml import etree

from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.interchange.export import export_ssp
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.interchange.ssp.tools import findings

from ...interop.ssp_tools import run
from .ssp_files import BOATS, rows

# Values that cross systems up, down and both; one goes to two targets, as it is and transformed.
OUTER = """
step = "10 ms"
algorithm = "plain-jacobi"
[components]
boat = { rig = "boat.toml" }
shore = { fmu = "boats.py:Compass" }
[connections]
"shore.angle" = "boat.turn"
"""
BOAT = """
[components]
inner = { rig = "inner.toml" }
inner_hull = { fmu = "boats.py:Hull" }
inner_hull_angle = { fmu = "boats.py:Compass" }
[connections]
"inner.v" = { to = "inner.resisted", factor = 2.0 }
"inner.force" = "inner_hull.force"
[shows]
turn = ["inner_hull.angle", "inner.turn"]
"""
INNER = """
[components]
hull = { fmu = "boats.py:Hull", set = { mass = "4 kg" }, step = "20 ms" }
damper = { fmu = "boats.py:Damper", set = { damping = 0.25 } }
[connections]
"damper.force" = "hull.force"
[shows]
v = "hull.v"
turn = "hull.angle"
force = "damper.force"
resisted = "damper.v"
"""


@pytest.fixture
def outer(write) -> Path:
    write("boats.py", BOATS)
    write("boat.toml", BOAT)
    write("inner.toml", INNER)
    return write("outer.toml", OUTER)


def connected(system: etree._Element) -> dict[str, str]:
    """Return the connections of one system, to: from, with what is done to the value."""
    found = {}
    for one in system.iterfind("{*}Connections/{*}Connection"):
        start, end = (
            "/".join(filter(None, (one.get(f"{side}Element"), one.get(f"{side}Connector"))))
            for side in ("start", "end")
        )
        linear = one.find("{*}LinearTransformation")
        done = "" if linear is None else f" * {float(linear.get('factor')):.4g}"
        kept = " unconverted" if one.get("suppressUnitConversion") else ""
        found[end] = f"{start}{done}{kept}"
    return found


@pytest.mark.slow
def test_a_rig_in_a_rig_is_a_system_that_values_cross_at_connectors(
    outer: Path, tmp_path: Path
) -> None:
    path, notes = export_ssp(str(outer), tmp_path / "x.ssp")
    assert notes == ["a rig has no stop time: the package says 10 s"]
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        assert sorted(n for n in archive.namelist() if n.endswith(".fmu")) == [
            f"resources/{name}.fmu"
            for name in (
                "boat.inner.damper",
                "boat.inner.hull",
                "boat.inner_hull",
                "boat.inner_hull_angle",
                "shore",
            )
        ]
    assert len(read_ssd(str(path)).system.elements) == 2  # FMPy validates what it reads
    top, boat, inner = root.iter("{*}System")
    # One connector for one value that goes to two; converted where it arrives. A connector
    # inner_hull_angle would be called as the component is.
    assert connected(top) == {"boat/inner_hull_2_angle": "shore/angle"}
    assert connected(boat) == {
        "inner/hull_angle": "inner_hull_2_angle",
        "inner_hull/angle": "inner_hull_2_angle * 0.01745 unconverted",
        "inner_hull/force": "inner/damper_force",
    }
    assert connected(inner) == {
        "hull/angle": "hull_angle * 0.01745 unconverted",
        "damper/v": "hull/v * 2 unconverted",  # the boat's connection, the shortest way
        "hull/force": "damper/force",
        "damper_force": "damper/force",
    }
    kinds = {c.get("name"): c.get("kind") for c in inner.find("{*}Connectors")}
    assert kinds == {"hull_angle": "input", "damper_force": "output"}
    units = [c[0].get("unit") for c in root.iter("{*}Connector") if "l_2_a" in c.get("name")]
    assert units == ["deg"]


@pytest.mark.slow
def test_fmpy_runs_a_nested_package_as_one_of_one_system(outer: Path, tmp_path: Path) -> None:
    nested, _ = export_ssp(str(outer), tmp_path / "nested.ssp", tool="fmpy")
    flat, _ = export_ssp(str(outer), tmp_path / "flat.ssp", tool="libcosim")
    assert not any(one.rejects for one in findings(nested) if one.tool == "fmpy")
    v, force = "boat.inner.hull.v", "boat.inner.damper.force"
    found = run("fmpy", nested, steps=20, watch=[v, force])
    names = ["boat_inner_hull.v", "boat_inner_damper.force"]
    assert found == run("fmpy", flat, steps=20, watch=names)
    assert found[-1][0] < 1.0  # it was braked


@pytest.mark.parametrize("tool", ["libcosim", "ecos"])
def test_a_tool_without_systems_in_systems_gets_one(tool: str, outer: Path, tmp_path: Path) -> None:
    path, _ = export_ssp(str(outer), tmp_path / "x.ssp", tool=tool)
    read = read_ssp(path).rig.changed({"algorithm": "plain-jacobi"})
    # boat.inner.hull and boat.inner_hull would be called alike.
    boat = ["inner_hull", "inner_damper", "inner_hull_2", "inner_hull_angle"]
    assert list(read.components) == [*(f"boat_{name}" for name in boat), "shore"]
    assert not any(one.rejects for one in findings(path) if one.tool == tool)
    mine = rows(assemble(load_rig(str(outer))), 40)
    assert [list(row.values()) for row in rows(assemble(read), 40)] == [
        list(row.values()) for row in mine
    ]


def test_what_is_nested_is_read_nested_and_written_again_the_same(
    outer: Path, tmp_path: Path
) -> None:
    first, _ = export_ssp(str(outer), tmp_path / "outer.ssp")
    read = read_ssp(first)
    assert read.notes == ()
    assert list(read.rig.top.inner["boat"].inner) == ["inner"]
    plain = read.rig.changed({"algorithm": "plain-jacobi"})
    assert rows(assemble(plain), 40) == rows(assemble(load_rig(str(outer))), 40)
    second, _ = export_ssp(str(first), tmp_path / "again" / "outer.ssp")
    assert second.read_bytes() == first.read_bytes()


@pytest.mark.interop
def test_a_shipped_rig_of_rigs_survives_a_package(tmp_path: Path) -> None:
    choices = {"vehicle": "hydrone", "algorithm": "plain-jacobi"}
    path, _ = export_ssp(
        "sil",
        tmp_path / "sil.ssp",
        changes={f"choices.{key}": value for key, value in choices.items()},
    )
    read = read_ssp(path).rig.changed({"algorithm": "plain-jacobi"})
    assert rows(assemble(read), 20) == rows(assemble(load_rig("sil", choices=choices)), 20)
    again, _ = export_ssp(str(path), tmp_path / "again" / "sil.ssp")
    assert again.read_bytes() == path.read_bytes()


@pytest.mark.slow
def test_what_links_tune_stays_at_its_start_and_a_note_says_so(tmp_path: Path) -> None:
    choices = {"vehicle": "mariner", "autopilot": "mavlink"}
    path, notes = export_ssp(
        "sil",
        tmp_path / "x.ssp",
        changes={f"choices.{key}": value for key, value in choices.items()},
    )
    said = "tunables of autopilot.mavlink cannot be said: the parameters that they set stay"
    assert sum(said in note for note in notes) == 1
    given = read_ssp(path).rig.components["autopilot.pilot.autopilot"].entry.set
    assert given["derivative_gain"] == 22.504992396661024  # of the vehicle's file
    with zipfile.ZipFile(path) as archive:
        assert b'"parameter"' not in archive.read("SystemStructure.ssd")
