"""SSP packages read and run: each against the closed form of a hull with a damper."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.system.assembling.assembly import assemble
from seatrial.trial.files.trial import load_trial
from seatrial_kits.interchange.ssp.reading import read_ssp

from .ssp_files import (
    BACK,
    BINDING,
    DAMPER,
    EIGHT,
    HULL,
    MINIMAL,
    STEP,
    SUB,
    THERE,
    TO_SUB,
    Yard,
    bound,
    description,
    linear,
    nested,
    parameter_set,
    real,
    run,
    speed,
    system,
)

COMPASS = """<ssd:Component name="compass" source="resources/Compass.fmu"><ssd:Connectors>
<ssd:Connector name="angle" kind="output"><ssc:Real{unit}/></ssd:Connector>
<ssd:Connector name="count" kind="output"><ssc:Integer/></ssd:Connector>
</ssd:Connectors></ssd:Component>"""
TURNED = HULL.replace(
    "<ssd:Connectors>",
    '<ssd:Connectors><ssd:Connector name="angle" kind="input"><ssc:Real/></ssd:Connector>',
)
TURN = '<ssd:Connection startElement="compass" startConnector="angle" endElement="hull" endConnector="angle"'


@pytest.fixture(scope="module")
def yard(tmp_path_factory: pytest.TempPathFactory) -> Yard:
    return Yard(tmp_path_factory.mktemp("yard"))


def test_the_minimal_package_is_its_closed_form(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp")
    assert run(path)["hull.v"] == pytest.approx(speed(8.0), rel=1e-13)
    assert read_ssp(path).notes == ()


def test_what_the_command_line_says_wins(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp")
    found = run(path, stop="1 s", step="20 ms")["hull.v"]
    assert found == pytest.approx(speed(8.0, seconds=1.0, h=0.02), rel=1e-13)


@pytest.mark.parametrize("version", ["1.0", "1.1", "2.0"])
def test_versions_1_and_2_are_read(version: str, yard: Yard, tmp_path: Path) -> None:
    ssd = MINIMAL.replace('"Minimal" version="1.0"', f'"Minimal" version="{version}"')
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert run(path)["hull.v"] == pytest.approx(speed(8.0), rel=1e-13)


def test_the_types_of_version_2_are_read(yard: Yard, tmp_path: Path) -> None:
    ssd = MINIMAL.replace('"Minimal" version="1.0"', '"Minimal" version="2.0"')
    ssd = ssd.replace("ssc:Real", "ssc:Float64")
    values = '<ssv:Parameter name="mass"><ssv:Float64 value="4"/></ssv:Parameter>'
    members = {"resources/hull.ssv": parameter_set(values, version="2.0")}
    path = yard.package(tmp_path / "x.ssp", ssd, members)
    assert run(path)["hull.v"] == pytest.approx(speed(4.0), rel=1e-13)


@pytest.mark.parametrize(("factor", "offset"), [(2.0, None), (None, 0.5), (2.0, 0.5), (None, None)])
def test_a_transformation_applies_with_its_defaults(
    factor: float | None, offset: float | None, yard: Yard, tmp_path: Path
) -> None:
    connection = THERE[:-2] + f">{linear(factor, offset)}</ssd:Connection>"
    path = yard.package(tmp_path / "x.ssp", MINIMAL.replace(THERE, connection))
    f, o = 1.0 if factor is None else factor, 0.0 if offset is None else offset
    v = 1.0
    for _ in range(200):
        v += 0.01 * -0.5 * (f * v + o) / 8.0
    assert run(path)["hull.v"] == pytest.approx(v, rel=1e-12)


def test_a_nested_system_is_a_rig_in_the_rig_and_transformations_compose(
    yard: Yard, tmp_path: Path
) -> None:
    ssd = nested(outer=linear(2.0, 1.0), inner=linear(3.0, 0.25))
    path = yard.package(tmp_path / "x.ssp", ssd)
    found = run(path)
    v = 1.0
    for _ in range(200):
        v += 0.01 * -0.5 * (3.0 * (2.0 * v + 1.0) + 0.25) / 8.0
    assert found["hull.v"] == pytest.approx(v, rel=1e-12)
    assert "sub.damper.force" in found
    assert read_ssp(path).notes == ()
    assert list(read_ssp(path).rig.top.inner) == ["sub"]


def test_what_is_inside_a_nested_system_is_set_by_path(yard: Yard, tmp_path: Path) -> None:
    system = assemble(read_ssp(yard.package(tmp_path / "x.ssp", nested())).rig)
    system.set("sub.damper.damping", 1.5, "test")
    assert system.parts["sub.damper"].given["damping"].value == 1.5
    for wrong, near in (("sub.dampr.damping", "damper"), ("sup.damper.damping", "sub")):
        with pytest.raises(InputError, match=f"did you mean '{near}'"):
            system.set(wrong, 1.5, "test")
    system.free()


@pytest.mark.parametrize(
    ("kind", "name"),
    [("application/x-ssp-package", "sub.ssp"), ("application/x-ssp-definition", "sub.ssd")],
)
def test_references_to_packages_and_descriptions_are_followed(
    kind: str, name: str, yard: Yard, tmp_path: Path
) -> None:
    # The FMUs' sources are relative to the description that names them.
    elements = DAMPER.replace("resources/", "") if name == "sub.ssd" else DAMPER
    inner = description(SUB.format(elements=elements, inner="", bindings=""))
    data: str | bytes = inner
    if name == "sub.ssp":
        data = yard.package(tmp_path / "inner.ssp", inner).read_bytes()
    more = bound(real("damper.damping", 1.5))
    sub = (
        f'<ssd:Component name="sub" type="{kind}" source="resources/{name}">{more}</ssd:Component>'
    )
    ssd = description(system(sub + HULL, TO_SUB.format(outer="")))
    path = yard.package(tmp_path / "x.ssp", ssd, {f"resources/{name}": data})
    assert run(path)["hull.v"] == pytest.approx(speed(8.0, 1.5), rel=1e-13)


@pytest.mark.parametrize(
    ("inner", "outer", "damping"),
    [
        (real("damper.damping", 3.0), "", 3.0),
        (real("damper.damping", 3.0), real("sub.damper.damping", 4.0), 4.0),
        (real("damper.damping", 3.0) + real("damper.damping", 2.0), "", 2.0),
    ],
)
def test_an_outer_or_later_binding_wins(
    inner: str, outer: str, damping: float, yard: Yard, tmp_path: Path
) -> None:
    ssd = nested(bindings=bound(inner), before=bound(outer))
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert run(path)["hull.v"] == pytest.approx(speed(8.0, damping), rel=1e-13)


def test_a_binding_of_the_system_with_a_prefix(yard: Yard, tmp_path: Path) -> None:
    binding = BINDING.replace("source=", 'prefix="hull." source=')
    hull = HULL.replace(BINDING, "")
    ssd = description(system(hull + DAMPER, THERE + BACK, before=binding))
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert run(path)["hull.v"] == pytest.approx(speed(8.0), rel=1e-13)


GRAM = '<ssv:Units><ssc:Unit name="{name}"><ssc:BaseUnit kg="1" factor="0.001"/></ssc:Unit></ssv:Units>'


@pytest.mark.parametrize(
    ("unit", "definition"), [("g", ""), ("g", "g"), ("grain of sea", "grain of sea")]
)
def test_units_of_values_are_converted(
    unit: str, definition: str, yard: Yard, tmp_path: Path
) -> None:
    after = GRAM.format(name=definition) if definition else ""
    values = parameter_set(real("mass", 4000.0, unit), after=after)
    path = yard.package(tmp_path / "x.ssp", members={"resources/hull.ssv": values})
    assert run(path)["hull.v"] == pytest.approx(speed(4.0), rel=1e-13)


def test_values_of_every_type_reach_their_variables(yard: Yard, tmp_path: Path) -> None:
    values = parameter_set(
        real("mass", 2.5)
        + '<ssv:Parameter name="label"><ssv:String value="a &lt; &#10;b"/></ssv:Parameter>'
        + '<ssv:Parameter name="on"><ssv:Boolean value="1"/></ssv:Parameter>'
        + '<ssv:Parameter name="count"><ssv:Enumeration name="gear" value="ahead"/></ssv:Parameter>',
        after='<ssv:Enumerations><ssc:Enumeration name="gear"><ssc:Item name="astern" value="1"/>'
        '<ssc:Item name="ahead" value="7"/></ssc:Enumeration></ssv:Enumerations>',
    )
    path = yard.package(tmp_path / "x.ssp", members={"resources/hull.ssv": values})
    given = read_ssp(path).rig.file.components["hull"].set
    assert given == {"mass": 2.5, "label": "a < \nb", "on": True, "count": 7}


@pytest.mark.parametrize(
    ("suppress", "transformation", "expected"),
    [
        ("", "", math.pi / 2),
        ('suppressUnitConversion="true"', "", 90.0),
        ("", linear(2.0, 1.0), math.pi + 1.0),
        ('suppressUnitConversion="1"', linear(2.0, 1.0), 181.0),
    ],
)
def test_units_of_connections_are_converted_before_the_transformation(
    suppress: str, transformation: str, expected: float, yard: Yard, tmp_path: Path
) -> None:
    connection = f"{TURN} {suppress}>{transformation}</ssd:Connection>"
    ssd = description(system(COMPASS.format(unit="") + TURNED, connection), stop="0.01")
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert run(path)["hull.turned"] == pytest.approx(expected, rel=1e-14)


def test_an_integer_feeds_a_real(yard: Yard, tmp_path: Path) -> None:
    connection = TURN.replace('startConnector="angle"', 'startConnector="count"') + "/>"
    ssd = description(system(COMPASS.format(unit="") + TURNED, connection), stop="0.01")
    assert run(yard.package(tmp_path / "x.ssp", ssd))["hull.turned"] == 3.0


def test_a_connection_may_be_written_from_its_input(yard: Yard, tmp_path: Path) -> None:
    connection = '<ssd:Connection startElement="damper" startConnector="v" endElement="hull" endConnector="v"/>'
    path = yard.package(tmp_path / "x.ssp", MINIMAL.replace(THERE, connection))
    assert run(path)["hull.v"] == pytest.approx(speed(8.0), rel=1e-13)


OMS = """<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations
xmlns:oms="https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd">
<oms:SimulationInformation><oms:FixedStepMaster description="oms-ma" stepSize="0.005"/>
</oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations>"""
HINT = """<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
<osp:StepSizeHint value="{value}"/></ssc:Annotation></ssd:Annotations>"""


def test_the_step_comes_from_osp_then_omsimulator_then_hints_then_us(
    yard: Yard, tmp_path: Path
) -> None:
    both = MINIMAL.replace("</ssd:System>", f"{OMS}</ssd:System>")
    hinted = MINIMAL.replace(STEP, "").replace(BINDING, BINDING + HINT.format(value=0.06))
    hinted = hinted.replace(
        "</ssd:Connectors></", "</ssd:Connectors>" + HINT.format(value=0.04) + "</"
    )
    cases = [
        (both, 10_000_000, "OMSimulator's step"),
        (both.replace(STEP, ""), 5_000_000, None),
        (hinted, 20_000_000, "0.02 s"),
        (MINIMAL.replace(STEP, ""), 10_000_000, "names no step size"),
    ]
    for index, (ssd, step_ns, note) in enumerate(cases):
        read = read_ssp(yard.package(tmp_path / f"{index}.ssp", ssd))
        assert read.rig.step_ns == step_ns
        assert [text for text in read.notes if note and note in text] == list(read.notes)


def test_a_component_steps_at_its_own_hint(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(
        tmp_path / "x.ssp", MINIMAL.replace(BINDING, BINDING + HINT.format(value=0.04))
    )
    assert run(path)["hull.v"] == pytest.approx(speed(8.0, h=0.04), rel=1e-13)


def test_a_package_without_stop_time_needs_one(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp", MINIMAL.replace('stopTime="2.0"', ""))
    with pytest.raises(InputError, match="--set stop"):
        load_trial(str(path))
    assert run(path, stop="1 s")["hull.v"] == pytest.approx(speed(8.0, seconds=1.0), rel=1e-13)


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ("</ssd:Connections>", '</ssd:Connections><ssd:SystemGeometry x1="0" y1="0" x2="1" y2="1"/>', "geometry"),
        (EIGHT, parameter_set(real("mas", 8.0)), "'mas' fits no variable"),
        (EIGHT, parameter_set(real("mass", 8.0) + real("force", 1.0)), "is fed by a connection"),
        (BINDING, BINDING + '<ssd:Annotations><ssc:Annotation type="org.other"/></ssd:Annotations>', "'org.other'"),
    ],
)  # fmt: skip
def test_what_does_not_change_the_result_is_a_note(
    old: str, new: str, note: str, yard: Yard, tmp_path: Path
) -> None:
    members = {"resources/hull.ssv": EIGHT.replace(old, new)}
    read = read_ssp(yard.package(tmp_path / "x.ssp", MINIMAL.replace(old, new), members))
    assert [text for text in read.notes if note in text] == list(read.notes) != []


def test_other_variants_in_a_package_are_named(yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp", members={"Fast.ssd": MINIMAL})
    assert read_ssp(path).notes == ("x.ssp: variants are not read: Fast.ssd",)
