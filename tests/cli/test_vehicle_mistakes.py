"""Mistakes in a vehicle of one's own: one message each, with the file and the key."""

import pytest

from seatrial.cli.making.templates import texts, write
from seatrial.errors import InputError
from seatrial.system.assembling.assembly import assemble
from seatrial.system.assembling.fitted_parts import forgotten, vacant
from seatrial.system.flattening import load_rig
from tests.command import seatrial
from tests.kit import needs_kits

pytestmark = needs_kits("fitted")

VEHICLE, PILOT = "harness/vehicles/tuna/vehicle.toml", "harness/vehicles/tuna/pilot.toml"
PROFILE = "hil_profiles/tuna.toml"


@pytest.fixture
def change(tmp_path, monkeypatch):
    """Return what replaces a text of a vehicle like `auv` by another one."""
    monkeypatch.chdir(tmp_path)
    write(texts("tuna", "auv"), "", [("", "")])

    def changed(file, *pairs):
        path = tmp_path / file
        text = path.read_text("utf-8")
        for before, after in pairs:
            assert before in text
            text = text.replace(before, after)
        path.write_text(text, "utf-8")

    return changed


def system():
    return assemble(load_rig("sil", choices={"vehicle": "tuna"}), engine="direct")


def test_a_sound_vehicle_has_no_notes(change):
    found = system()
    assert found.notes == []
    assert not [path for path in forgotten(found) if path.startswith("vehicle.hull")]


@pytest.mark.parametrize(
    ("line", "path", "what"),
    [
        ('"motor.order"        = "hull.propulsor_order.p1"', "propulsor_order.p1", "propeller"),
        ('"rudder.angle"       = "hull.foil_angle.f1"', "foil_angle.f1", "fin"),
    ],
)
def test_a_part_that_nobody_commands(change, line, path, what):
    change(VEHICLE, (line, ""))
    notes = forgotten(system())
    of_hull = {key: note for key, note in notes.items() if key.startswith("vehicle.hull")}
    assert list(of_hull) == [f"vehicle.hull.{path}"]
    (note,) = of_hull.values()
    assert note.startswith(f"nothing feeds the command vehicle.hull.{path}: ")
    assert f"part 1, {what}, rests (vehicles/tuna/vehicle.toml [hull])" in note


def test_what_a_trial_moves_is_commanded(change):
    change(VEHICLE, ('"rudder.angle"       = "hull.foil_angle.f1"', ""))
    for moved in ("vehicle.hull.foil_angle.f1", "vehicle.hull.foil_angle"):
        assert not [path for path in forgotten(system(), {moved}) if "foil" in path]


def test_the_angle_of_an_azimuth_is_a_command_and_that_of_a_tunnel_is_none(change):
    write(texts("tug", "azimuth"), "", [("", "")])
    change(
        "harness/vehicles/tug/vehicle.toml",
        ('"port_gear.angle"       = "hull.propulsor_angle.p1"', ""),
    )
    found = assemble(load_rig("sil", choices={"vehicle": "tug"}), engine="direct")
    of_hull = [path for path in forgotten(found) if path.startswith("vehicle.hull")]
    assert of_hull == ["vehicle.hull.propulsor_angle.p1"]


@pytest.mark.slow
def test_places_without_a_part_are_not_listed(change):
    found = system()
    empty = vacant(found)
    assert "vehicle.hull.propulsor_order.p2" in empty
    assert "vehicle.hull.ballast_order" in empty
    assert not {"vehicle.hull.propulsor_order.p1", "vehicle.hull.foil_angle.f2"} & empty
    shown = seatrial("describe", "sil", "--vehicle", "tuna", "--all", cwd=".").stdout
    assert "hull.propulsor_order.p2" not in shown
    assert "hull.ballast_order" not in shown


@pytest.mark.parametrize(
    ("file", "pairs", "said"),
    [
        (
            VEHICLE,
            [('area         = "0.016 m2"', 'area = "-0.016 m2"')],
            r"tuna/vehicle.toml \[hull\]: foil_area_1 = -0.016 m2 is not in its range",
        ),
        (
            VEHICLE,
            [('position = ["-0.75 m", 0, 0]', "position = [0.1, 0, 0]")],
            r"tuna/vehicle.toml \[hull\]: propulsor_position_1.x: unit '1' cannot be converted",
        ),
        (
            VEHICLE,
            [('mass      = "32 kg"', 'mass = "32 kg"\nfoil_area_1 = "1 m2"')],
            r"tuna/vehicle.toml: hull: foils: foil_area_1 is there twice",
        ),
        (
            VEHICLE,
            [("{ capsule", '{ name = "a", capsule'), ("{ box", '{ name = "a", box')],
            r"tuna/vehicle.toml: shape.hull: name: a is there twice",
        ),
    ],
)
def test_values_that_cannot_be(change, file, pairs, said):
    change(file, *pairs)
    with pytest.raises(InputError, match=said):
        system()


def test_a_thruster_without_a_limit(change):
    write(texts("cat", "usv"), "", [("", "")])
    change(
        "harness/vehicles/cat/vehicle.toml",
        ('thrust   = ["50 N", "40 N"]  # ahead and astern, at rest\n', ""),
        ('thrust   = "= propulsor_thrust_1"\n', ""),
    )
    change(
        "harness/vehicles/cat/pilot.toml",
        ("= .hull.propulsor_thrust_1.1", "9 N"),
        ("= .hull.propulsor_thrust_1.2 * .hull.propulsor_position_2.y", "9 N.m"),
    )
    said = r"cat/vehicle.toml \[hull\]: propulsors: part 1, thruster, has no thrust: give"
    with pytest.raises(InputError, match=said):
        assemble(load_rig("sil", choices={"vehicle": "cat"}), engine="direct")


def test_an_axis_that_the_pilot_needs_and_nobody_asks_for(change, tmp_path):
    change(PILOT, ('axes = "surge pitch yaw"', 'axes = "surge yaw"'))
    assert system().notes == [
        f"{tmp_path / PILOT}: components.allocation.set: autopilot.pilot.allocation.axes is 'surge yaw': nothing gives pitch, which "
        "autopilot.pilot.depth_by_pitch.pitch_moment asks for"
    ]


def test_an_axis_that_the_parts_cannot_give(change):
    change(PILOT, ('axes = "surge pitch yaw"', 'axes = "surge pitch yaw roll"'))
    done = seatrial("run", "tuna", "--engine", "direct", "--set", "stop=1 s", cwd=".")
    assert done.returncode == 2
    assert "autopilot.pilot.allocation.axes is 'surge pitch yaw roll'" in done.stderr
    assert "give roll not at all" in done.stderr


def test_a_sensor_outside_of_the_hull(change):
    change(PROFILE, ('kind = "depth"', 'kind = "depth"\nplace = ["40 m", "0 m", "0 m"]'))
    assert system().notes == [
        "hil_profiles/tuna.toml [sensors.depth]: place is at (40, 0, 0) m, outside of the hull "
        "of 1.6 m by 0.19 m by more than its length"
    ]


def test_a_sensor_on_a_mast_is_no_mistake(change):
    change(PROFILE, ('kind = "depth"', 'kind = "depth"\nplace = ["0.9 m", "0 m", "-1.5 m"]'))
    assert system().notes == []


def test_a_file_that_is_no_toml_is_named(change):
    change(VEHICLE, ("motor        = {", "esc          = {"))
    done = seatrial("run", "tuna", cwd=".")
    assert done.returncode == 2
    assert f"{VEHICLE}: not TOML: " in done.stderr


def test_a_pattern_that_matches_nothing_lists_what_there_is(change, tmp_path):
    (tmp_path / "t.toml").write_text(
        'rig = "sil"\nchoices = { vehicle = "tuna" }\nstop = "1 s"\n'
        '[record]\nsignals = ["vehicle.hul.*"]\n',
        "utf-8",
    )
    done = seatrial("run", "t.toml", "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 2
    assert "t.toml: record.signals: no signal matches 'vehicle.hul.*'" in done.stderr
    assert "(known: vehicle.hull." in done.stderr
