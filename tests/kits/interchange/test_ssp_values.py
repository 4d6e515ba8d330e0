"""Values in SSP packages: where they reach FMUs through connectors, mappings and files."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial_kits.interchange.ssp.reading import read_ssp

from .ssp_natives import (
    bound,
    build,
    component,
    connection,
    connector,
    connectors,
    elements,
    entry,
    linear,
    mapping,
    package,
    ssd,
    table,
    value,
    values,
)

U = connector("u", "input")
GAIN = connector("gain", "parameter")
TWO = component("a", U, GAIN)


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return build(tmp_path_factory.mktemp("slaves"))


@pytest.fixture
def given(fmus: dict[str, bytes], tmp_path: Path):
    """Read a description with ``inside`` in its system; return what its FMUs start from."""

    def read(inside: str, path: str = "a", version: str = "1.0", **members: str) -> dict:
        files = {f"resources/{name.replace('_', '.')}": text for name, text in members.items()}
        text = ssd(inside, version=version)
        file = package(tmp_path / "x.ssp", text, {**fmus, **files})
        return read_ssp(file).rig.components[path].entry.set

    return read


def test_a_value_of_a_systems_connector_reaches_what_it_is_connected_to(given) -> None:
    # kn -> m/s at the connector of the system, then the connection's own transformation.
    inner = f"""<ssd:System name="sub">{connectors(connector("in", "input", unit="m/s"))}
    {elements(TWO, connections=connection("in", "a/u", linear(2.0, 1.0)))}</ssd:System>"""
    top = (
        connectors(connector("speed", "input", unit="kn"))
        + bound(values(value("speed", "10")))
        + elements(inner, connections=connection("speed", "sub/in"))
    )
    assert given(top, "sub.a") == {"u": pytest.approx(2.0 * 10 * 1852 / 3600 + 1.0, rel=1e-15)}


def test_a_value_in_a_unit_of_its_own_is_converted_at_the_connector(given) -> None:
    top = (
        connectors(connector("speed", "input", unit="m/s"))
        + bound(values(value("speed", "36", unit="km/h")))
        + elements(TWO, connections=connection("speed", "a/u"))
    )
    assert given(top) == {"u": pytest.approx(10.0, rel=1e-15)}


def test_a_connected_parameter_wins_over_one_that_is_bound(given) -> None:
    # As OMSimulator has it: addP.k1 is 30 of k_cref, not its own 10 (import_export_parameters1).
    top = (
        connectors(connector("k", "parameter"))
        + bound(values(value("k", "30"), value("a.gain", "10")))
        + elements(TWO, connections=connection("k", "a/gain"))
    )
    assert given(top) == {"gain": 30.0}


def test_an_outer_binding_of_a_connector_wins_over_an_inner_one(given) -> None:
    inner = f"""<ssd:System name="sub">{connectors(connector("k", "parameter"))}
    {bound(values(value("k", "1")))}
    {elements(TWO, connections=connection("k", "a/gain"))}</ssd:System>"""
    assert given(elements(inner), "sub.a") == {"gain": 1.0}
    assert given(bound(values(value("sub.k", "7"))) + elements(inner), "sub.a") == {"gain": 7.0}


def test_a_mapping_renames_transforms_and_leaves_the_rest_out(given) -> None:
    # LinearTransformation3 of OMSimulator's test suite: 2 * 2 + 10 and 4 * 2 + 5.
    entries = (
        entry("of_u", "a.u", linear(2.0, 10.0)),
        entry("of_k", "a.gain", linear(4.0, 5.0)),
        entry("of_k", "a.k"),
        entry("", "a.u"),
        entry("none", "a.internal_step"),
    )
    listed = values(value("of_u", "2"), value("of_k", "2"), value("a.largest_step", "9"))
    top = bound(listed, mapped=mapping(*entries)) + elements(TWO)
    assert given(top) == {"u": 14.0, "gain": 13.0, "k": 2.0}


def test_a_mapping_comes_behind_the_prefix_and_from_files(given) -> None:
    bindings = (
        '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/v.ssv" prefix="p.">'
        '<ssd:ParameterMapping source="resources/m.ssm"/></ssd:ParameterBinding>'
        "</ssd:ParameterBindings>"
    )
    files = {"v_ssv": values(value("k", "3")), "m_ssm": mapping(entry("p.k", "a.gain"))}
    assert given(bindings + elements(TWO), **files) == {"gain": 3.0}


@pytest.mark.parametrize(("more", "expected"), [("", 2001.0), ('suppressUnitConversion="1"', 3.0)])
def test_a_mapping_transforms_behind_the_conversion_of_units(
    more: str, expected: float, given
) -> None:
    # The mapping's own suppressUnitConversion; the unit of the target is the connector's here.
    entries = mapping(entry("x", "speed", linear(2.0, 1.0), more))
    top = (
        connectors(connector("speed", "input", unit="m"))
        + bound(values(value("x", "1", unit="km")), mapped=entries)
        + elements(TWO, connections=connection("speed", "a/u"))
    )
    assert given(top) == {"u": expected}


def test_tables_of_a_mapping_change_integers_booleans_and_items(given) -> None:
    entries = (
        entry("n", "a.i", table("Integer", ("4", "5"))),
        entry("m", "a.trouble", table("Integer", ("4", "1"))),
        entry("on", "a.b", table("Boolean", ("true", "false"))),
        entry("how", "a.mode_in", table("Enumeration", ("racing", "sail"))),
    )
    listed = values(
        value("n", "4", "Integer"),
        value("m", "3", "Integer"),
        value("on", "true", "Boolean"),
        value("how", "racing", "Enumeration"),
    )
    top = bound(listed, mapped=mapping(*entries)) + elements(component("a"))
    assert given(top) == {"i": 5, "trouble": 3, "b": False, "mode_in": 2}


WRONG = [
    (entry("n", "a.i") + entry("r", "a.i"), "a second parameter is mapped to 'a.i'"),
    (entry("n", "a.i", linear(2, 0)), "a real number is needed, found 4"),
    (entry("r", "a.u", table("Integer", ("1", "2"))), "an integer is needed, found 1.5"),
    (entry("r", "a.u", table("Boolean", ("1", "0"))), "a Boolean is needed, found 1.5"),
    (entry("r", "a.u", table("Enumeration", ("a", "b"))), "an enumeration is needed"),
    (entry("n", "a.i", table("Integer", ("1", "2"), ("1", "3"))), "1 is mapped twice"),
    (entry("n", "a.i", table("Integer", ("1.5", "2"))), "a whole number is needed, found '1.5'"),
    (entry("n", "a.i", linear(1, 0) + linear(2, 0)), "a second"),
    ('<ssm:MappingEntry source="n"/>', "attribute 'target' is missing"),
]


@pytest.mark.parametrize(("entries", "reason"), WRONG)
def test_mistakes_in_a_mapping_are_named(entries: str, reason: str, given) -> None:
    listed = values(value("n", "4", "Integer"), value("r", "1.5"))
    with pytest.raises(InputError, match=r"SystemStructure\.ssd: line \d+: ") as caught:
        given(bound(listed, mapped=mapping(entries)) + elements(TWO))
    assert reason in str(caught.value)


def test_parameters_may_be_inside_the_fmu_that_they_are_for(
    fmus: dict[str, bytes], tmp_path: Path
) -> None:
    (tmp_path / "a.fmu").write_bytes(fmus["resources/two.fmu"])
    with zipfile.ZipFile(tmp_path / "a.fmu", "a") as archive:
        archive.writestr("extra/own.ssv", values(value("gain", "8")))
    inside = bound(more='source="extra/own.ssv" sourceBase="component"')
    text = ssd(elements(component("a", GAIN, bindings=inside)))
    members = {"resources/two.fmu": (tmp_path / "a.fmu").read_bytes()}
    path = package(tmp_path / "x.ssp", text, members)
    assert read_ssp(path).rig.components["a"].entry.set == {"gain": 8.0}
    outside = text.replace("extra/own", "../own")
    with pytest.raises(InputError, match="outside the package"):
        read_ssp(package(tmp_path / "y.ssp", outside, members))
    system = ssd(inside + elements(component("a")))
    with pytest.raises(InputError, match="sourceBase: SSD, outside a component, is needed"):
        read_ssp(package(tmp_path / "z.ssp", system, members))


def test_an_empty_unit_is_none_and_bracketed_ones_are_those_inside(given) -> None:
    unit = (
        '<ssv:Units><ssc:Unit name="ft"><ssc:BaseUnit m="1" factor="0.5"/></ssc:Unit></ssv:Units>'
    )
    top = (
        connectors(connector("d", "input", unit="m"))
        + bound(values(value("d", "4", unit="[ft]"), value("a.gain", "3", unit=""), after=unit))
        + elements(
            component("a", connector("u", "input", unit="")), connections=connection("d", "a/u")
        )
    )
    assert given(top) == {"u": 2.0, "gain": 3.0}


def test_a_state_starts_from_a_value_and_what_is_calculated_does_not(
    fmus: dict[str, bytes], tmp_path: Path
) -> None:
    top = bound(values(value("a.x", "5"), value("a.y", "6"))) + elements(TWO)
    path = package(tmp_path / "x.ssp", ssd(top), fmus)
    read = read_ssp(path)
    assert read.rig.components["a"].entry.set == {"x": 5.0}
    assert any("a.y is output" in note for note in read.notes)
    assert started(read.rig)["a.x"] == 5.0
    with pytest.raises(InputError, match=r"a\.y is output"):
        read_ssp(path, strict=True)


def started(rig) -> dict[str, object]:
    """Return all outputs of a rig that has been initialised."""
    system = assemble(rig)
    try:
        master = Master(system)
        master.initialise()
        return {".".join(n): v for n, v in zip(master.names, master.signals, strict=True)}
    finally:
        system.free()


def test_a_calculated_parameter_reaches_a_fixed_one_before_the_run(
    fmus: dict[str, bytes], tmp_path: Path
) -> None:
    # a.y = 2 * 3 is b's gain, b.y = 6 * 2 the k of c: one follows the other.
    y = connector("y", "calculatedParameter")
    top = bound(values(value("a.u", "3"), value("b.u", "2"), value("c.x", "4"))) + elements(
        component("c", connector("k", "parameter"), connector("x", "output")),
        component("b", y, GAIN, fmu="calc"),
        component("a", y, fmu="calc"),
        connections=connection("b/y", "c/k") + connection("a/y", "b/gain", linear(1.0, 0.0)),
    )
    rig = read_ssp(package(tmp_path / "x.ssp", ssd(top), fmus)).rig
    system = assemble(rig)
    try:
        master = Master(system)
        master.initialise()
        assert master.values("b", ["gain"]) == [6.0]
        assert master.values("c", ["k"]) == [12.0]
        with pytest.raises(InputError, match=r"k is fed by b\.y"):
            system.set("c.k", 1.0, "test")
    finally:
        system.free()


@pytest.mark.slow
def test_an_output_cannot_feed_a_fixed_parameter(given) -> None:
    top = elements(
        component("a", connector("k", "parameter")),
        component("b", connector("y", "output")),
        connections=connection("b/y", "a/k"),
    )
    with pytest.raises(InputError, match="'y', an output, cannot feed 'k', a fixed parameter"):
        given(top)


def array(name: str, kind: str, of: str, *sizes: int) -> str:
    """Return an array connector."""
    return connector(name, kind, of, "".join(f'<ssc:Dimension size="{s}"/>' for s in sizes))


def test_arrays_have_their_values_row_by_row(given) -> None:
    three = component("a", array("matrix", "input", "Float64", 3, 2), fmu="three")
    texts = (
        '<ssv:Parameter name="a.in_String"><ssv:String><ssv:Value value="a b"/>'
        '<ssv:Value value=""/><ssv:Value value="c"/></ssv:String></ssv:Parameter>'
    )
    listed = (
        value("m", "1 2 3 4 5 6", "Float64", '<ssc:Dimension size="3"/><ssc:Dimension size="2"/>'),
        value("a.in_Int8", "1 -2 3", "Int8"),
        value("a.in_Boolean", "true 0 1", "Boolean"),
        value("a.in_Mode", "sail", "Enumeration"),
        texts,
    )
    top = (
        connectors(array("m", "input", "Float64", 3, 2))
        + bound(values(*listed, version="2.0"))
        + elements(three, connections=connection("m", "a/matrix"))
    )
    found = given(top, version="2.0")
    assert [found[f"matrix[{row},{column}]"] for row in (1, 2, 3) for column in (1, 2)] == [
        1.0, 2.0, 3.0, 4.0, 5.0, 6.0
    ]  # fmt: skip
    assert [found[f"in_Int8[{i}]"] for i in (1, 2, 3)] == [1, -2, 3]
    assert [found[f"in_Boolean[{i}]"] for i in (1, 2, 3)] == [True, False, True]
    assert [found[f"in_String[{i}]"] for i in (1, 2, 3)] == ["a b", "", "c"]
    assert found["in_Mode"] == 5_000_000_000
    with pytest.raises(InputError, match="in_Int8 has 2 values, 3 are needed"):
        given(bound(values(value("a.in_Int8", "1 2", "Int8"))) + elements(three), version="2.0")
    with pytest.raises(InputError, match="an array of 2 has 3 values"):
        shape = value("a.in_Int8", "1 2 3", "Int8", '<ssc:Dimension size="2"/>')
        given(bound(values(shape)) + elements(three), version="2.0")
