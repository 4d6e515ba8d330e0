"""Entries that follow from others: their values by hand, their units, and their mistakes."""

from __future__ import annotations

import math

import pytest

from seatrial.errors import InputError
from seatrial.fmi.direct import DirectInstance
from seatrial.model.component import Component, Parameter
from seatrial.system.parameters import Vehicle, load_vehicle
from seatrial.system.references.entries import Computed, Entry, Resolved
from seatrial.system.references.values import Given, from_entry, port_scalars

HEAD = 'title = "Boat"\nsource = "drawing 7"\n'
BOAT = (
    HEAD
    + """
default = "light"

[marine-craft]
source        = "drawing 7"
mark          = "stated"
length        = "200 cm"
place         = ["10 cm", 0, "-0.3 m"]
added_mass    = { value = [6.36, 7.12, 18.68, 0, 0, 0], unit = "kg" }
spring        = { value = 50, unit = "N.m/rad", mark = "identified" }
inertia       = { value = [1, 2], unit = ["kg.m2", "kg.m2"], mark = "corrected" }
law           = "polynomial"
blades        = 3

[hold]
mass          = "= marine-craft.mass + marine-craft.added_mass.xx"

[variants.light.marine-craft]
mass = { value = 13.5, unit = "kg", source = "weighed", mark = "stated" }

[variants.heavy.marine-craft]
mass = { value = 20, unit = "kg", source = "guessed", mark = "assumed" }

[presets.marine-craft.pad]
bow  = { value = [1, 0, 0], unit = "ft", source = "drawing 7", mark = "stated" }
copy = "= presets.marine-craft.pad.bow"
"""
)


@pytest.fixture
def load(write):
    """Return a function that reads a vehicle file with the given text."""

    def load(text: str) -> Vehicle:
        return load_vehicle(str(write("vehicles/boat.toml", text)))

    return load


@pytest.fixture
def value(load):
    """Return a function that gives the entry ``x`` of a table of its own, as written."""

    def value(written: str, variant: str | None = None) -> Resolved:
        text = BOAT.replace("[hold]", f"[own]\nx = {written}\nnear = 4\n[hold]")
        text = text.replace("near = 4", 'near = { value = 4, source = "s", mark = "stated" }')
        return load(text).parameter_set("own", variant).values["x"]

    return value


class Craft(Component):
    mass = Parameter(1.0, "kg", "mass")
    place = Parameter((0.0, 0.0, 0.0), "m", "place", axes="xyz")
    rate = Parameter(1.0, "rad/s", "natural frequency")
    damping = Parameter(1.0, "N.m.s/rad", "damping")
    blades = Parameter(1, "1", "blades")
    law = Parameter("linear", "1", "law")


VARIABLES = DirectInstance(Craft("craft")).variables


def given(entry: Resolved, port: str) -> dict[str, Given]:
    return from_entry(entry, port_scalars(VARIABLES, port), "here")


# ---------------------------------------------------------------------- bare values, shared keys


def test_a_table_shares_source_and_mark_and_has_bare_values(load) -> None:
    values = load(BOAT).parameter_set("marine-craft", None).values
    shared = {"source": "drawing 7", "mark": "stated"}
    assert values["length"] == Entry(value=200.0, unit="cm", **shared)
    assert values["place"] == Entry(value=[10.0, 0.0, -0.3], unit=["cm", "cm", "m"], **shared)
    assert values["law"] == Entry(value="polynomial", **shared)
    assert values["blades"] == Entry(value=3, **shared)
    assert (values["spring"].source, values["spring"].mark) == ("drawing 7", "identified")
    assert "source" not in values
    assert "mark" not in values
    place = [g.value for g in given(values["place"], "place").values()]
    assert place == pytest.approx([0.1, 0.0, -0.3], rel=1e-15)


def test_parts_of_a_list_have_bare_values_and_kinds(load) -> None:
    text = """
[craft]
source = "drawing 7"
mark = "stated"

[[craft.foils]]
kind     = "fin"
position = ["-0.8 m", 0, "10 cm"]
area     = "66.5 cm2"

[[craft.foils]]
kind     = "rudder"
mark     = "assumed"
position = ["-0.8 m", "0 m", "-10 cm"]
area     = "= 2 * foil_area_1"
"""
    values = load(HEAD + text).parameter_set("craft", None).values
    names = ["foil_position_1", "foil_area_1", "foil_position_2", "foil_area_2", "foils"]
    assert list(values) == names
    assert values["foils"].value == "fin rudder"
    assert values["foil_position_2"].value == [-0.8, 0.0, -10.0]
    assert [values[name].mark for name in names] == [
        "stated",
        "stated",
        "assumed",
        "stated",
        "stated",
    ]
    assert values["foil_area_2"].value == pytest.approx(2 * 66.5e-4, rel=1e-15)
    assert values["foil_area_2"].source == "= 2 * foil_area_1"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[hull]\nmass = "3 kg"\n', r"hull\.mass\.source: this key is missing"),
        ('[hull]\nsource = "s"\nmass = "3 kg"\n', r"hull\.mass\.mark: this key is missing"),
        ('[hull]\nsource = "s"\nmark = "sure"\nmass = 3\n', r"hull\.mass\.mark: Input should be 'stated'"),
        ('[hull]\nsource = "s"\nmark = "stated"\nx = ["1 m", 2]\n', r"hull\.x\.value: .*a unit for all but 0, .* found \['1 m', 2\]$"),
        ('[hull]\nsource = "s"\nmark = "stated"\nx = ["1 m", "2 mm3x"]\n', r"hull\.x\.value: a list has quantities"),
        ('[hull]\nx_1 = "1 m"\n[[hull.parts]]\nx = "2 m"\n', r"hull: parts: x_1 is there twice"),
        ('[[hull.fins]]\nkind = "fin"\n[[hull.fins]]\nx = 1\n', r"hull: fins: part 2 has no kind, and others have one"),
        ('[hull]\nx = "= 2 * 3"\n', r"hull\.x.*an expression without a name needs source and mark"),
    ],
)  # fmt: skip
def test_what_bare_values_lack_is_named(load, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(HEAD + text).parameter_set("hull", None)


# ---------------------------------------------------------------------- values of expressions


@pytest.mark.parametrize(
    ("written", "expected", "unit"),
    [
        ("= marine-craft.length", 200.0, "cm"),  # as it is there, and untouched
        ("= near", 4, "1"),
        ("= marine-craft.added_mass.zz", 18.68, "kg"),
        ("= marine-craft.added_mass.3", 18.68, "kg"),
        ("= marine-craft.place.x", 10.0, "cm"),
        ("= marine-craft.inertia.2", 2, "kg.m2"),
        ("= marine-craft.law", "polynomial", "1"),
        ("= hold.mass", 13.5 + 6.36, "kg"),
        ("= marine-craft.length / 2", 1.0, "m"),
        ("= -marine-craft.length ** 2", -4.0, "m2"),
        ("= sqrt(marine-craft.length ** 3)**2", 8.0, "m3"),
        ("= marine-craft.length ** -1.5 ** 2 * marine-craft.length ** 2.25", 1.0, "1"),
        ("= 2 - 3 - 4 + 0 * near", -5.0, "1"),
        ("= 2 / 4 / 5 + 0 * near", 0.1, "1"),
        ("= (1 + 2) * -.5e1 + 0 * near", -15.0, "1"),
        ("= 2 ** 3 ** 2 + 0 * near", 512.0, "1"),
        ("= min(near, 5, 3) + max(near, 5)", 8.0, "1"),
        ("= marine-craft.mass*9.81 / near", 13.5 * 9.81 / 4, "kg"),
        ("= pi * marine-craft.length**2 * marine-craft.blades", 12 * math.pi, "m2"),
    ],
)
def test_expressions_have_the_values_of_arithmetic(value, written, expected, unit) -> None:
    found = value(f'"{written}"')
    assert isinstance(found, Computed)
    assert (found.unit, found.expression) == (unit, written)
    assert found.value == (
        expected if isinstance(expected, str) else pytest.approx(expected, rel=1e-15)
    )


def test_vectors_are_taken_element_by_element(value) -> None:
    place = [0.1, 0.0, -0.3]
    assert value('"= marine-craft.place"').value == [10.0, 0.0, -0.3]
    scaled = value('"= -2 * marine-craft.place / near"')
    assert scaled.value == pytest.approx([-0.5 * x for x in place], rel=1e-15)
    assert scaled.unit == "m"
    summed = value('"= marine-craft.place - 3 * marine-craft.place"')
    assert summed.value == pytest.approx([-2 * x for x in place], rel=1e-15)


def test_elements_of_a_list_may_be_expressions(value) -> None:
    found = value('["= marine-craft.length / 4", "-30 cm", 0]')
    assert found.value == [0.5, -30.0, 0]
    assert found.unit == ["m", "cm", "m"]
    assert [g.value for g in given(found, "place").values()] == pytest.approx([0.5, -0.3, 0.0])
    same = value('{ value = ["= -marine-craft.length", "1 m", 7], unit = "mm" }')
    assert (same.value, same.unit) == ([-2000.0, 1000.0, 7], "mm")
    assert same.source == "[= -marine-craft.length, 1 m, 7]"


def test_values_are_converted_to_what_the_entry_and_the_port_say(value) -> None:
    assert value('{ value = "= 2 * marine-craft.length", unit = "mm" }').value == 4000.0
    rate = value('"= sqrt(marine-craft.spring / marine-craft.inertia.2)"')
    assert given(rate, "rate")["rate"].value == 5.0  # 1/s: a radian is a number
    damping = '"= 2 * 0.7 * sqrt(marine-craft.spring * marine-craft.inertia.2)"'
    assert given(value(damping), "damping")["damping"].value == pytest.approx(14.0, rel=1e-15)
    assert given(value('"= marine-craft.blades"'), "blades")["blades"].value == 3
    assert given(value('"= 2 * marine-craft.blades"'), "blades")["blades"].value == 6
    assert given(value('"= marine-craft.law"'), "law")["law"].value == "polynomial"
    with pytest.raises(InputError, match=r"here: rate: unit 'kg' cannot be converted to 'rad/s'"):
        given(value('"= 2 * marine-craft.mass"'), "rate")


def test_a_reference_is_resolved_in_the_chosen_variant(load) -> None:
    boat = load(BOAT)
    light, heavy = (boat.parameter_set("hold", v).values["mass"] for v in ("light", "heavy"))
    assert (light.value, heavy.value) == (13.5 + 6.36, 20 + 6.36)
    assert (light.mark, heavy.mark) == ("stated", "assumed")  # the weakest
    assert boat.parameter_set("hold", None).values["mass"] == light


def test_source_and_mark_follow_unless_they_are_written(value) -> None:
    found = value('"= marine-craft.inertia.1 * marine-craft.spring / marine-craft.spring"')
    assert found.mark == "identified"
    assert found.source == "= marine-craft.inertia.1 * marine-craft.spring / marine-craft.spring"
    own = value('{ value = "= near", source = "eq. 3", mark = "assumed" }')
    assert (own.source, own.mark) == ("eq. 3: = near", "assumed")
    shown = given(value('"= marine-craft.mass"'), "mass")["mass"]
    assert shown == Given(13.5, "here", "= marine-craft.mass", "stated", "= marine-craft.mass")
    constant = value('{ value = "= 2 ** 3", source = "ours", mark = "assumed" }')
    assert (constant.value, constant.source) == (8.0, "ours: = 2 ** 3")


def test_presets_may_follow_from_others(load) -> None:
    pads = load(BOAT).parameter_set("marine-craft", None).presets["pad"]
    assert (pads["copy"].value, pads["copy"].unit) == ([1, 0, 0], "ft")


# ---------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("= marine-craft.mas", r"unknown entry 'marine-craft\.mas'; did you mean 'marine-craft\.mass'"),
        ("= nera", r"unknown entry 'nera'; did you mean 'near'"),
        ("= marine-kraft.mass", r"unknown entry 'marine-kraft\.mass'; did you mean 'marine-craft\.mass'"),
        ("= near-marine-craft.mass", r"unknown entry 'near-marine-craft\.mass'.*a minus has a blank before it"),
        ("= marine-craft.place.w2", r"marine-craft\.place\.w2: unknown element 'w2'.* \(known: 1, 2, 3, p"),
        ("= marine-craft.place.4", r"unknown element '4'"),
        ("= marine-craft.inertia.x", r"unknown element 'x'; \(known: 1, 2\)"),
        ("= marine-craft.mass.x", r"marine-craft\.mass is no list, found 13\.5"),
        ("= marine-craft.mass + marine-craft.length", r"kg and m do not measure the same"),
        ("= marine-craft.mass + 1", r"kg and 1 do not measure the same"),
        ("= max(near, marine-craft.mass)", r"1 and kg do not measure the same"),
        ("= 2 ** marine-craft.mass", r"an exponent is a number, found one in kg"),
        ("= marine-craft.law * 2", r"marine-craft\.law is a text, 'polynomial'"),
        ("= marine-craft.place * marine-craft.place", r"the factor of a list is a scalar, found a list of 3"),
        ("= marine-craft.place + marine-craft.added_mass", r"as many elements each, found 3 and 6"),
        ("= marine-craft.place + near", r"as many elements each, found 3 and 1"),
        ("= sqrt(marine-craft.place)", r"an argument of sqrt is a scalar"),
        ("= sqrt(-near)", r"-4\.0 has no square root"),
        ("= sqrt(near, near)", r"sqrt has one argument, found 2"),
        ("= (-near) ** 0.5", r"-4\.0 has no real power 0\.5"),
        ("= marine-craft.mass ** near ** 0.1234567", r"to the power .* is no unit"),
        ("= near / (near - 4)", r"it divides by 0"),
        ("= 1e300 * 1e300 * near", r"beyond the range of doubles"),
        ("= (10 * near) ** 1e9", r"beyond the range of doubles"),
        ("= near +", r"it is not whole"),
        ("=", r"it is not whole"),
        ("= near near", r"'near' is not expected there"),
        ("= near ; 2", r"';' is not expected there"),
        ("= (near", r"'\)' is missing"),
        ("= near * ) 2", r"a value is needed, found '\)'"),
        ("= abs(near)", r"unknown function 'abs'"),
        ("= " + "(" * 60 + "near", r"at most 40 levels deep"),
        ("= " + "-" * 60 + "near", r"at most 40 levels deep"),
        ("= near + " + "1 + " * 400 + "1", r"at most 1000 characters"),
    ],
)  # fmt: skip
def test_mistakes_in_an_expression_name_file_table_and_key(value, written, message) -> None:
    with pytest.raises(InputError, match=message) as error:
        value(f'"{written}"')
    assert "vehicles/boat.toml: own.x: '=" in str(error.value)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('{ value = "= marine-craft.mass", unit = "m" }', r"unit 'kg' cannot be converted to 'm'"),
        ('{ value = "= 2 * marine-craft.mass", unit = "N" }', r"unit 'kg' cannot be converted to 'N'"),
        ('{ value = "= marine-craft.place", unit = ["m", "m"] }', r"unit: 3 are needed, found 2"),
        ('{ value = "= marine-craft.law", unit = "m" }', r"a text has no unit, found 'm'"),
        ('{ value = ["= near", 1], unit = ["1"] }', r"unit: 2 are needed, found 1"),
        ('["= marine-craft.place", 1]', r"an element is a number, found \[10\.0, 0\.0, -0\.3\]"),
        ('["= near", "far"]', r"'far' is neither a quantity nor an expression"),
        ('["= 1", "2 m"]', r"needs source and mark"),
    ],
)  # fmt: skip
def test_units_and_lists_that_do_not_fit(value, written: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        value(written)


def test_a_ring_of_references_is_named(load) -> None:
    text = HEAD + '[a]\nx = "= b.y"\n[b]\ny = "= 2 * z"\nz = "= a.x"\n'
    ring = r"boat\.toml: a\.x: it follows from itself: a\.x -> b\.y -> b\.z -> a\.x"
    with pytest.raises(InputError, match=ring):
        load(text).parameter_set("a", None)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ('{ value = "= near", mark = "sure" }', r"own\.x\.mark: Input should be 'stated'"),
        ('{ value = "= near", untis = "m" }', r"own\.x\.untis: unknown key 'untis'"),
        ('{ value = ["= near", true] }', r"own\.x\.value"),
    ],
)
def test_other_keys_of_a_derived_entry_are_checked(value, written: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        value(written)


MANY = (
    BOAT
    + """
[[marine-craft.thrusters]]
position = [0, "-0.3 m", 0]

[[marine-craft.thrusters]]
position = [0, "0.3 m", 0]

[allocation]
{line}
"""
)


def test_a_wildcard_refers_to_all_that_it_matches(load):
    lines = '"place_*" = "= marine-craft.position_*"\nplace_2 = "= marine-craft.place"'
    entries = load(MANY.replace("{line}", lines)).entries(None).table("allocation")
    assert list(entries) == ["place_1", "place_2"]
    assert (entries["place_1"].value, entries["place_1"].unit) == ([0, -0.3, 0], "m")
    assert entries["place_1"].expression == "= marine-craft.position_1"
    assert entries["place_2"].expression == "= marine-craft.place"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('"p_*" = "= marine-craft.posture_*"', r"allocation\.p_\*: .*matches nothing, .* has len"),
        ('"p_*" = "= hull.position_*"', r"allocation\.p_\*: there is no table 'hull', allowed"),
        ('"p_*" = "= marine-craft.position_1"', r"needs the name of other entries with one \*"),
        ('"p_*" = "= 2 * marine-craft.position_*"', r"needs the name of other entries"),
    ],
)
def test_a_wildcard_that_matches_nothing_lists_what_there_is(load, line, message):
    with pytest.raises(InputError, match=message):
        load(MANY.replace("{line}", line)).entries(None)
