"""``seatrial move-vehicle``: files of several folders become those of one, and mean the same."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial.errors import InputError
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.moved_vehicle import move_vehicle, within
from seatrial.system.parameters import load_vehicle
from tests.command import seatrial

from .. import users

NUMBERS = """\
# The boat of drawing 7.
title = "Boat"
source = "drawing 7"

[hull]
bias = { value = 3, unit = "m", source = "s", mark = "stated" }  # from the drawing

[shape]
hull = [
  { file = "meshes/hull.stl" },
]
"""
RIG = """\
# No sensors yet.
title = "The boat's rig"
step  = "1 s"
[choices]
part = "esc"
[components]  # two of them
hull  = { fmu = "../../../parts.py:Scale", parameters = "boat.hull" }
table = { fmu = "course.csv" }
motor = { rig = "actuators/boat-{part}" }

[connections]
"hull.y" = ["motor.u"]
"""
PART = '[components]\nscale = { fmu = "../../../parts.py:Scale" }\n[shows]\nu = "scale.u"\n'
PILOT = (
    'step = "1 s"\n[components]\nhold = { fmu = "../../../parts.py:Scale", set = { gain = 2 } }\n'
)
OLD = {
    "vehicles/boat.toml": NUMBERS,
    "harness/rigs/vehicles/boat.toml": RIG,
    "harness/rigs/pilots/boat.toml": PILOT,
    "harness/rigs/actuators/boat-esc.toml": PART,
}


@pytest.fixture
def old(write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with a vehicle of before."""
    for name, text in OLD.items():
        write(name, text)
    write("parts.py", users.CHAIN)
    write("vehicles/meshes/hull.stl", "")
    write("harness/rigs/vehicles/course.csv", "time,course [rad]\n0,1\n1,2\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def files(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text("utf-8")
        for path in folder.rglob("*.toml")
    }


def test_files_become_one_folder_and_keep_their_text(old: Path) -> None:
    before = load_rig("vehicles/boat")
    moved = move_vehicle("boat", old)
    assert sorted(moved["removed"]) == sorted(old / name for name in OLD)
    now = files(old)
    assert set(now) == {"harness/vehicles/boat/vehicle.toml", "harness/vehicles/boat/pilot.toml"}
    text = now["harness/vehicles/boat/vehicle.toml"]
    for kept in (
        "# The boat of drawing 7.",
        "# from the drawing",
        "# No sensors yet.",
        "# two of them",
    ):
        assert text.count(kept) == 1
    assert "[rig.components]  # two of them" in text
    assert '[rigs.actuators.esc.shows]\nu = "scale.u"' in text
    assert now["harness/vehicles/boat/pilot.toml"] == PILOT
    after = load_rig("vehicles/boat")
    assert after.file.connections == before.file.connections
    assert list(after.components) == list(before.components) == ["hull", "table", "motor.scale"]
    assert after.components["hull"].entry == before.components["hull"].entry


def test_names_of_files_lead_where_they_did(old: Path) -> None:
    move_vehicle("boat", old)
    folder = old / "harness/vehicles/boat"
    table = load_rig("vehicles/boat").components["table"].entry.fmu
    assert table == "../../rigs/vehicles/course.csv"
    assert (folder / table).is_file()
    (part,) = load_vehicle("boat").file.shape["hull"]
    assert part.file == "../../../vehicles/meshes/hull.stl"
    assert (folder / part.file).is_file()
    system = assemble(load_rig("vehicles/boat"), "direct")
    try:
        assert system.parts["hull"].given["bias"].value == 3.0
    finally:
        system.free()


def test_a_run_says_that_there_is_a_command(old: Path) -> None:
    system = assemble(load_rig("pilots/boat"), "direct")
    system.free()
    (note,) = system.notes
    assert (
        note
        == "boat: its files can be in one folder, harness/vehicles/boat: seatrial move-vehicle boat"
    )
    move_vehicle("boat", old)
    system = assemble(load_rig("pilots/boat"), "direct")
    system.free()
    assert system.notes == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("vehicles/boat.toml", "mass = 3"), "mass: unknown key"),
        (("harness/rigs/pilots/boat.toml", "["), "not TOML"),
        (("harness/rigs/vehicles/boat.toml", 'title = """\n[a]\n"""\nstep = "1 s"\n[components]\n'), "by hand"),
        (("harness/vehicles/boat/notes.txt", ""), "is there already"),
    ],
)  # fmt: skip
def test_what_cannot_be_moved_stays_as_it_was(old: Path, write, change, message: str) -> None:
    write(*change)
    before = files(old)
    with pytest.raises(InputError, match=message):
        move_vehicle("boat", old)
    assert files(old) == before
    assert not list(old.glob(".moving-*"))
    assert not (old / "harness/vehicles/boat/vehicle.toml").exists()


def test_a_vehicle_that_would_not_mean_the_same_stays(old: Path, monkeypatch) -> None:
    """The text after the move is another one here, as by a mistake of ours."""
    before = files(old)
    monkeypatch.setattr(
        "seatrial.system.moved_vehicle.with_paths",
        lambda text, *_: text.replace("value = 3", "value = 4").replace("gain = 2", "gain = 5"),
    )
    with pytest.raises(
        InputError, match=r"numbers, the rig vehicles/boat, .*pilots/boat would not be"
    ):
        move_vehicle("boat", old)
    assert files(old) == before


def test_numbers_alone_move_too(write, tmp_path: Path, monkeypatch) -> None:
    write("vehicles/boat.toml", NUMBERS.partition("[shape]")[0])
    monkeypatch.chdir(tmp_path)
    move_vehicle("boat", tmp_path)
    assert list(files(tmp_path)) == ["harness/vehicles/boat/vehicle.toml"]
    with pytest.raises(
        InputError, match=r"nosuch: there is none of the files .*vehicles.nosuch\.toml"
    ):
        move_vehicle("nosuch", tmp_path)


def test_headers_get_the_table_that_they_stand_in(tmp_path: Path) -> None:
    text = '# c\nx = 1\n[a]\ny = [\n  [1],\n]\n[[b."c d"]]\nz = 2\n'
    moved = within(text, ("rigs", "g h", "p"), tmp_path)
    head = 'rigs."g h".p'
    assert (
        moved == f'# c\n[{head}]\nx = 1\n[{head}.a]\ny = [\n  [1],\n]\n[[{head}.b."c d"]]\nz = 2\n'
    )


def test_the_command_says_what_it_wrote(old: Path) -> None:
    done = seatrial("move-vehicle", "boat", cwd=old)
    assert done.returncode == 0, done.stderr
    assert "written  harness/vehicles/boat/vehicle.toml" in done.stdout
    assert "removed  harness/rigs/actuators/boat-esc.toml" in done.stdout
    assert seatrial("move-vehicle", "boat", cwd=old).returncode == 2
