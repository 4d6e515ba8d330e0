"""SSP packages that are wrong, odd or hostile: an InputError that says where, never more."""

from __future__ import annotations

import re
import time
import zipfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.interchange.ssp.reading import read_ssp
from seatrial_kits.interchange.ssp.tools import findings

from .ssp_files import (
    BINDING,
    DAMPER,
    EIGHT,
    HULL,
    MINIMAL,
    SUB,
    THERE,
    TO_SUB,
    Yard,
    bound,
    description,
    linear,
    parameter_set,
    real,
    run,
    speed,
    system,
)


@pytest.fixture(scope="module")
def yard(tmp_path_factory: pytest.TempPathFactory) -> Yard:
    return Yard(tmp_path_factory.mktemp("yard"))


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_ssp(path)
    return str(caught.value)


MAPPING = """<ssd:ParameterMapping type="a/b"><ssm:ParameterMapping
xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping" version="1.0"/>
</ssd:ParameterMapping>"""
DICTIONARY = """<ssd:SignalDictionaryReference name="d" dictionary="x"/>"""
TABLE = '<ssc:{}MappingTransformation><ssc:MapEntry source="{}" target="{}"/></ssc:{}MappingTransformation>'

WRONG = [
    # (replaced, by, what the message says)
    (THERE, THERE.replace('"hull"', '"hul"'), "line 18: unknown element 'hul'; did you mean 'hull'"),
    (THERE, THERE.replace('endConnector="v"', 'endConnector="w"'), "unknown connector 'w'"),
    (THERE, THERE + THERE, "v is fed twice"),
    (THERE, THERE[:-2] + ">" + TABLE.format("Boolean", "true", "false", "Boolean") + "</ssd:Connection>", "BooleanMappingTransformation needs connectors of type bool"),
    (THERE, THERE[:-2] + ">" + TABLE.format("Integer", "1", "2", "Integer") + "</ssd:Connection>", "needs connectors of type int, 'v' is of type float"),
    (THERE, THERE[:-2] + ">" + TABLE.format("Enumeration", "a", "b", "Enumeration") + "</ssd:Connection>", "EnumerationMappingTransformation needs"),
    ('"resources/Damper.fmu"', '"../Damper.fmu"', "'../Damper.fmu' is outside the package"),
    ('"resources/Damper.fmu"', '"resources/%2e%2e/../../x.fmu"', "is outside the package"),
    ('"resources/Damper.fmu"', '"file:///etc/passwd"', "only files in the package"),
    ('"resources/Damper.fmu"', '"http://localhost/x.fmu"', "only files in the package"),
    ('"resources/Damper.fmu"', '"/etc/passwd"', "only files in the package"),
    ('"resources/Damper.fmu"', '"resources/Dumper.fmu"', "there is no such file"),
    ('"resources/Damper.fmu"', '"#root"', "one system with this id is needed, found 0"),
    ('"resources/Damper.fmu"', '"resources/hull.ssv"', "the name of an FMU must end in .fmu"),
    ('name="damper" source', 'name="hull" source', "a second element is called 'hull'"),
    ('name="damper" source', 'name="damper" type="x/y" source', "of type 'x/y' are not supported"),
    ('name="damper" source', 'name="damper" implementation="ScheduledExecution" source', "ScheduledExecution is not supported"),
    ('name="damper" source', 'name="damper" implementation="x" source', "implementation: one of any, CoSimulation"),
    ('source="resources/hull.ssv"/>', f'source="resources/hull.ssv">{MAPPING}</ssd:ParameterBinding>', "mappings of type 'a/b' are not supported"),
    ('source="resources/hull.ssv"', 'source="resources/hull.ssv" sourceBase="component"', "there is no such file"),
    ("</ssd:Elements>", DICTIONARY + "</ssd:Elements>", "unknown signal dictionary 'x'"),
    ('stopTime="2.0"', 'stopTime="soon"', "line 19"),
    ('stopTime="2.0"', 'stopTime="INF"', "a finite number is needed, found 'INF'"),
    ('baseStepSize="0.01"', 'baseStepSize="-1"', "must be above 0"),
    ('baseStepSize="0.01"', 'baseStepSize="1e300"', "must be above 0, at most 9e+09"),
    ('"resources/Damper.fmu"', f'"resources/{"a" * 300}.fmu"', "File name too long"),
    ('kind="output"><ssc:Real/>', 'kind="output"><ssc:Real unit="kn"/>', "in another unit than the FMU's variable, which is in m/s"),
    ('kind="output"><ssc:Real/>', 'kind="output"><ssc:Real unit="kg"/>', "in another unit than the FMU's"),
    ('endConnector="v"', 'endConnector="w"', "unknown connector 'w'"),
    ('kind="output"', 'kind="outptu"', "kind: one of"),
    ('"Minimal" version="1.0"', '"Minimal" version="3.0"', "SSP version '3.0'; 1.0 and 2.0 are read"),
    ('"Minimal" version="1.0"', '"Minimal"', "version"),
    ("ssd:SystemStructureDescription", "ssd:System", "ssd:SystemStructureDescription is needed"),
    ("<ssd:Connections>", "<ssd:Nonsense/><ssd:Connections>", "line 18: ssd:Nonsense in ssd:System is not supported"),
    ("</ssd:System>", "", "not XML"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "reason"), WRONG)
def test_what_is_wrong_is_named(
    old: str, new: str, reason: str, yard: Yard, tmp_path: Path
) -> None:
    assert old in MINIMAL
    message = refused(yard.package(tmp_path / "x.ssp", MINIMAL.replace(old, new)))
    assert message.startswith("x.ssp: SystemStructure.ssd: ")
    assert "line " in message
    assert reason in message


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (real("mass", "heavy"), "line 5: a finite number is needed, found 'heavy'"),
        (real("mass", "NaN"), "a finite number is needed, found 'NaN'"),
        (real("mass", 8, "m"), "unit 'm' cannot be converted to 'kg'"),
        (real("mass", 8, "stone of old"), "cannot be converted"),
        (real("label", 8), "is of type float, its variable is of type str"),
        ('<ssv:Parameter name="mass"/>', "line 5: parameter 'mass': one value is needed, found 0"),
        ('<ssv:Parameter name="count"><ssv:Enumeration value="x"/></ssv:Parameter>', "item 'x'"),
        ('<ssv:Parameter name="on"><ssv:Boolean value="yes"/></ssv:Parameter>', "yes"),
    ],
)
def test_wrong_values_are_named(values: str, reason: str, yard: Yard, tmp_path: Path) -> None:
    members = {"resources/hull.ssv": parameter_set(values)}
    message = refused(yard.package(tmp_path / "x.ssp", members=members))
    assert message.startswith("x.ssp: resources/hull.ssv: line ")
    assert reason in message


@pytest.mark.parametrize("value", ["1_0", "9" * 400])
def test_integers_of_version_2_are_numbers_that_fit(value: str, yard: Yard, tmp_path: Path) -> None:
    values = f'<ssv:Parameter name="mass"><ssv:Int64 value="{value}"/></ssv:Parameter>'
    members = {"resources/hull.ssv": parameter_set(values, version="2.0")}
    message = refused(yard.package(tmp_path / "x.ssp", members=members))
    assert message.startswith("x.ssp: resources/hull.ssv: line ")


def test_units_whose_ratio_no_double_holds_are_refused(yard: Yard, tmp_path: Path) -> None:
    def sub(name: str, unit: str, elements: str, to: str) -> str:
        return f"""<ssd:System name="{name}"><ssd:Connectors>
        <ssd:Connector name="in" kind="input"><ssc:Real unit="{unit}"/></ssd:Connector>
        </ssd:Connectors><ssd:Elements>{elements}</ssd:Elements><ssd:Connections>
        <ssd:Connection startConnector="in" {to}/></ssd:Connections></ssd:System>"""

    units = "".join(
        f'<ssc:Unit name="{n}"><ssc:BaseUnit m="1" s="-1" factor="{f}"/></ssc:Unit>'
        for n, f in (("huge", "1e308"), ("tiny", "1e-308"))
    )
    for units_in in (("huge", "tiny"), ("tiny", "huge")):
        inner = sub("b", units_in[1], DAMPER, 'endElement="damper" endConnector="v"')
        outer = sub("a", units_in[0], inner, 'endElement="b" endConnector="in"')
        connection = THERE.replace('"damper" endConnector="v"', '"a" endConnector="in"')
        ssd = description(system(HULL + outer, connection), after=f"<ssd:Units>{units}</ssd:Units>")
        assert "the factor is beyond" in refused(yard.package(tmp_path / "x.ssp", ssd))


@pytest.mark.parametrize("key", ["startTime", "stopTime"])
def test_times_beyond_what_is_counted_are_refused(key: str, yard: Yard, tmp_path: Path) -> None:
    ssd = re.sub(f'{key}="[^"]*"', f'{key}="1e300"', MINIMAL)
    with pytest.raises(InputError, match=r"'1e\+300 s' is beyond 9e\+09 s"):
        run(yard.package(tmp_path / "x.ssp", ssd))


@pytest.mark.parametrize("name", ["%00", "a" * 300])
def test_a_check_passes_over_parameter_sets_that_no_file_can_be(
    name: str, yard: Yard, tmp_path: Path
) -> None:
    ssd = MINIMAL.replace("resources/hull.ssv", f"resources/{name}.ssv")
    findings(yard.package(tmp_path / "x.ssp", ssd))


def test_version_2_has_no_schema_here_but_what_is_wrong_does_not_pass(
    yard: Yard, tmp_path: Path
) -> None:
    second = MINIMAL.replace('"Minimal" version="1.0"', '"Minimal" version="2.0"')
    nameless = second.replace('name="damper" ', "")
    elements = f"<ssd:Elements>{DAMPER.replace('damper', 'second')}</ssd:Elements>"
    connections = f"<ssd:Connections>{THERE}</ssd:Connections>"
    doubled = THERE[:-2] + f">{linear(2.0)}{linear(3.0)}</ssd:Connection>"
    for index, (ssd, reason) in enumerate(
        [
            (second.replace("</ssd:System>", f"{elements}</ssd:System>"), "a second ssd:Elements"),
            (second.replace("</ssd:System>", f"{connections}</ssd:System>"), "a second ssd:Conn"),
            (second.replace("</ssd:System>", '</ssd:System><ssd:System name="b"/>'), "a second"),
            (second.replace(THERE, doubled), "a second ssc:LinearTransformation"),
            (nameless, "attribute 'name' is missing"),
        ]
    ):
        assert reason in refused(yard.package(tmp_path / f"{index}.ssp", ssd))


def test_a_connection_that_leads_back_to_itself_is_refused(yard: Yard, tmp_path: Path) -> None:
    ring = """<ssd:System name="{}"><ssd:Connectors>
    <ssd:Connector name="in" kind="input"><ssc:Real/></ssd:Connector>
    <ssd:Connector name="out" kind="output"><ssc:Real/></ssd:Connector></ssd:Connectors>
    <ssd:Connections><ssd:Connection startConnector="in" endConnector="out"/></ssd:Connections></ssd:System>"""
    connections = """<ssd:Connection startElement="a" startConnector="out" endElement="b" endConnector="in"/>
    <ssd:Connection startElement="b" startConnector="out" endElement="a" endConnector="in"/>
    <ssd:Connection startElement="b" startConnector="out" endElement="damper" endConnector="v"/>"""
    ssd = description(system(ring.format("a") + ring.format("b") + DAMPER, connections))
    assert "leads back to itself" in refused(yard.package(tmp_path / "x.ssp", ssd))


def test_cyclic_and_deep_references_are_refused(yard: Yard, tmp_path: Path) -> None:
    itself = '<ssd:Component name="sub" type="application/x-ssp-definition" source="{}"/>'
    ssd = description(system(HULL + itself.format("resources/a.ssd")))
    members = {
        "resources/a.ssd": description(system(itself.format("b.ssd"))),
        "resources/b.ssd": description(system(itself.format("a.ssd"))),
    }
    message = refused(yard.package(tmp_path / "x.ssp", ssd, members))
    assert "resources/a.ssd refers to itself" in message
    deep = DAMPER
    for index in range(40):
        deep = f'<ssd:System name="s{index}"><ssd:Elements>{deep}</ssd:Elements></ssd:System>'
    message = refused(yard.package(tmp_path / "y.ssp", description(system(deep))))
    assert "systems nest deeper than" in message


@pytest.mark.slow
def test_references_that_double_at_each_level_end(yard: Yard, tmp_path: Path) -> None:
    two = "".join(
        f'<ssd:Component name="{n}" type="application/x-ssp-definition" source="{{0}}.ssd"/>'
        for n in "ab"
    )
    members: dict[str, str | bytes] = {
        f"{level}.ssd": description(system(two.format(level + 1))) for level in range(1, 20)
    }
    begun = time.perf_counter()
    for last in (DAMPER, '<ssd:System name="empty"/>'):
        members["20.ssd"] = description(system(last))
        path = yard.package(tmp_path / "x.ssp", description(system(two.format(1))), members)
        assert "more than 1000 " in refused(path)
    assert time.perf_counter() - begun < 60.0


def test_an_fmu_that_cannot_be_loaded_is_named_with_its_line(yard: Yard, tmp_path: Path) -> None:
    members = {"resources/Damper.fmu": "no archive"}
    message = refused(yard.package(tmp_path / "x.ssp", members=members))
    assert message.startswith("x.ssp: SystemStructure.ssd: line 14: ")


BOMB = """<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">
<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">
<!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;"><!ENTITY e "&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;">]>"""
OUTSIDE = """<?xml version="1.0"?><!DOCTYPE x [<!ENTITY e SYSTEM "{}">]>"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("kind", ["bomb", "file"])
@pytest.mark.parametrize("place", ["SystemStructure.ssd", "resources/hull.ssv"])
def test_entities_are_refused(
    encoding: str, kind: str, place: str, yard: Yard, tmp_path: Path
) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("do not read", "utf-8")
    head = BOMB if kind == "bomb" else OUTSIDE.format(secret.as_uri())
    text = {"SystemStructure.ssd": MINIMAL, "resources/hull.ssv": EIGHT}[place]
    text = text.replace('<?xml version="1.0" encoding="UTF-8"?>', "").replace(
        'name="', 'description="&e;" name="', 1
    )
    members = {place: (head + text).encode(encoding)}
    message = refused(yard.package(tmp_path / "x.ssp", members=members))
    assert "DOCTYPE" in message or "not XML" in message
    assert "do not read" not in message


@pytest.mark.interop
def test_a_package_cut_off_anywhere_is_refused(yard: Yard, tmp_path: Path) -> None:
    whole = yard.package(tmp_path / "x.ssp").read_bytes()
    cut = tmp_path / "cut.ssp"
    for length in [*range(64), *range(64, len(whole) - 1, 997), len(whole) - 1]:
        cut.write_bytes(whole[:length])
        refused(cut)


@pytest.mark.parametrize("name", ["../evil.ssv", "/tmp/evil.ssv", "a/../../evil.ssv"])
def test_members_outside_the_folder_are_refused(name: str, yard: Yard, tmp_path: Path) -> None:
    path = yard.package(tmp_path / "x.ssp", members={name: "evil"})
    assert "would be unpacked outside" in refused(path)
    assert not list(tmp_path.rglob("evil*"))


def test_a_zip_without_description_and_a_text_are_no_packages(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.ssp", "w") as archive:
        archive.writestr("readme.txt", "hello")
    (tmp_path / "b.ssp").write_text("hello", "utf-8")
    assert "there is no SystemStructure.ssd in it" in refused(tmp_path / "a.ssp")
    for name in ("b.ssp", "none.ssp", "."):
        refused(tmp_path / name)


@pytest.mark.slow
@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    names=st.lists(
        st.text(st.characters(exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff"), min_size=1, max_size=8),
        min_size=2, max_size=2, unique=True,
    )
)  # fmt: skip
def test_components_of_any_name_run(names: list[str], yard: Yard, tmp_path: Path) -> None:
    ssd = MINIMAL
    for old, new in zip(("hull", "damper"), names, strict=True):
        for word in ("name", "startElement", "endElement"):
            ssd = ssd.replace(f'{word}="{old}"', f"{word}={quoteattr(new)}")
    path = yard.package(tmp_path / "x.ssp", ssd)
    components = read_ssp(path).rig.file.components
    assert len(components) == 2
    assert all(name.isascii() and name.isidentifier() for name in components)


def test_names_that_become_equal_are_kept_apart(yard: Yard, tmp_path: Path) -> None:
    ssd = MINIMAL.replace('"hull"', '"a-b"').replace('"damper"', '"a b"')
    path = yard.package(tmp_path / "x.ssp", ssd)
    assert list(read_ssp(path).rig.file.components) == ["a_b", "a_b_2"]
    assert run(path)["a_b.v"] == pytest.approx(speed(8.0), rel=1e-13)


def test_ten_thousand_connectors_are_read_in_bounded_time(yard: Yard, tmp_path: Path) -> None:
    many = "".join(
        f'<ssd:Connector name="c{i}" kind="output"><ssc:Real/>'
        '<ssd:ConnectorGeometry x="0" y="0"/></ssd:Connector>'
        for i in range(10_000)
    )
    inner = f'<ssd:System name="many"><ssd:Connectors>{many}</ssd:Connectors></ssd:System>'
    values = "".join(real(f"many.x{i}", i) for i in range(2_000))
    ssd = description(system(HULL + DAMPER + inner, THERE, before=bound(values)))
    path = yard.package(tmp_path / "x.ssp", ssd)
    begun = time.perf_counter()
    read = read_ssp(path)
    assert time.perf_counter() - begun < 20.0
    assert list(read.rig.components) == ["hull", "damper"]


def test_nested_systems_may_have_the_same_names(yard: Yard, tmp_path: Path) -> None:
    sub = SUB.format(elements=DAMPER, inner=linear(2.0), bindings="")
    connections = TO_SUB.format(outer="")
    twice = (sub + sub.replace('name="sub"', 'name="sub_damper"')).replace(BINDING, "")
    ssd = description(
        system(twice + DAMPER.replace('"damper"', '"sub_damper_damper"') + HULL, connections)
    )
    names = list(read_ssp(yard.package(tmp_path / "x.ssp", ssd)).rig.components)
    assert names == ["sub.damper", "sub_damper.damper", "sub_damper_damper", "hull"]


def test_names_of_systems_that_become_equal_are_kept_apart(yard: Yard, tmp_path: Path) -> None:
    sub = SUB.format(elements=DAMPER, inner="", bindings="")
    twice = sub.replace('"sub"', '"a.b"') + sub.replace('"sub"', '"a b"')
    connections = TO_SUB.format(outer="").replace('"sub"', '"a b"')
    ssd = description(system(twice + HULL, connections)).replace(BINDING, "")
    path = yard.package(tmp_path / "x.ssp", ssd)
    read = read_ssp(path)
    assert list(read.rig.components) == ["a_b.damper", "a_b_2.damper", "hull"]
    assert "a b is called a_b_2 here" in read.notes
    found = run(path)
    assert found["a_b_2.damper.force"] == -0.5 * found["hull.v"] != found["a_b.damper.force"]
