"""Vehicles in one folder: the names that its rigs have, and what they refer to."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.shipped import available, available_places, provided_folders, shipped_folder
from seatrial.system.assembling.assembly import assemble
from seatrial.system.files import find_file, find_place
from seatrial.system.flattening import load_rig
from seatrial.system.parameters import load_vehicle
from seatrial.system.system import System

from .. import users

SHIPPED = shipped_folder("harness") / "vehicles"
SCALE = '{ fmu = "../../../users.py:Scale"'
BOAT = f"""
title = "Boat"
source = "drawing 7"

[hull]
source = "drawing 7"
mark   = "stated"
bias   = "30 cm"

# The boat's rig.
[rig]
title = "The boat's rig"
step  = "1 s"
[rig.choices]
part = "esc"
[rig.components]
hull  = {SCALE}, parameters = ".hull" }}
motor = {{ rig = ".actuators.{{part}}" }}
[rig.connections]
"hull.y" = "motor.u"
[rig.shows]
y = "motor.y"

[rigs.actuators.esc]
title = "A speed controller"
[rigs.actuators.esc.components]
scale = {SCALE}, set = {{ bias = "= 2 * .hull.bias", gain = 3 }} }}
[rigs.actuators.esc.shows]
u = "scale.u"
y = "scale.y"
"""
PILOT = f"""
title = "The boat's pilot"
step  = "1 s"
[components]
hold = {SCALE}, set = {{ bias = "= .hull.bias / 2" }} }}
more = {{ rig = ".pilots.more" }}

[rigs.pilots.more]
[rigs.pilots.more.components]
scale = {SCALE}, parameters = ".hull:own" }}
"""


@pytest.fixture
def here(write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a user's folder with components."""
    write("here/users.py", users.CHAIN)
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


@pytest.fixture
def boat(here: Path, write) -> Path:
    """A vehicle's folder, below the user's."""
    write("here/harness/vehicles/boat/pilot.toml", PILOT)
    return write("here/harness/vehicles/boat/vehicle.toml", BOAT).parent


@pytest.fixture
def system():
    """Return a function that assembles a rig by its name."""
    made: list[System] = []

    def system(name: str, **choices: str) -> System:
        made.append(assemble(load_rig(name, choices=choices), "direct"))
        return made[-1]

    yield system
    for each in made:
        each.free()


def bias(system: System, part: str) -> float:
    return system.parts[part].given["bias"].value


# ---------------------------------------------------------------------- names


@pytest.mark.parametrize(
    ("name", "title", "file", "table", "called"),
    [
        ("vehicles/boat", "The boat's rig", "vehicle.toml", "rig", "boat"),
        ("pilots/boat", "The boat's pilot", "pilot.toml", "", "boat"),
        ("actuators/boat-esc", "A speed controller", "vehicle.toml", "rigs.actuators.esc", "boat-esc"),
        ("pilots/boat-more", "", "pilot.toml", "rigs.pilots.more", "boat-more"),
    ],
)  # fmt: skip
def test_rigs_of_a_folder_have_the_names_of_files(boat, name, title, file, table, called) -> None:
    rig = load_rig(name)
    assert rig.file.title == title
    assert rig.read_from.path == boat / file
    assert (rig.read_from.table, rig.read_from.name) == (table, called)
    assert find_file("harness/rigs", name) == boat / file


def test_names_of_a_folder_are_listed_beside_those_of_files(boat, write) -> None:
    write("here/vehicles/dinghy.toml", "")
    write("here/harness/vehicles/empty/vehicle.toml", 'title = "t"\nsource = "s"\n')
    write("here/harness/vehicles/broken/vehicle.toml", "[rig")
    own = {"boat", "broken", "dinghy", "empty"}
    assert own <= set(available("vehicles"))
    assert set(available("harness/rigs/vehicles")) & own == {"boat"}
    assert set(available("harness/rigs/pilots")) & own == {"boat"}
    assert "boat-more" in available("harness/rigs/pilots")
    assert "boat-esc" in available("harness/rigs/actuators")
    places = available_places("harness/rigs/vehicles")
    assert str(places["boat"]) == f"{boat / 'vehicle.toml'} [rig]"


def test_every_shipped_vehicle_is_a_folder_of_at_most_two_files() -> None:
    provided = provided_folders("harness/vehicles")
    folders = [folder for each in provided for folder in each.iterdir()]
    assert sorted(folder.name for folder in folders) == sorted(available("vehicles"))
    for folder in folders:
        files = {path.name for path in folder.iterdir()}
        assert "vehicle.toml" in files
        assert files <= {"vehicle.toml", "pilot.toml"}
    for kind in ("vehicles", "pilots"):
        for name in available(f"harness/rigs/{kind}"):
            assert load_rig(f"{kind}/{name}").top.file.components


def test_a_path_names_the_rig_of_a_vehicles_file(boat) -> None:
    assert load_rig("harness/vehicles/boat/vehicle.toml").file.title == "The boat's rig"
    assert load_rig(str(boat / "pilot.toml")).file.title == "The boat's pilot"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("vehicles/baot", r"unknown rig 'vehicles/baot'; did you mean 'vehicles/boat'"),
        ("pilots/baot", r"unknown rig 'pilots/baot'; did you mean 'pilots/boat'"),
        ("actuators/boat-ecs", r"unknown rig 'actuators/boat-ecs'; did you mean 'actuators/boat-esc'"),
    ],
)  # fmt: skip
def test_unknown_names_have_near_misses_in_folders(boat, name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        load_rig(name)


# ---------------------------------------------------------------------- references


def test_short_references_are_of_the_vehicle_itself(boat, system) -> None:
    rig = system("vehicles/boat")
    assert bias(rig, "hull") == 0.3
    assert bias(rig, "motor.scale") == 0.6
    given = rig.parts["motor.scale"].given["bias"]
    assert (given.expression, given.mark) == ("= 2 * boat.hull.bias", "stated")
    assert given.origin.endswith(
        "vehicle.toml [rigs.actuators.esc]: components.scale.set: motor.scale.bias"
    )
    assert rig.parts["hull"].given["bias"].origin == "vehicles/boat/vehicle.toml [hull]"
    pilot = system("pilots/boat")
    assert (bias(pilot, "hold"), bias(pilot, "more.scale")) == (0.15, 0.3)


def test_a_copy_under_another_name_refers_to_itself(boat, system) -> None:
    copy = boat.parent / "barge"
    shutil.copytree(boat, copy)
    text = (copy / "vehicle.toml").read_text("utf-8")
    (copy / "vehicle.toml").write_text(text.replace("30 cm", "4 m"), "utf-8")
    assert bias(system("vehicles/barge"), "motor.scale") == 8.0
    assert bias(system("pilots/barge"), "hold") == 2.0
    assert bias(system("vehicles/boat"), "motor.scale") == 0.6


def test_a_folder_outside_of_any_harness_refers_to_itself(boat, system, tmp_path) -> None:
    apart = tmp_path / "apart" / "deep" / "yawl"
    shutil.copytree(boat, apart)
    (tmp_path / "users.py").write_text(users.CHAIN, "utf-8")
    assert bias(system(str(apart / "vehicle.toml")), "motor.scale") == 0.6


def test_an_expression_in_a_rig_around_one_is_followed_too(boat, write, system) -> None:
    text = 'step = "1 s"\n[components]\nboat = { rig = "vehicles/boat", set = { "hull.bias" = "= 7 * boat.hull.bias" } }\n'
    write("here/harness/rigs/around.toml", text)
    assert bias(system("around"), "boat.hull") == pytest.approx(2.1, rel=1e-15)
    write(
        "here/harness/rigs/around.toml",
        text.replace("= 7 * boat.hull.bias", "= 7 * boat.hull.bais"),
    )
    with pytest.raises(
        InputError, match=r"around\.toml: components\.boat\.set: boat\.hull\.bias: .*did you mean"
    ):
        system("around")


def test_numbers_of_a_user_go_before_those_of_a_shipped_rig(here, write, system) -> None:
    text = (SHIPPED / "otter" / "vehicle.toml").read_text("utf-8").partition("\n[rig]")[0]
    write("here/vehicles/otter.toml", text.replace("value = 80,", "value = 90,"))
    assert system("vehicles/otter").parts["hull"].given["mass"].value == 90.0
    mass = system("pilots/otter").parts["speed_hold"].given["mass"].value
    assert mass == 90 + 5.281521009576


def test_gains_follow_the_variant() -> None:
    for variant, mass in (("loaded", 80), ("empty", 55)):
        pilot = assemble(load_rig("pilots/otter"), "direct", variant=variant)
        pilot.free()
        assert pilot.parts["speed_hold"].given["mass"].value == mass + 5.281521009576
    with pytest.raises(InputError, match="unknown variant 'laoded'; did you mean 'loaded'"):
        assemble(load_rig("pilots/otter"), "direct", variant="laoded")


def test_a_moved_thruster_moves_in_the_allocation(here, write, system) -> None:
    """The first place of a thruster stands once: hull and allocation have the new one."""
    text = (SHIPPED / "bluerov2" / "vehicle.toml").read_text("utf-8")
    before, after = "[0.156, 0.111, 0.085], unit", "[0.456, 0.111, 0.085], unit"
    assert text.count(before) == 1
    write("here/vehicles/bluerov2.toml", text.replace(before, after))
    hull = system("vehicles/bluerov2")
    pilot = system("pilots/bluerov2")
    place = hull.parts["hull"].given["propeller_position_1.x"]
    allocated = pilot.parts["allocation.allocation"].given["position_1.x"]
    assert (place.value, allocated.value) == (0.456, 0.456)
    (note,) = hull.notes
    assert "its rigs have no effect there, but in harness/vehicles/bluerov2/vehicle.toml" in note


# ---------------------------------------------------------------------- mistakes


def test_a_name_that_stands_twice_is_refused(boat, write) -> None:
    write("here/harness/rigs/vehicles/boat.toml", 'step = "1 s"\n[components]\n')
    with pytest.raises(
        InputError, match=r"'vehicles/boat' is there twice: .*boat\.toml and .*\[rig\]; remove one"
    ):
        load_rig("vehicles/boat")
    write("here/vehicles/boat.toml", BOAT)
    with pytest.raises(
        InputError, match=r"'boat' is there twice: .*vehicles.boat\.toml and .*vehicle\.toml"
    ):
        load_vehicle("boat")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("title = \"The boat's rig\"", "titel = 3", r"vehicle\.toml \[rig\]: titel: unknown key 'titel'"),
        ('"hull.y" =', '"hull.z" =', r'vehicle\.toml \[rig\]: connections\."hull\.z"'),
        ('".hull"', '".hul"', r"vehicle\.toml \[rig\]: components\.hull\.parameters: .*did you mean 'hull'"),
        ('".actuators.{part}"', '".{part}"', r"components\.motor\.rig: \.GROUP\.PART is needed, found '\.esc'"),
        ('".actuators.{part}"', '"vehicles/boat"', r"a rig contains itself: boat -> boat"),
        ('bias = "= 2 * .hull.bias"', 'bias = "= 2 * .hull.bais"', r"components\.scale\.set: bias: .*unknown entry 'hull\.bais'"),
        ('bias = "= 2 * .hull.bias"', 'bias = "= .hull.bias ** 2"', r"unit 'm2' cannot be converted to 'm'"),
        ('bias = "= 2 * .hull.bias"', 'bias = "= 2"', r"an expression without a name needs source and mark"),
        ("[rig]", "[rigg]", r"unknown rig 'vehicles/boat'"),
    ],
)  # fmt: skip
def test_mistakes_name_file_table_and_key(boat, write, system, before, after, message) -> None:
    text = BOAT.replace(before, after)
    assert text != BOAT
    write(
        "here/harness/vehicles/boat/vehicle.toml",
        text.replace("[rig.", "[rigg.") if "rigg" in after else text,
    )
    with pytest.raises(InputError, match=message):
        system("vehicles/boat")


@pytest.mark.parametrize(
    ("entry", "key"),
    [
        ('fmu = "users.py:Scale", parameters = ".hull"', "parameters"),
        ('rig = ".actuators.esc"', "rig"),
        ('fmu = "users.py:Scale", set = { bias = "= .hull.bias" }', "set: bias"),
    ],
)
def test_a_short_reference_outside_of_a_vehicles_folder_is_refused(here, write, entry, key) -> None:
    write("here/harness/rigs/mine.toml", f'step = "1 s"\n[components]\na = {{ {entry} }}\n')
    with pytest.raises(InputError, match=rf"components\.a\.{key}: a name that begins with a dot"):
        load_rig("mine")


def test_a_table_that_is_no_rig_is_refused(boat, write) -> None:
    write("here/harness/vehicles/boat/vehicle.toml", 'rig = 3\ntitle = "t"\nsource = "s"\n')
    with pytest.raises(InputError, match=r"vehicle\.toml \[rig\]: a table is needed, found 3"):
        load_rig("vehicles/boat")


def test_a_place_of_a_kit_and_of_the_core_is_ambiguous(
    here, tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "content"
    (folder / "vehicles" / "otter").mkdir(parents=True)
    (folder / "vehicles" / "otter" / "vehicle.toml").write_text('title = "t"\nsource = "s"\n')

    def provided(kind: str) -> list[Path]:
        return [SHIPPED, folder / "vehicles"] if kind == "harness/vehicles" else []

    monkeypatch.setattr("seatrial.shipped.provided_folders", provided)
    with pytest.raises(
        InputError, match=r"'otter' is ambiguous: .*otter.vehicle\.toml and .*otter.vehicle\.toml"
    ):
        find_place("vehicles", "otter")
