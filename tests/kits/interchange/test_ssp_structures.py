"""Structures of SSP packages: dictionaries, arrays, references, tables on connections, notes."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial_kits.interchange.ssp.reading import read_ssp

from ...fmi.models import build_model_fmu
from .ssp_files import run
from .ssp_natives import (
    NAMESPACES,
    bound,
    build,
    component,
    connection,
    connector,
    connectors,
    elements,
    linear,
    package,
    ssd,
    table,
    value,
    values,
)

U, Y = connector("u", "input"), connector("y", "output")


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return build(tmp_path_factory.mktemp("slaves"))


@pytest.fixture
def made(fmus: dict[str, bytes], tmp_path: Path):
    """Return a function that writes a package."""

    def make(inside: str, version: str = "1.0", after: str = "", **members: str | bytes) -> Path:
        files = {f"resources/{name.replace('_', '.')}": text for name, text in members.items()}
        return package(
            tmp_path / "x.ssp", ssd(inside, version=version, after=after), {**fmus, **files}
        )

    return make


def refused(path: Path, *, strict: bool = False) -> str:
    with pytest.raises(InputError) as caught:
        read_ssp(path, strict=strict)
    return str(caught.value)


# ---------------------------------------------------------------------- dictionaries

SIGNALS = f"""<ssb:SignalDictionary {NAMESPACES} version="1.0">
<ssb:DictionaryEntry name="speed"><ssc:Real unit="km/h"/></ssb:DictionaryEntry>
<ssb:DictionaryEntry name="n"><ssc:Integer/></ssb:DictionaryEntry></ssb:SignalDictionary>"""
INLINE = f"""<ssd:SignalDictionaries><ssd:SignalDictionary name="bus">{SIGNALS}
</ssd:SignalDictionary></ssd:SignalDictionaries>"""


def reference(name: str, *listed: str, dictionary: str = "bus") -> str:
    return (
        f'<ssd:SignalDictionaryReference name="{name}" dictionary="{dictionary}">'
        f"{connectors(*listed)}</ssd:SignalDictionaryReference>"
    )


def on_a_bus(dictionary: str, more: str = "") -> str:
    """Return a system in which ``a`` in m/s gives a signal that ``sub.b`` has in knots."""
    inner = f"""<ssd:System name="sub">{
        elements(
            component("b", U, Y),
            reference("here", connector("speed", "inout", unit="kn")),
            connections=connection("here/speed", "b/u", linear(2.0, 0.0)),
        )
    }</ssd:System>"""
    return (
        elements(
            component("a", U, Y),
            reference("there", connector("speed", "inout", unit="m/s")),
            inner,
            connections=connection("a/y", "there/speed") + more,
        )
        + dictionary
    )


FEED = bound(values(value("a.u", "463")))
"""The output of a is twice this: 926 m/s are 1800 kn."""


def test_a_signal_of_a_dictionary_goes_from_one_reference_to_all_others(made) -> None:
    found = run(made(FEED + on_a_bus(INLINE)))
    assert found["sub.b.y"] == pytest.approx(2.0 * 2.0 * 1800.0, rel=1e-13)


def test_a_dictionary_may_be_a_file(made) -> None:
    file = '<ssd:SignalDictionaries><ssd:SignalDictionary name="bus" source="resources/s.ssb"/></ssd:SignalDictionaries>'
    found = run(made(FEED + on_a_bus(file), s_ssb=SIGNALS))
    assert found["sub.b.y"] == pytest.approx(7200.0, rel=1e-13)


def test_a_signal_is_given_once_and_by_a_name_that_its_dictionary_has(made) -> None:
    twice = elements(
        component("a", Y),
        component("b", Y),
        reference("one", connector("speed", "inout", unit="m/s")),
        reference("two", connector("speed", "inout", unit="m/s")),
        connections=connection("a/y", "one/speed") + connection("b/y", "two/speed"),
    )
    assert "'speed' of the dictionary 'bus' is given twice" in refused(made(twice + INLINE))
    unknown = elements(component("a"), reference("one", connector("sped", "inout")))
    assert "unknown signal 'sped'; did you mean 'speed'" in refused(made(unknown + INLINE))
    nowhere = elements(component("a"), reference("one", dictionary="buss"))
    assert "unknown signal dictionary 'buss'; did you mean 'bus'" in refused(made(nowhere + INLINE))


# ---------------------------------------------------------------------- tables, arrays, clocks


@pytest.mark.parametrize(
    ("ends", "of", "made_of", "start", "expected"),
    [
        (("j", "i"), "Integer", table("Integer", ("6", "10"), ("7", "1")), ("i", "3"), 20),
        (("j", "i"), "Integer", table("Integer", ("7", "1")), ("i", "3"), 12),
        (("c", "b"), "Boolean", table("Boolean", ("true", "false")), ("b", "false"), True),
        (("mode", "mode_in"), "Enumeration", table("Enumeration", ("sail", "drift")), ("mode_in", "sail"), 1),
    ],
)  # fmt: skip
def test_tables_change_what_goes_along_a_connection(
    ends: tuple[str, str], of: str, made_of: str, start: tuple[str, str], expected: object, made
) -> None:
    output, target = ends
    top = bound(values(value(f"a.{start[0]}", start[1], of))) + elements(
        component("a", connector(output, "output", of)),
        component("b", connector(target, "input", of)),
        connections=connection(f"a/{output}", f"b/{target}", made_of),
    )
    path = made(top)
    for algorithm in ("jacobi", "plain-jacobi", "gauss-seidel", "iterated"):
        assert run(path, algorithm=algorithm)[f"b.{output}"] == expected


def test_tables_compose_through_a_systems_connectors(made) -> None:
    inner = f"""<ssd:System name="sub">{connectors(connector("in", "input", "Integer"))}{
        elements(
            component("b", connector("i", "input", "Integer")),
            connections=connection("in", "b/i", table("Integer", ("10", "11"), ("6", "99"))),
        )
    }</ssd:System>"""
    top = bound(values(value("a.i", "3", "Integer"))) + elements(
        component("a", connector("j", "output", "Integer")),
        inner,
        connections=connection("a/j", "sub/in", table("Integer", ("6", "10"))),
    )
    assert run(made(top))["sub.b.j"] == 22


def test_an_item_that_no_enumeration_has_is_refused(made) -> None:
    top = elements(
        component("a", connector("mode", "output", "Enumeration")),
        component("b", connector("mode_in", "input", "Enumeration")),
        connections=connection("a/mode", "b/mode_in", table("Enumeration", ("race", "sail"))),
    )
    assert "item 'race' is not known; the items are drift, sail" in refused(made(top))


def array(name: str, kind: str, of: str, *sizes: int) -> str:
    return connector(name, kind, of, "".join(f'<ssc:Dimension size="{s}"/>' for s in sizes))


def test_arrays_are_connected_whole_and_by_element(made) -> None:
    # All of a's vector to b's, doubled on the way; then elements of it into b's matrix, 3 by 2.
    wholes = (
        array("out_Float64", "output", "Float64", 3),
        array("in_Float64", "input", "Float64", 3),
    )
    sub = f"""<ssd:System name="sub">{connectors(array("in", "input", "Float64", 3))}{
        elements(
            component("b", *wholes, array("matrix", "input", "Float64", 3, 2), fmu="three"),
            connections=connection("in", "b/in_Float64")
            + connection("in", "b/matrix", more='startIndices="3" endIndices="2 1"'),
        )
    }</ssd:System>"""
    top = bound(values(value("a.in_Float64", "1 2 3", "Float64"))) + elements(
        component("a", *wholes, fmu="three"),
        sub,
        connections=connection("a/out_Float64", "sub/in"),
    )
    found = run(made(top, version="2.0"))
    assert [found[f"sub.b.out_Float64[{i}]"] for i in (1, 2, 3)] == [4.0, 8.0, 12.0]
    assert found["sub.b.transpose[1,2]"] == 6.0
    scalar = elements(
        component("a", *wholes, fmu="three"),
        component("b", U),
        connections=connection("a/out_Float64", "b/u", more='startIndices="2"'),
    )
    assert run(made(bound(values(value("a.in_Float64", "1 2 3"))) + scalar, "2.0"))["b.y"] == 8.0
    without = scalar.replace('startIndices="2"', "")
    assert "'out_Float64' has 3 values" in refused(made(without, "2.0"))
    assert "'out_Float64' has 3 values" in refused(made(scalar.replace('"2"', '"4"'), "2.0"))


def test_clocks_are_named(made) -> None:
    clock = connector("tick", "input", "Clock", intervalVariability="triggered")
    top = elements(component("a", clock, fmu="three"), component("b", connector("y", "output")))
    path = made(top, "2.0")
    assert any("'tick' is no variable" in note for note in read_ssp(path).notes)
    inside = connectors(clock) + elements(
        component("a", fmu="three"), connections=connection("tick", "a/tick")
    )
    assert "connections of clocks are not supported: 'tick'" in refused(made(inside, "2.0"))


# ---------------------------------------------------------------------- references

SUB = elements(component("b", U, Y), connections=connection("in", "b/u"))


def test_a_system_may_stand_in_several_places_by_its_id(made) -> None:
    first = f'<ssd:System name="first" id="one">{connectors(connector("in", "input"))}{SUB}</ssd:System>'
    again = '<ssd:Component name="again" type="application/x-ssp-definition" source="#one"/>'
    top = bound(values(value("first.in", "1"), value("again.in", "2"))) + elements(first, again)
    found = run(made(top))
    assert (found["first.b.y"], found["again.b.y"]) == (2.0, 4.0)
    endless = first.replace("</ssd:Elements>", f"{again}</ssd:Elements>")
    assert "#one refers to itself" in refused(made(elements(endless)))


def test_systems_that_double_by_their_ids_end(made) -> None:
    one = '<ssd:Component name="{}" type="application/x-ssp-definition" source="#s{}"/>'
    levels = [
        f'<ssd:System name="s{i}" id="s{i}"><ssd:Elements>{one.format("a", i + 1)}'
        f"{one.format('b', i + 1)}</ssd:Elements></ssd:System>"
        for i in range(20)
    ]
    last = f'<ssd:System name="s20" id="s20">{elements(component("b"))}</ssd:System>'
    assert "more than 1000 systems" in refused(made(elements(*levels, last)))


def test_a_package_in_a_package_has_variants(made, fmus: dict[str, bytes], tmp_path: Path) -> None:
    variants = {
        name: ssd(connectors(connector("in", "input")) + bound(values(value("b.gain", k))) + SUB)
        for name, k in (("SystemStructure.ssd", "3"), ("Fast.ssd", "5"))
    }
    members = {"Fast.ssd": variants["Fast.ssd"], **fmus}
    inner = package(tmp_path / "inner.ssp", variants["SystemStructure.ssd"], members).read_bytes()
    text = '<ssd:Component name="{}" type="application/x-ssp-package" source="resources/s.ssp{}"/>'
    both = text.format("slow", "") + text.format("fast", "#Fast.ssd")
    top = bound(values(value("slow.in", "1"), value("fast.in", "1"))) + elements(both)
    found = run(made(top, s_ssp=inner))
    assert (found["slow.b.y"], found["fast.b.y"]) == (3.0, 5.0)
    wrong = elements(text.format("a", "#Slow.ssd"))
    assert "resources/s.ssp has no 'Slow.ssd'" in refused(made(wrong, s_ssp=inner))


def test_a_component_without_source_is_an_empty_system(made) -> None:
    planned = f'<ssd:Component name="planned">{connectors(U, Y)}</ssd:Component>'
    top = bound(values(value("planned.y", "4"))) + elements(
        planned, component("a", U, Y), connections=connection("planned/y", "a/u")
    )
    path = made(top)
    assert run(path)["a.y"] == 8.0  # its connector has a start value
    assert any("a component without source is an empty system" in n for n in read_ssp(path).notes)


def test_the_implementation_that_a_package_names_is_used(made, tmp_path: Path) -> None:
    model = {"model_fmu": build_model_fmu(2, tmp_path).read_bytes()}
    for wanted, interface in (
        ("ModelExchange", "model exchange"), ("CoSimulation", "co-simulation"), ("any", None),
    ):  # fmt: skip
        path = made(
            elements(component("a", fmu="model", more=f'implementation="{wanted}"')), **model
        )
        assert read_ssp(path).rig.components["a"].entry.interface == interface
        if interface == "model exchange":
            assert run(path, stop="1 s")["a.x"] == pytest.approx(math.exp(-1.0), abs=1e-4)
    without = elements(component("a", more='implementation="ModelExchange"'))
    assert "two.fmu has no model exchange, only co-simulation" in refused(made(without))


# ---------------------------------------------------------------------- notes and --strict


def drawn(inside: str) -> str:
    return f'{inside}<ssd:SystemGeometry x1="0" y1="0" x2="1" y2="1"/>'


A = elements(component("a", U, Y))
PASSED = [
    (drawn(A), "geometry and drawings are not read"),
    (elements(component("a", U, more='colour="red"')), "attribute 'colour' of ssd:Component is not known"),
    (elements(component("a", U, more='implementaton="any"')), "'implementation' is one that is known"),
    (elements(component("a", connector("w", "input"))), "connector 'w' is no variable of the FMU"),
    (elements(component("a", connector("u", "input", "Integer"))), "is not of the type of the FMU's variable, float"),
    (elements(component("a", connector("u", "output"))), "is not of the kind of the FMU's variable, input"),
    (elements(component("a", array("u", "input", "Real", 3))), "has other dimensions than the FMU's variable"),
    (A + '<x:note xmlns:x="urn:x"/>', "{urn:x}note in ssd:System is not known"),
    (elements(component("a"), component("b", Y), connections=connection("b/y", "a/u")), "'u' is no connector, but a variable"),
    (bound(values(value("a.u", "1"))) + connectors(U) + A, "does not fit the schema of SSP 1.0"),
]  # fmt: skip


@pytest.mark.parametrize(("inside", "note"), PASSED)
def test_what_cannot_change_the_result_is_passed_over_or_refused_if_strict(
    inside: str, note: str, made
) -> None:
    path = made(inside)
    assert any(note in each for each in read_ssp(path).notes)
    message = refused(path, strict=True)
    assert "line " in message


def test_what_is_met_often_is_one_note(made) -> None:
    geometry = '<ssd:ConnectorGeometry x="0" y="0"/>'
    inside = elements(
        component("a", *(connector(n, "input", inside=geometry) for n in ("u", "q[1]", "q[2]")))
    )
    notes = [note for note in read_ssp(made(inside)).notes if "Geometry" in note]
    assert len(notes) == 1
    assert "(and at 2 more places)" in notes[0]


def test_a_connector_in_another_unit_is_refused_only_where_it_is_connected(made) -> None:
    speed = connector("speed", "input", unit="m/s")
    alone = elements(component("a", speed))
    assert any("in another unit" in note for note in read_ssp(made(alone)).notes)
    fed = elements(
        component("a", speed), component("b", Y), connections=connection("b/y", "a/speed")
    )
    assert "in another unit than the FMU's variable, which is in knot_x" in refused(made(fed))


def test_where_the_schema_is_said_to_be_is_no_news(made) -> None:
    there = 'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:schemaLocation="a b"'
    first = made(elements(component("a", U, more=there)))
    notes = read_ssp(first, strict=True).notes
    assert [note for note in notes if "schema" in note] == []


# ---------------------------------------------------------------------- structural parameters


SIZES = '<ssc:Dimension size="2"/><ssc:Dimension size="2"/>'
MATRIX = (
    f'<ssd:Connector name="matrix" kind="input"><ssc:Float64/>{SIZES}</ssd:Connector>'
    f'<ssd:Connector name="transpose" kind="output"><ssc:Float64/>{SIZES}</ssd:Connector>'
)
ROWS = connector("rows", "structuralParameter", "UInt64")
TWO, FOUR = value("rows", "2", "UInt64"), value("matrix", "1 2 3 4", "Float64")


def three(name: str, *listed: str) -> str:
    bindings = bound(values(*listed, version="2.0")) if listed else ""
    return component(name, MATRIX, ROWS, fmu="three", bindings=bindings)


def around(*listed: str) -> str:
    """Return a binding of the system, with the name of the component in its parameters."""
    text = "".join(listed).replace('Parameter name="', 'Parameter name="a.')
    return bound(values(text, version="2.0"))


@pytest.mark.parametrize(
    "inside",
    [
        elements(three("a", TWO, FOUR)),
        elements(three("a", FOUR, TWO)),
        around(TWO) + elements(three("a", FOUR)),
        around(FOUR, TWO) + elements(three("a")),
        connectors(connector("n", "structuralParameter", "UInt64"))
        + bound(values(value("n", "2", "UInt64"), version="2.0"))
        + elements(three("a", FOUR), connections=connection("n", "a/rows")),
    ],
    ids=["first", "last", "around", "both around", "connector"],
)
def test_sizes_follow_structural_parameters_wherever_they_stand(made, inside: str) -> None:
    path = made(inside, version="2.0")
    last = run(path)
    assert {name: one for name, one in last.items() if "transpose" in name} == {
        "a.transpose[1,1]": 1.0, "a.transpose[1,2]": 3.0,
        "a.transpose[2,1]": 2.0, "a.transpose[2,2]": 4.0,
    }  # fmt: skip
    assert not [note for note in read_ssp(path).notes if "dimensions" in note]


def test_arrays_of_one_size_are_connected_whole(made) -> None:
    """Transposed twice it is the same; it does not fit the FMU's own size."""
    joined = connection("a/transpose", "b/matrix")
    inside = elements(three("a", TWO, FOUR), three("b", TWO), connections=joined)
    last = run(made(inside, version="2.0"))
    assert [last[f"b.transpose[{i},{k}]"] for i in (1, 2) for k in (1, 2)] == [1.0, 2.0, 3.0, 4.0]
    other = elements(three("a", TWO, FOUR), three("b"), connections=joined)
    text = refused(made(other, version="2.0"))
    assert "'transpose' has 4 values, 'matrix[1,1]' is one of 6" in text


@pytest.mark.parametrize(
    ("size", "message"),
    [("2000000", "an array of 2000000 by 2"), ("2.5", "a whole number is needed, found '2.5'")],
)
def test_sizes_that_cannot_be(made, size: str, message: str) -> None:
    inside = elements(three("a", value("rows", size, "UInt64")))
    text = refused(made(inside, version="2.0"))
    assert "SystemStructure.ssd: line " in text
    assert message in text
