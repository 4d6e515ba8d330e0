"""Model descriptions that are hostile, malformed or odd: refused with the path, or usable."""

from __future__ import annotations

import contextlib
import time
import zipfile
from pathlib import Path

import fmpy
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from benchmarks.big_models import description
from seatrial.errors import InputError
from seatrial.fmi.files import xmlfile
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import SLAVES, changed, described_fmu, read, started

FMI2 = (SLAVES / "fmi2.xml").read_text("utf-8")
FMI3 = (SLAVES / "fmi3.xml").read_text("utf-8")
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
BODY = FMI2.removeprefix(HEAD)
BOMB = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 30))


def refused(path: Path, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        load_fmu(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "<!DOCTYPE fmiModelDescription>" + BODY,
        HEAD + '<!DOCTYPE x SYSTEM "file:///etc/passwd">' + BODY,
        HEAD + '<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]>' + BODY.replace("fmi2", "&e;", 1),
        HEAD + f'<!DOCTYPE x [<!ENTITY a0 "lol">{BOMB}]>' + BODY.replace("<ModelVariables>", "<ModelVariables>&a29;"),
        HEAD + f'<!DOCTYPE x [<!ENTITY a0 "lol">{BOMB}]>' + BODY.replace('"{fmi2}"', '"&a29;"'),
        (HEAD + "<!DOCTYPE fmiModelDescription>" + BODY).replace("UTF-8", "UTF-16").encode("utf-16"),
    ],
    ids=["plain", "external", "external entity", "bomb", "bomb in an attribute", "UTF-16"],
)  # fmt: skip
def test_document_types_are_refused_before_they_act(text: str | bytes, tmp_path: Path) -> None:
    begun = time.perf_counter()
    refused(
        described_fmu(tmp_path / "x.fmu", text), r"modelDescription\.xml: (has a document|not XML)"
    )
    assert time.perf_counter() - begun < 2.0


@pytest.mark.parametrize("place", ["ScalarVariable", "Unit"])
def test_a_name_that_no_page_could_show(place: str, tmp_path: Path) -> None:
    """Of a variable, which is streamed, and of what stays in the tree."""
    name = "a" * 5_000_000
    variable, unit = (name, "u") if place == "ScalarVariable" else ("v", name)
    text = (
        '<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g">'
        f'<UnitDefinitions><Unit name="{unit}"/></UnitDefinitions>'
        '<CoSimulation modelIdentifier="m"/><ModelVariables>'
        f'<ScalarVariable name="{variable}" valueReference="0" causality="output"><Real/>'
        "</ScalarVariable></ModelVariables><ModelStructure/></fmiModelDescription>"
    )
    path = tmp_path / "long.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", text)
    with pytest.raises(InputError, match="a name of 5000000 characters") as error:
        load_fmu(path)
    assert len(str(error.value)) < 1000


def test_xml_that_is_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = described_fmu(tmp_path / "x.fmu", FMI2 + " " * 100_000)
    monkeypatch.setattr(xmlfile, "LARGEST_STREAMED", 100_000)
    refused(path, "more than 100000")


def test_a_description_larger_than_what_is_held_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(xmlfile, "LARGEST_XML", 20_000)
    monkeypatch.setattr(xmlfile, "_BLOCK", 1_000)
    text = description(2, 1_000)
    assert len(text) > 5 * 20_000
    assert len(load_fmu(described_fmu(tmp_path / "x.fmu", text)).variables) == 1_000
    units = "<UnitDefinitions>" + '<Unit name="a"/>' * 2_000 + "</UnitDefinitions>"
    long = described_fmu(
        tmp_path / "y.fmu", text.replace("<ModelVariables>", units + "<ModelVariables>")
    )
    refused(long, "no variable in its first 20000 bytes")
    monkeypatch.setattr(xmlfile, "MOST_ELEMENTS", 500)
    odd = text.replace("</ModelVariables>", "<Odd/>" * 600 + "</ModelVariables>")
    refused(described_fmu(tmp_path / "z.fmu", odd), "more than 500 elements besides variables")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not XML"),
        ("not XML", "not XML"),
        (FMI2[:500], "not XML"),
        ("<html/>", "found html with fmiVersion None"),
        ("<fmiModelDescription/>", "found fmiModelDescription with fmiVersion None"),
        ('<fmiModelDescription fmiVersion="2.0"/>', "FMI 2.0, nothing; co-simulation or model exchange of FMI 1.0, 2.0 or 3.0"),
        ('<fmiModelDescription fmiVersion="2.0"><CoSimulation/></fmiModelDescription>', "no ModelVariables"),
        ('<fmiModelDescription fmiVersion="1.0"/>', "no ModelVariables"),
        ('<fmiModelDescription fmiVersion="1.0"><Implementation/></fmiModelDescription>', "no ModelVariables"),
        (FMI3.replace("CoSimulation", "ScheduledExecution"), "FMI 3.0, scheduled execution; co-simulation"),
        (FMI3.replace('"3.0"', '"3.0-beta.2"'), "FMI 3.0-beta.2, co-simulation; "),
        (FMI2.replace('"2.0"', '"4.0"'), "FMI 4.0, co-simulation; "),
    ],
)  # fmt: skip
def test_what_is_no_co_simulation_fmu(text: str, message: str, tmp_path: Path) -> None:
    refused(described_fmu(tmp_path / "x.fmu", text), message)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('name="j"', 'name="i"', "two variables are called 'i'"),
        ('name="j"', 'name=""', "variable '' .*it has no name"),
        ('valueReference="2" causality="output"', 'valueReference="-1" causality="output"', "not from 0 to"),
        ('valueReference="2" causality="output"', 'valueReference="4294967296" causality="output"', "not from 0 to"),
        ('valueReference="2" causality="output"', 'valueReference="two" causality="output"', "'j' .*'two'"),
        ('valueReference="2" causality="output"', 'causality="output"', "'j' .*no valueReference"),
        ('<Real start="1" min="0"/>', "", "'k' .*it has no type"),
        ("<Integer/>", "<Nothing/>", "'j' .*it has no type"),
        ("<Integer/>", '<Integer declaredType="Nowhere"/>', "'j' .*'Nowhere' is not defined"),
        ('<Integer start="0"/>', '<Integer start="1.5"/>', r"'i' \(line \d+\): .*1\.5"),
        ('<Boolean start="false"/>', '<Boolean start="yes"/>', "'b' .*'yes' is not true or false"),
        ('min="-50"', 'min="low"', "'speed' .*low"),
        ('factor="0.5144444444444445"', 'factor="0"', r"unit 'knot_x' has factor 0\.0"),
        ('factor="0.5144444444444445"', 'factor="NaN"', "unit 'knot_x' has factor nan"),
        ('index="15"', 'index="150"', "ModelStructure: there is no variable 150"),
        ('index="15"', "", "ModelStructure: "),
        ('<ScalarVariable name="j"', '<Variable name="j"/><ScalarVariable name="j"', r"Variable \(line \d+\) is no variable"),
        ('modelIdentifier="fmi2"', 'modelIdentifier="../../fmi2"', "modelIdentifier '../../fmi2' is not the name"),
        ('modelIdentifier="fmi2"', 'modelIdentifier="a\\b"', "modelIdentifier .* is not the name"),
        ('modelIdentifier="fmi2"', 'modelIdentifier=".."', "modelIdentifier .* is not the name"),
        ('modelIdentifier="fmi2"', "", "modelIdentifier None is not the name"),
    ],
)  # fmt: skip
def test_wrong_attributes(before: str, after: str, message: str, tmp_path: Path) -> None:
    assert before in FMI2
    refused(described_fmu(tmp_path / "x.fmu", FMI2.replace(before, after, 1)), message)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('start="0 0 0"', 'start="0 0"', "'in_Float32' .*2 start values for 3 elements"),
        ('<Dimension start="3"/>', '<Dimension start="2000000"/>', "an array of 2000000"),
        ('<Dimension start="3"/>', '<Dimension start="-3"/>', "an array of -3"),
        ('<Dimension valueReference="8"/>', '<Dimension valueReference="88"/>', "valueReference of a structural parameter is needed, found 88"),
        ('<Dimension valueReference="8"/>', "<Dimension/>", "structural parameter is needed, found None"),
        ('name="steps"', 'name="in_Int8[2]"', r"two variables are called 'in_Int8\[2\]'"),
        ('<Start value=""/>', '<Start value="0g"/>', "start values|hexadecimal"),
        ('intervalVariability="triggered"', "", None),
    ],
)  # fmt: skip
def test_wrong_arrays(before: str, after: str, message: str | None, tmp_path: Path) -> None:
    text = FMI3.replace(before, after, 1)
    if "0g" in after:
        text = FMI3.replace(
            'causality="input"><Dimension start="3"/><Start value=""/>',
            f'causality="input"><Dimension start="3"/>{after}',
        )
    assert text != FMI3
    path = described_fmu(tmp_path / "x.fmu", text)
    if message is None:
        assert "tick" in load_fmu(path).notes[0]
    else:
        refused(path, message)


ELEMENTS = [e for e in etree.fromstring(FMI2.encode()).iter() if e.attrib]


@pytest.mark.interop
@settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(which=st.integers(0, len(ELEMENTS) - 1), data=st.data())
def test_any_attribute_may_be_missing_or_nonsense(which: int, data, tmp_path: Path) -> None:
    root = etree.fromstring(FMI2.encode())
    element = [e for e in root.iter() if e.attrib][which]
    name = data.draw(st.sampled_from(sorted(element.attrib)))
    value = data.draw(
        st.sampled_from([None, "", "-1", "1e999", "true", "x/y", "99999999999999999999"])
    )
    if value is None:
        del element.attrib[name]
    else:
        element.set(name, value)
    path = described_fmu(tmp_path / "x.fmu", etree.tostring(root))
    with contextlib.suppress(InputError):  # no other exception
        assert load_fmu(path).variables


ODD = [
    "a.b.c",
    "'a b'.c",
    'say "x"',
    "der(x)",
    "x[1].y[2,3]",
    "été",
    "水",
    "a\tb",
    "a\nb",
    "100%s",
    "..",
    "[",
    " ",
    "a" * 5000,
]


@settings(
    max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(name=st.text(st.characters(exclude_categories=("Cs", "Cc")), min_size=1, max_size=20))
def test_odd_names_are_names(name: str, native_fmu, tmp_path: Path) -> None:
    check_name(name, native_fmu, tmp_path)


@pytest.mark.parametrize("name", ODD)
def test_names_of_every_kind(name: str, native_fmu, tmp_path: Path) -> None:
    check_name(name, native_fmu, tmp_path)


def check_name(name: str, native_fmu, tmp_path: Path) -> None:
    root = etree.fromstring(FMI2.encode())
    variable = root.find("ModelVariables/ScalarVariable[@name='k']")
    names = {e.get("name") for e in root.find("ModelVariables")}
    variable.set("name", name)
    path = tmp_path / "odd.fmu"
    changed(native_fmu("fmi2"), path, (FMI2, etree.tostring(root, encoding="unicode")))
    if name in names - {"k"}:
        refused(path, "two variables")
        return
    instance = started(open_instance(load_fmu(path), "odd"), **{name: 3.5})
    assert read(instance, name) == [3.5]
    instance.free()


def test_ten_thousand_variables(native_fmu, tmp_path: Path) -> None:
    many = "".join(
        f'<ScalarVariable name="in.a{i}.u[{k}]" valueReference="4" causality="input"><Real start="0"/></ScalarVariable>'
        f'<ScalarVariable name="out.a{i}.y[{k}]" valueReference="8" causality="output"><Real/></ScalarVariable>'
        for i in range(1000) for k in range(1, 6)
    )  # fmt: skip
    path = changed(
        native_fmu("fmi2"), tmp_path / "many.fmu", ("</ModelVariables>", many + "</ModelVariables>")
    )
    begun = time.perf_counter()
    fmu = load_fmu(path)
    instance = started(open_instance(fmu, "many"))
    names = [n for n, v in fmu.variables.items() if v.causality == "output" and n.startswith("out")]
    assert len(names) == 5000
    assert len(fmu.variables.ports["in"]) == 5000
    assert [v.name for v in fmu.variables.ports["out.a7.y"]] == [
        f"out.a7.y[{k}]" for k in range(1, 6)
    ]
    instance.writer(["in.a999.u[5]"])([3.0])
    assert set(instance.reader(names)()) == {6.0}
    instance.free()
    assert time.perf_counter() - begun < 10.0


def test_a_library_that_cannot_be_loaded_leaves_the_folder_alone(tmp_path: Path) -> None:
    path = described_fmu(tmp_path / "x.fmu", FMI2)
    before = Path.cwd()
    with pytest.raises(InputError, match=r"x\.fmu: cannot be loaded .*binaries for no platform"):
        open_instance(load_fmu(path), "x")
    broken = described_fmu(tmp_path / "broken.fmu", FMI2)
    with zipfile.ZipFile(broken, "a") as archive:
        archive.writestr(f"binaries/{fmpy.platform}/fmi2.so", b"no library")
    with pytest.raises(InputError, match="Failed to load shared library"):
        open_instance(load_fmu(broken), "x")
    assert Path.cwd() == before
