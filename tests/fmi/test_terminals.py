"""Terminals in FMUs: FMI's own schema, what is read back, files of other tools."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import ComponentSource, shipped_sources
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.files.terminals import PLACE
from seatrial.fmi.loading.load import load_fmu
from seatrial.model.terminals import Terminal

from . import boats
from .conftest import built_once, source

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"


@pytest.fixture
def barge(write) -> ComponentSource:
    return source(write("barge.py", boats.BARGE), "Barge")


@pytest.fixture
def barge_fmu(barge: ComponentSource, tmp_path: Path) -> Path:
    return built_once(barge, tmp_path / "barge.fmu")


def with_file(path: Path, to: Path, text: str) -> Path:
    """Copy an FMU to ``to``, with ``text`` as its file of terminals."""
    shutil.copyfile(path, to)
    with zipfile.ZipFile(to, "a") as archive:
        archive.writestr(PLACE, text)
    return to


def in_file(terminals: str) -> str:
    return f'<fmiTerminalsAndIcons fmiVersion="3.0">{terminals}</fmiTerminalsAndIcons>'


def listed(terminals: str) -> str:
    return in_file(f"<Terminals>{terminals}</Terminals>")


def member(variable: str, name: str = "") -> str:
    called = f' memberName="{name}"' if name else ""
    return f'<TerminalMemberVariable variableName="{variable}"{called} variableKind="signal"/>'


def test_the_file_is_valid_and_names_variables_that_fmpy_finds(barge_fmu: Path) -> None:
    assert validate_fmu(str(barge_fmu)) == []
    with zipfile.ZipFile(barge_fmu) as archive:
        root = etree.fromstring(archive.read(PLACE))
    etree.XMLSchema(file=str(SCHEMA)).assertValid(root)
    names = {v.name for v in fmpy.read_model_description(str(barge_fmu)).modelVariables}
    assert {e.get("variableName") for e in root.iter("TerminalMemberVariable")} <= names
    written = {
        t.get("name"): {
            m.get("memberName"): m.get("variableName") for m in t.iter("TerminalMemberVariable")
        }
        for t in root.iter("Terminal")
    }
    assert list(written) == ["motion", "wrench", "wrench_2", "wrench_3", "actuators", "reading"]
    assert written["wrench_2"] == {
        **{f"force.{a}": f"force_2.{a}" for a in "xyz"},
        **{f"moment.{a}": f"moment_2.{a}" for a in "xyz"},
        "lift": "lift_2",
    }
    assert written["wrench_3"] == {f"force.{a}": f"force_3.{a}" for a in "xyz"}
    assert written["reading"] == {"depth.a": "depth.a", "said": "said", "heel": "attitude.phi"}


def test_what_was_declared_is_read_back(barge: ComponentSource, barge_fmu: Path) -> None:
    fmu, direct = load_fmu(barge_fmu), DirectInstance(barge.component_class()("barge"))
    assert fmu.terminals == direct.terminals
    assert fmu.variables.terms == direct.variables.terms
    assert fmu.variables.terms["force"] == ["force_1", "force_2", "force_3"]


def test_the_same_component_gives_the_same_bytes(barge: ComponentSource, tmp_path: Path) -> None:
    one, two = (build_fmu(barge, tmp_path / name) for name in ("one.fmu", "two.fmu"))
    assert one.read_bytes() == two.read_bytes()


@pytest.mark.interop
@pytest.mark.parametrize("name", shipped_sources())
def test_a_shipped_fmu_shows_what_its_component_shows(name: str, tmp_path: Path) -> None:
    component = shipped_sources()[name]
    fmu = load_fmu(built_once(component, tmp_path / "x.fmu"))
    direct = DirectInstance(component.component_class()(name))
    assert fmu.terminals == direct.terminals
    assert {n: (v.term_of, v.frame) for n, v in fmu.variables.items()} == {
        n: (v.term_of, v.frame) for n, v in direct.variables.items()
    }


def test_a_term_with_the_name_of_another_terminal(write, tmp_path: Path) -> None:
    text = boats.BARGE.replace('"actuators":', '"wrench_2":')
    with pytest.raises(InputError, match="'wrench_2' has the name of term 2 of 'wrench'"):
        build_fmu(source(write("barge.py", text), "Barge"), tmp_path / "x.fmu")


def test_terminals_of_other_tools(native_fmu, tmp_path: Path) -> None:
    text = listed(
        '<Terminal name="Flange" matchingRule="org.example.flange" terminalKind="x">'
        f"{member('x', 'place')}{member('u')}"
        '<TerminalStreamMemberVariable inStreamMemberName="h_in" outStreamMemberName="h_out"'
        ' inStreamVariableName="u" outStreamVariableName="x"/>'
        f'<Terminal name="inner" matchingRule="plug">{member("u", "force")}</Terminal>'
        "</Terminal>"
        f'<Terminal name="Socket" matchingRule="plug">{member("x", "x")}</Terminal>'
        '<Terminal name="Empty" matchingRule="bus"/>'
    )
    etree.XMLSchema(file=str(SCHEMA)).assertValid(etree.fromstring(text))
    fmu = load_fmu(with_file(native_fmu("fmi2"), tmp_path / "x.fmu", text))
    inside = {"place": "x", "u": "u", "h_in": "u", "h_out": "x", "inner.force": "u"}
    assert fmu.terminals == {
        "Flange": Terminal(inside, "bus"),
        "Socket": Terminal({"x": "x"}, "plug"),
    }


def test_arrays_are_members_and_clocks_are_none(native_fmu, tmp_path: Path) -> None:
    text = listed(
        '<Terminal name="Bus" matchingRule="org.fmi-ls-bus.transceiver">'
        f"{member('in_Float64', 'Rx_Data')}{member('tick', 'Rx_Clock')}</Terminal>"
        f'<Terminal name="Clocks" matchingRule="bus">{member("tick")}</Terminal>'
    )
    fmu = load_fmu(with_file(native_fmu("fmi3"), tmp_path / "x.fmu", text))
    assert fmu.terminals == {"Bus": Terminal({"Rx_Data": "in_Float64"})}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<fmiTerminalsAndIcons>", "not XML"),
        ('<!DOCTYPE x [<!ENTITY a "b">]><x/>', "document type"),
        ("<fmiModelDescription/>", "fmiTerminalsAndIcons is needed, found fmiModelDescription"),
        (listed('<Terminal matchingRule="bus"/>'), r"Terminal \(line 1\): has no name"),
        (listed('<Terminal name="a"/>'), "has no matchingRule"),
        (
            listed('<Terminal name="a" matchingRule="bus"><TerminalMemberVariable/></Terminal>'),
            r"TerminalMemberVariable \(line 1\): has no variableName",
        ),
        (
            listed(f'<Terminal name="a" matchingRule="bus">{member("largest_stp")}</Terminal>'),
            "unknown variable 'largest_stp'; did you mean 'largest_step'",
        ),
        (
            listed(f'<Terminal name="a" matchingRule="bus">{member("x", "m") * 2}</Terminal>'),
            "two members are called 'm'",
        ),
        (
            listed(f'<Terminal name="a" matchingRule="bus">{member("x")}</Terminal>' * 2),
            "two terminals are called 'a'",
        ),
    ],
)  # fmt: skip
def test_mistakes_name_the_file(text: str, message: str, native_fmu, tmp_path: Path) -> None:
    path = with_file(native_fmu("fmi2"), tmp_path / "x.fmu", text)
    with pytest.raises(InputError, match=message) as caught:
        load_fmu(path)
    assert f"{path}: {PLACE}: " in str(caught.value)
