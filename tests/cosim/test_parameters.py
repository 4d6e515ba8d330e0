"""Vehicle files: what a component gets from them, and the message for a mistake."""

from __future__ import annotations

import tomllib

import pytest

from seatrial.errors import InputError
from seatrial.fmi.direct import DirectInstance
from seatrial.model.component import Component, Input, Output, Parameter
from seatrial.model.units import conversion
from seatrial.system.files import available
from seatrial.system.parameters import Vehicle, load_vehicle
from seatrial.system.references.entries import Entry
from seatrial.system.references.values import Given, from_entry, from_written, port_scalars

HEAD = 'title = "Boat"\nsource = "drawing 7"\n'
BOAT = (
    HEAD
    + """
default = "light"

[hull]
mass = { value = 120, unit = "lb", source = "drawing 7", mark = "stated" }
pad = { value = [10, 20, -30], unit = "cm", source = "measured", mark = "corrected" }
mode = { value = "full", source = "chosen", mark = "assumed" }
ratio = { value = 12.5, unit = "%", source = "chosen", mark = "assumed" }

[variants.light.hull]
mass = { value = 40.5, unit = "kg", source = "weighed", mark = "stated" }

[variants.heavy.hull]
mass = { value = 99, unit = "kg", source = "weighed", mark = "stated" }
mode = { value = "diagonal", source = "chosen", mark = "assumed" }

[variants.heavy.keel]
depth = { value = 1.5, unit = "m", source = "drawing 8", mark = "stated" }

[presets.hull.pad]
bow = { value = [1, 0, 0], unit = "ft", source = "drawing 7", mark = "stated" }
stern = { value = [-1, 0, 0], unit = "ft", source = "drawing 7", mark = "stated" }
"5 m aft" = { value = [-5, 0, 0], unit = "m", source = "drawing 7", mark = "stated" }
short = { value = [1, 0], unit = "m", source = "drawing 7", mark = "stated" }
heavy = { value = [1, 0, 0], unit = "kg", source = "drawing 7", mark = "stated" }
"""
)


class Hull(Component):
    mass = Parameter(1.0, "kg", "mass")
    pad = Parameter((0.0, 0.0, 0.0), "m", "pad", axes="xyz")
    mode = Parameter("full", "1", "mode")
    ratio = Parameter(0.0, "1", "ratio")
    course = Input("rad", "course")
    on = Input("1", "on", type=bool)
    count = Input("1", "count", type=int)
    y = Output("m", "y")


VARIABLES = DirectInstance(Hull("hull")).variables


@pytest.fixture
def load(write):
    """Return a function that reads a vehicle file with the given text."""

    def load(text: str) -> Vehicle:
        return load_vehicle(str(write("vehicles/boat.toml", text)))

    return load


def taken(vehicle: Vehicle, table: str, variant: str | None = None) -> dict[str, object]:
    return {name: e.value for name, e in vehicle.parameter_set(table, variant).values.items()}


# ---------------------------------------------------------------------- which values


def test_a_variant_replaces_values_one_by_one(load) -> None:
    boat = load(BOAT)
    common = {"pad": [10, 20, -30], "ratio": 12.5}
    assert taken(boat, "hull") == {**common, "mass": 40.5, "mode": "full"}
    assert taken(boat, "hull", "light") == taken(boat, "hull")
    assert taken(boat, "hull", "heavy") == {**common, "mass": 99, "mode": "diagonal"}
    assert taken(boat, "keel", "heavy") == {"depth": 1.5}  # a table of one variant only
    without_default = load(BOAT.replace('default = "light"', ""))
    assert taken(without_default, "hull") == {**common, "mass": 120, "mode": "full"}


def test_a_set_says_where_it_comes_from(load) -> None:
    boat = load(BOAT)
    assert boat.parameter_set("hull", None).origin == "vehicles/boat.toml [hull], variant light"
    assert boat.parameter_set("keel", "heavy").origin == "vehicles/boat.toml [keel], variant heavy"
    plain = load(BOAT.replace('default = "light"', ""))
    assert plain.parameter_set("hull", None).origin == "vehicles/boat.toml [hull]"
    assert set(boat.parameter_set("hull", None).presets["pad"]) >= {"bow", "stern"}
    assert boat.parameter_set("keel", "heavy").presets == {}


@pytest.mark.parametrize(
    ("table", "variant", "message"),
    [
        ("hull", "haevy", r"unknown variant 'haevy'; did you mean 'heavy'"),
        ("hul", None, r"unknown component table 'hul'; did you mean 'hull'"),
        ("keel", None, r"unknown component table 'keel'; .*\(known: hull\)"),
        ("keel", "light", r"unknown component table 'keel'"),
        ("variants", None, r"unknown component table 'variants'"),
        ("title", None, r"unknown component table 'title'"),
    ],
)
def test_unknown_variants_and_tables_have_near_misses(load, table, variant, message) -> None:
    boat = load(BOAT)
    with pytest.raises(InputError, match=message) as error:
        boat.parameter_set(table, variant)
    assert str(error.value).startswith(f"{boat.read_from.path}: ")


def test_an_unknown_default_is_named(load) -> None:
    boat = load(BOAT.replace('"light"', '"ligth"'))
    with pytest.raises(InputError, match=r"unknown variant 'ligth'; did you mean 'light'"):
        boat.parameter_set("hull", None)
    assert taken(boat, "hull", "heavy")["mass"] == 99


# ---------------------------------------------------------------------- mistakes in the file

GOOD = {"value": "1", "unit": '"kg"', "source": '"s"', "mark": '"stated"'}


def entry(**changes: str) -> str:
    given = {**GOOD, **changes}
    return "{ " + ", ".join(f"{k} = {v}" for k, v in given.items() if v) + " }"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mark": '"guessed"'}, "mark: Input should be 'stated', 'corrected', 'assumed' or 'identified', found 'guessed'"),
        ({"mark": '"Stated"'}, "mark: Input should be 'stated'"),
        ({"mark": ""}, "mark: this key is missing"),
        ({"source": ""}, "source: this key is missing"),
        ({"source": "4"}, "source: Input should be a valid string, found 4"),
        ({"value": ""}, "value: this key is missing"),
        ({"value": "true"}, "value"),
        ({"value": '[1, "a"]'}, "value"),
        ({"value": "{ x = 1 }"}, "value"),
        ({"unit": "1"}, "unit: Input should be a valid string; or: Input should be a valid list, found 1"),
        ({"sorce": '"s"', "source": ""}, "sorce: unknown key 'sorce'; did you mean 'source'? (known: mark, source, unit, value)"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("place", ["hull", "variants.light.hull", "presets.hull.pad"])
def test_mistakes_in_an_entry_name_their_place(load, place: str, changes, message: str) -> None:
    load(f"{HEAD}[{place}]\nmass = {entry()}\n")
    with pytest.raises(InputError) as error:
        load(f"{HEAD}[{place}]\nmass = {entry(**changes)}\n")
    lines = str(error.value).splitlines()
    assert any(f"boat.toml: {place}.mass.{message}" in line for line in lines)
    assert all("boat.toml: " in line for line in lines)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD.replace("title", "titel"), r"boat\.toml: titel: unknown key 'titel'; did you mean 'title'"),
        (HEAD.replace("source", "suorce"), r"suorce: unknown key 'suorce'; did you mean 'source'"),
        ('source = "s"\n', r"boat\.toml: title: this key is missing"),
        ('title = "t"\n', r"boat\.toml: source: this key is missing"),
        (HEAD + "[hull]\nmass = 3\n", r"boat\.toml: hull\.mass\.source: this key is missing"),
        (HEAD + "[[hull]]\nmass = 3\n", r"boat\.toml: hull: unknown key 'hull'"),
        (HEAD + "[components.hull]\nmass = " + entry(), r"boat\.toml: components\.hull\.mass: unknown key"),
        (HEAD + "default = 1\n", r"boat\.toml: default: Input should be a valid string, found 1"),
        (HEAD + "[hull]\nmass = {\n", r"boat\.toml: not TOML: .*line 4"),
    ],
)  # fmt: skip
def test_mistakes_in_a_file_name_their_place(load, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(text)


def test_unknown_vehicles_have_near_misses() -> None:
    with pytest.raises(InputError, match=r"unknown vehicle 'hydrne'; did you mean 'hydrone'"):
        load_vehicle("hydrne")


# ---------------------------------------------------------------------- values in the port's unit


def given_by(load, port: str, variant: str | None = None) -> dict[str, Given]:
    chosen = load(BOAT).parameter_set("hull", variant)
    return from_entry(chosen.values[port], port_scalars(VARIABLES, port), chosen.origin)


def test_entries_are_converted_to_the_ports_unit_and_keep_their_source(load) -> None:
    vehicle = load(BOAT.replace('default = "light"', "")).parameter_set("hull", None)
    mass = from_entry(vehicle.values["mass"], port_scalars(VARIABLES, "mass"), "here")
    assert mass == {"mass": Given(pytest.approx(120 * 0.45359237), "here", "drawing 7", "stated")}
    pad = given_by(load, "pad")
    assert {n: g.value for n, g in pad.items()} == {
        "pad.x": pytest.approx(0.1, rel=1e-15),
        "pad.y": pytest.approx(0.2, rel=1e-15),
        "pad.z": pytest.approx(-0.3, rel=1e-15),
    }
    assert {(g.source, g.mark) for g in pad.values()} == {("measured", "corrected")}
    assert given_by(load, "mode", "heavy")["mode"].value == "diagonal"
    assert given_by(load, "ratio")["ratio"].value == 0.125


def test_a_value_in_the_ports_own_unit_is_not_touched(load) -> None:
    assert given_by(load, "mass")["mass"].value == 40.5
    value = given_by(load, "mass", "heavy")["mass"].value
    assert (value, type(value)) == (99.0, float)


@pytest.mark.parametrize(
    ("port", "values", "message"),
    [
        ("mass", {"unit": "m"}, "here: mass: unit 'm' cannot be converted to 'kg'"),
        ("mass", {"unit": "kgg"}, "here: mass: 'kgg' is not a unit"),
        ("mass", {"value": "much"}, r"here: a number in kg is needed, found 'much'"),
        ("mass", {"value": [1, 2]}, r"here: 1 values are needed \(mass\), found 2"),
        ("pad", {"value": [1, 2], "unit": "m"}, r"3 values are needed \(pad\.x, pad\.y, pad\.z\), found 2"),
        ("pad", {"value": [], "unit": "m"}, "3 values are needed .*, found 0"),
        ("pad", {"value": [1, 2, 3], "unit": ["m", "m"]}, "here: units: 3 values are needed .*, found 2"),
        ("pad", {"value": [1, 2, 3], "unit": ["m", "m", "s"]}, "unit 's' cannot be converted to 'm'"),
        ("mode", {"value": 3, "unit": "1"}, "here: a text is needed, found 3"),
        ("ratio", {"value": 1, "unit": "rad"}, "unit 'rad' cannot be converted to '1'"),
    ],
)  # fmt: skip
def test_entries_that_do_not_fit_their_port(port: str, values, message: str) -> None:
    entry = Entry(**{"value": 1, "unit": "kg", "source": "s", "mark": "stated", **values})
    with pytest.raises(InputError, match=message):
        from_entry(entry, port_scalars(VARIABLES, port), "here")


def test_each_value_may_have_a_unit_of_its_own() -> None:
    entry = Entry(value=[1, 20, 300], unit=["m", "cm", "mm"], source="s", mark="stated")
    given = from_entry(entry, port_scalars(VARIABLES, "pad"), "here")
    assert [g.value for g in given.values()] == pytest.approx([1.0, 0.2, 0.3])


def test_a_preset_stands_for_a_whole_port(load) -> None:
    presets = load(BOAT).parameter_set("hull", None).presets["pad"]
    scalars = port_scalars(VARIABLES, "pad")
    bow = from_written("bow", scalars, presets, "rig.toml: hull.pad")
    assert {n: g.value for n, g in bow.items()} == {"pad.x": 0.3048, "pad.y": 0.0, "pad.z": 0.0}
    assert {g.origin for g in bow.values()} == {"rig.toml: hull.pad, preset 'bow'"}
    assert {(g.source, g.mark) for g in bow.values()} == {("drawing 7", "stated")}
    # A preset's name is looked for before it is read as a quantity.
    assert from_written("5 m aft", scalars, presets, "o")["pad.x"].value == -5.0
    assert from_written("5 m", scalars, presets, "o")["pad.x"].value == 5.0


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("strn", r"o: unknown preset 'strn'; did you mean 'stern'"),
        ("abeam", r"o: unknown preset 'abeam'; \(known: .*bow, heavy, short, stern\)"),
        ("short", r"o, preset 'short': 3 values are needed .*, found 2"),
        ("heavy", r"o, preset 'heavy': pad\.x: unit 'kg' cannot be converted to 'm'"),
        ("5 s", r"o: unit 's' cannot be converted to 'm'"),
        (["1 m", "2 m"], r"o: 3 values are needed \(pad\.x, pad\.y, pad\.z\), found 2"),
        (["1 m", "2 m", "bow"], r"o: 'bow' is not a quantity"),
        ([1, 2, True], r"o: True is not a quantity"),
        ([1, 2, float("nan")], r"o: nan is not a finite number"),
    ],
)
def test_presets_and_values_that_do_not_fit(load, written, message: str) -> None:
    presets = load(BOAT).parameter_set("hull", None).presets["pad"]
    with pytest.raises(InputError, match=message):
        from_written(written, port_scalars(VARIABLES, "pad"), presets, "o")


@pytest.mark.parametrize(
    ("port", "written", "expected"),
    [
        ("course", "90 deg", 1.5707963267948966),
        ("course", 0.5, 0.5),
        ("pad", [1, "2 m", "30 cm"], [1.0, 2.0, 0.3]),
        ("pad", "1 m", [1.0, 1.0, 1.0]),
        ("pad.y", "1 m", [1.0]),
        ("mode", "full", "full"),
        ("on", True, True),
        ("count", 3, 3),
        ("count", 3.0, 3),
        ("count", "3", 3),
        ("ratio", "40 %", 0.4),
    ],
)
def test_values_as_a_person_writes_them(port: str, written, expected) -> None:
    got = [g.value for g in from_written(written, port_scalars(VARIABLES, port), {}, "o").values()]
    assert got == (expected if isinstance(expected, list) else [expected])
    assert [type(v) for v in got] == [v.type for v in port_scalars(VARIABLES, port)]


@pytest.mark.parametrize(
    ("port", "written", "message"),
    [
        ("on", 1, "o: true or false is needed, found 1"),
        ("on", "true", "o: .*'true'"),
        ("count", 2.5, "o: a whole number .*is needed, found 2.5"),
        ("count", float("inf"), "o: inf is not a finite number"),
        ("mode", 1, "o: a text is needed, found 1"),
        ("course", "90", r"o: '90' has no unit; write for example '90 rad'"),
        ("course", "north", r"o: 'north' is not a quantity"),
        ("course", "90 %", "o: unit '%' cannot be converted to 'rad'"),
    ],
)
def test_values_of_the_wrong_kind(port: str, written, message: str) -> None:
    with pytest.raises(InputError, match=message):
        from_written(written, port_scalars(VARIABLES, port), {}, "o")


# ---------------------------------------------------------------------- from a rig

TABLE = f"""
[Scale]
bias = {entry(unit='"ft"')}
[small]
bias = {entry(unit='"cm"')}
[presets.Scale.bias]
big = {entry(value="2", unit='"km"')}
"""


def bias(direct, components: str, **options) -> float:
    system = direct.system(components, **options)
    return system.parts["a"].given["bias"].value


def test_a_rig_names_a_vehicle_file_beside_itself(direct, write, monkeypatch, tmp_path) -> None:
    write("boats/mine.toml", HEAD + TABLE)
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.chdir(empty)
    rig = 'a = {{ fmu = "users.py:Scale", parameters = "{}"{} }}'
    assert bias(direct, rig.format("boats/mine.toml", "")) == 0.3048
    preset = rig.format("boats/mine.toml", ', set = { bias = "big" }')
    assert bias(direct, preset) == 2000.0
    table = rig.format("boats/mine.toml.small", "")
    assert bias(direct, table) == pytest.approx(0.01, rel=1e-15)
    own = rig.format("boats/mine.toml", ', set = { bias = "3 mm" }')
    assert bias(direct, own) == 0.003
    with pytest.raises(InputError, match="unknown vehicle 'mine'"):
        direct.system(rig.format("mine", ""))
    write("empty/vehicles/mine.toml", HEAD + TABLE)
    assert bias(direct, rig.format("mine.small", "")) == pytest.approx(0.01, rel=1e-15)
    with pytest.raises(InputError, match=r"components\.a\.parameters: .*unknown variant 'heavy'"):
        direct.system(rig.format("mine", ""), top='step = "1 s"\nvariant = "heavy"')


def test_a_table_with_a_question_mark_may_be_lacking(direct, write) -> None:
    write("mine.toml", HEAD + TABLE)
    rig = 'a = {{ fmu = "users.py:Scale", parameters = "mine.toml{}" }}'
    assert bias(direct, rig.format("?")) == 0.3048
    assert bias(direct, rig.format(".small?")) == pytest.approx(0.01, rel=1e-15)
    system = direct.system(rig.format(".keel?"))
    assert "bias" not in system.parts["a"].given
    (note,) = system.notes
    assert "mine.toml has no table keel: a has its own values" in note
    with pytest.raises(InputError, match="unknown component table 'keel'"):
        direct.system(rig.format(".keel"))


def test_a_reference_to_own_takes_what_the_component_has(direct, write) -> None:
    """The table is another component's: what this one has no parameter for stays there."""
    bias_of_2_cm = entry(value="2", unit='"cm"')
    shared = f"[shared]\nmass = {entry()}\nbias = {bias_of_2_cm}\n[other]\nmass = {entry()}\n"
    write("mine.toml", HEAD + shared)
    rig = 'a = {{ fmu = "users.py:Scale", parameters = "mine.toml.{}" }}'
    assert bias(direct, rig.format("shared:own")) == pytest.approx(0.02, rel=1e-15)
    with pytest.raises(InputError, match="unknown port 'mass'"):
        direct.system(rig.format("shared"))
    nothing = (
        r"components\.a\.parameters: nothing in .* \[other\] is a parameter of users\.py:Scale"
    )
    with pytest.raises(InputError, match=nothing):
        direct.system(rig.format("other:own"))


# ---------------------------------------------------------------------- lists of like parts

THRUSTERS = (
    HEAD
    + """
[propulsion]
gain = { value = 1, source = "s", mark = "stated" }

[[propulsion.thrusters]]
position = { value = [1, 2, 3], unit = "m" }
direction = { value = [1, 0, 0] }
source = "drawing 7"
mark = "stated"

[[propulsion.thrusters]]
position = { value = [1, -2, 3], unit = "m", mark = "assumed" }
direction = { value = [0, 0, 1] }
source = "drawing 8"
mark = "stated"
"""
)


def test_parts_of_a_list_are_numbered_and_share_source_and_mark(load) -> None:
    values = load(THRUSTERS).parameter_set("propulsion", None).values
    assert list(values) == ["gain", "position_1", "direction_1", "position_2", "direction_2"]
    assert values["position_2"] == Entry(
        value=[1, -2, 3], unit="m", source="drawing 8", mark="assumed"
    )
    assert (values["direction_1"].unit, values["direction_1"].source) == ("1", "drawing 7")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (THRUSTERS.replace("gain", "position_2"), r"propulsion: thrusters: position_2 is there twice"),
        (THRUSTERS.replace('mark = "stated"\n\n[[', "\n[["), r"propulsion\.\w+_1\.mark: this key is missing"),
        (THRUSTERS.replace("{ value = [0, 0, 1] }", "true"), r"propulsion\.direction_2\.value: Input should be"),
    ],
)  # fmt: skip
def test_mistakes_in_a_list_name_their_place(load, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load(text)


# ---------------------------------------------------------------------- what is shipped


def follows(entry: object) -> bool:
    """Return whether an entry follows from others; what it amounts to is tested by itself."""
    value = entry["value"] if isinstance(entry, dict) else entry
    return any(
        str(each).startswith("=") for each in (value if isinstance(value, list) else [value])
    )


@pytest.mark.parametrize("name", sorted(available("vehicles")))
def test_shipped_vehicles_have_every_value_with_unit_and_source(name: str) -> None:
    """Read with tomllib alone; each table gives in each variant what its file says."""
    vehicle = load_vehicle(name)
    raw = tomllib.loads(vehicle.read_from.path.read_text("utf-8"))
    drawn = {"variants", "presets", "outline", "shape", "rig", "rigs"}
    tables = {k for k, v in raw.items() if isinstance(v, dict)} - drawn
    assert tables
    for variant in [None, *raw.get("variants", {})]:
        changed = raw["variants"][variant or raw["default"]] if "variants" in raw else {}
        for table in tables:
            expected = {**raw[table], **changed.get(table, {})}
            chosen = vehicle.parameter_set(table, variant).values
            # Short forms and lists of parts have tests of their own.
            given = {n: e for n, e in expected.items() if isinstance(e, dict) and not follows(e)}
            for entry, said in given.items():
                assert said.items() <= chosen[entry].model_dump().items()
            for value in chosen.values():
                assert value.source.strip()
                units = value.unit if isinstance(value.unit, list) else [value.unit]
                assert all(conversion(unit, unit) == (1.0, 0.0) for unit in units)
