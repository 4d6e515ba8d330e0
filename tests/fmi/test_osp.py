"""Variable groups of OSP-IS beside FMUs: written from terminals, read from files of others."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from lxml import etree

from seatrial.errors import InputError
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.files.osp import osp_xml
from seatrial.fmi.loading.load import load_fmu
from seatrial.model.terminals import Terminal

from . import boats
from .conftest import source
from .native import changed

# Abridged from libcosim's tests (KnuckleBoomCrane, chassis), with variables of the slave.
OTHERS = """<?xml version="1.0" encoding="utf-8" ?>
<OspModelDescription {namespace} version="1.0">
    <UnitDefinitions>
        <Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit>
    </UnitDefinitions>
    <VariableGroups>
        <Generic name="actuatorLimits">
            <Variable ref="q[1]"/>
            <Variable ref="q[2]"/>
        </Generic>
        <LinearMechanicalPort name="linear mechanical port">
            <Force name="force"><Variable ref="u" unit="N"/></Force>
            <LinearVelocity name="velocity"><Variable ref="x" unit="m/s"/></LinearVelocity>
        </LinearMechanicalPort>
    </VariableGroups>
</OspModelDescription>
"""
OLD = "http://opensimulationplatform.com/MSMI/OSPModelDescription"
NEW = "https://open-simulation-platform.com/OspModelDescription/1.0.1"


@pytest.fixture
def slave(native_fmu, tmp_path: Path) -> Path:
    return Path(shutil.copyfile(native_fmu("fmi2"), tmp_path / "it.fmu"))


def beside(slave: Path, text: str) -> Path:
    path = slave.with_name("fmi2_OspModelDescription.xml")
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("namespace", [f'xmlns="{OLD}"', f'xmlns="{NEW}"', ""])
def test_groups_of_others_are_terminals(namespace: str, slave: Path) -> None:
    assert load_fmu(slave).terminals == {}
    beside(slave, OTHERS.replace("{namespace}", namespace))
    assert load_fmu(slave).terminals == {
        "actuatorLimits": Terminal({"q": "q"}),
        "linear mechanical port": Terminal({"u": "u", "x": "x"}),
    }


@pytest.mark.parametrize("name", ["../fmi2", "", "a" * 5000])
def test_a_model_name_that_is_no_name_of_a_file(name: str, slave: Path, tmp_path: Path) -> None:
    beside(slave, OTHERS)
    inside = tmp_path / "inside"
    inside.mkdir()
    other = changed(slave, inside / "it.fmu", ('modelName="fmi2"', f'modelName="{name}"'))
    assert load_fmu(other).terminals == {}


def test_types_of_groups_and_terms(write) -> None:
    barge = DirectInstance(source(write("barge.py", boats.BARGE), "Barge").component_class()("b"))
    (groups,) = etree.fromstring(osp_xml(barge.terminals, barge.variables))
    found = {
        (g.getparent().get("name"), etree.QName(g).localname, g.get("name")): [
            (v.get("ref"), v.get("unit"), v.get("axis")) for v in g
        ]
        for g in groups.iterfind("{*}Generic/{*}*")
    }
    assert [key for key in found if key[0] in ("motion", "wrench_2", "actuators", "reading")] == [
        ("motion", "LinearDisplacement", "motion.position"),
        ("motion", "AngularDisplacement", "motion.attitude"),
        ("wrench_2", "Force", "wrench_2.force"),
        ("wrench_2", "Force", "wrench_2.lift"),
        ("wrench_2", "Torque", "wrench_2.moment"),
        ("actuators", "Generic", "actuators.ch1"),
        ("reading", "Generic", "reading.said"),
        ("reading", "LinearDisplacement", "reading.depth"),
        ("reading", "AngularDisplacement", "reading.heel"),
    ]
    assert found["wrench_2", "Torque", "wrench_2.moment"] == [
        (f"moment_2.{axis}", "N.m", axis) for axis in "xyz"
    ]
    assert found["reading", "AngularDisplacement", "reading.heel"] == [
        ("attitude.phi", "rad", None)
    ]


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("</OspModelDescription>", "", "not XML"),
        ("OspModelDescription ", "Osp ", "not XML"),
        ('ref="u"', 'ref="uu"', "Variable .*: unknown variable 'uu'"),
        ('ref="u"', "", "Variable .*: has no ref"),
        ('<Generic name="actuatorLimits">', "<Generic>", "Generic .*: has no name"),
        ("linear mechanical port", "actuatorLimits", "two groups are called 'actuatorLimits'"),
        ('ref="q[2]"', 'ref="q[1]"', "two members are called"),
    ],
)
def test_mistakes_name_the_file(before: str, after: str, message: str, slave: Path) -> None:
    text = OTHERS.replace("{namespace}", "")
    assert before in text
    path = beside(slave, text.replace(before, after, 1))
    with pytest.raises(InputError, match=message) as caught:
        load_fmu(slave)
    assert str(caught.value).startswith(f"{path}: ")
