"""Descriptions with their files around them, and FMUs behind a proxy, as libcosim takes them."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.packages import is_package, read_package
from seatrial_kits.interchange.osp.reading import read_osp
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.interchange.ssp.tools import findings

from .osp_files import write_osp
from .ssp_natives import bound, build, component, elements, package, ssd, value, values

VALUES = bound(more='source="values.ssv"')
TOP = ssd(elements(component("a", bindings=VALUES)))
PROXIED = "proxyfmu://localhost?file="


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with an FMU beside the folder of a system."""
    folder = tmp_path_factory.mktemp("shared")
    files = {Path(name).name: data for name, data in build(folder / "built").items()}
    (folder / "two.fmu").write_bytes(files["two.fmu"])
    (folder / "system").mkdir()
    description = TOP.replace("resources/two.fmu", "../two.fmu")
    (folder / "system" / "SystemStructure.ssd").write_text(description)
    (folder / "system" / "values.ssv").write_text(values(value("u", "3.0"), value("gain", "2.0")))
    return folder


def y_of_a(rig) -> float:
    """Return gain * u after a step."""
    system = assemble(rig)
    try:
        master = Master(system)
        master.initialise()
        master.step()
        return master.values("a", ["y"])[0]
    finally:
        system.free()


@pytest.mark.parametrize("name", ["system", "system/SystemStructure.ssd"])
def test_a_folder_and_its_description_are_packages(name: str, shared: Path) -> None:
    assert is_package(name, shared)
    assert y_of_a(read_package(shared / name, {}).rig) == 6.0
    assert {one.tool for one in findings(shared / name)}


def test_a_mistake_names_the_file_in_the_folder(shared: Path, tmp_path: Path) -> None:
    assert not is_package("empty", tmp_path)
    with pytest.raises(InputError, match=r"there is no SystemStructure\.ssd"):
        read_ssp(tmp_path)
    (tmp_path / "own.ssd").write_text(TOP.replace("resources/two.fmu", "gone.fmu"))
    with pytest.raises(
        InputError, match=r"own.ssd: own.ssd: line 3: source 'gone.fmu': there is no"
    ):
        read_ssp(tmp_path / "own.ssd")


@pytest.mark.slow
def test_a_proxied_fmu_of_a_package_is_isolated(shared: Path, tmp_path: Path) -> None:
    members = {
        "resources/two.fmu": (shared / "two.fmu").read_bytes(),
        "values.ssv": (shared / "system" / "values.ssv").read_text(),
    }
    text = TOP.replace("resources/", f"{PROXIED}resources/")
    rig = read_ssp(package(tmp_path / "x.ssp", text, members)).rig
    assert rig.components["a"].entry.isolated
    assert y_of_a(rig) == 6.0


@pytest.mark.parametrize(
    "source",
    [
        f"{PROXIED}../two.fmu",
        "proxyfmu://localhost:9090?file=resources/two.fmu",
        "proxyfmu://example.org?file=resources/two.fmu",
        "proxyfmu://localhost?guid=resources/two.fmu",
    ],
)
def test_other_proxies_and_files_are_refused(source: str, shared: Path, tmp_path: Path) -> None:
    members = {"resources/two.fmu": (shared / "two.fmu").read_bytes()}
    text = TOP.replace("resources/two.fmu", source)
    with pytest.raises(InputError, match=r"x.ssp: SystemStructure.ssd: line 3: source 'proxyfmu"):
        read_ssp(package(tmp_path / "x.ssp", text, members))


def test_a_proxied_simulator_of_osp_is_isolated(tmp_path: Path) -> None:
    write_osp(tmp_path)
    file = tmp_path / "OspSystemStructure.xml"
    text = file.read_text()
    file.write_text(text.replace('"two" source="', f'"two" source="{PROXIED}'))
    isolated = [
        name for name, one in read_osp(tmp_path).rig.components.items() if one.entry.isolated
    ]
    assert isolated == ["two"]


def test_usual_prefixes_need_no_declaration(shared: Path, tmp_path: Path) -> None:
    """Parsers that know no namespaces take OSP's own examples without them."""
    members = {
        "resources/two.fmu": (shared / "two.fmu").read_bytes(),
        "values.ssv": (shared / "system" / "values.ssv").read_text(),
    }
    osp = """<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform"><osp:Algorithm>
    <osp:FixedStepAlgorithm baseStepSize="0.005"/></osp:Algorithm></ssc:Annotation></ssd:Annotations>"""
    end = 'stopTime="0.02"/>'
    assert end in TOP
    text = TOP.replace(end, f'stopTime="0.02">{osp}</ssd:DefaultExperiment>')
    file = package(tmp_path / "x.ssp", text, members)
    found = read_ssp(file)
    assert found.rig.step_ns == 5_000_000
    assert any("prefix 'osp' is not declared; it is taken for http" in note for note in found.notes)
    assert {one.tool for one in findings(file)}
    with pytest.raises(InputError, match="line 4: prefix 'osp' is not declared"):
        read_ssp(file, strict=True)
    for wrong in (text.replace("osp:", "opss:"), text.replace("</osp:Algorithm>", "</osp:Algo>")):
        with pytest.raises(InputError, match=r"SystemStructure\.ssd: not XML"):
            read_ssp(package(tmp_path / "x.ssp", wrong, members))
