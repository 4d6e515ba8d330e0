"""Shapes of vehicles: as files have them, as signals move them, as triangles."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh

from seatrial.errors import InputError
from seatrial.shipped import available
from seatrial.system.parameters import load_vehicle
from seatrial.system.shape import written
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.live.meshes import Mesh, mesh_of

VEHICLES = sorted(available("vehicles"))
WITHOUT = {"tether"}  # it is a line, whose points are recorded


def _solid(mesh: Mesh | None) -> trimesh.Trimesh:
    assert mesh is not None
    return trimesh.Trimesh(mesh.vertices, mesh.faces)


@pytest.mark.parametrize("name", [v for v in VEHICLES if v not in WITHOUT])
def test_every_vehicle_has_a_shape_of_closed_bodies(name: str) -> None:
    shape = load_vehicle(name).file.shape
    assert shape
    for parts in shape.values():
        for part in written(parts):
            solid = _solid(mesh_of(part))
            assert solid.is_watertight, part
            assert solid.volume > 0.0, part  # faces look outwards


@pytest.mark.parametrize(
    ("part", "volume", "extents"),
    [
        ({"box": [3.0, 2.0, 1.0]}, 6.0, [3.0, 2.0, 1.0]),
        ({"cylinder": {"radius": 0.5, "length": 4.0}}, math.pi, [4.0, 1.0, 1.0]),
        (
            {"capsule": {"radius": 0.5, "length": 4.0}},
            math.pi + math.pi / 6.0,
            [5.0, 1.0, 1.0],
        ),
        (
            {"plate": {"outline": [[0, 0], [2, 0], [0, 1]], "thickness": 0.1}},
            0.1,
            [2.0, 0.1, 1.0],
        ),
    ],
)
def test_sizes_and_volumes(part, volume, extents) -> None:
    solid = _solid(mesh_of(part))
    assert solid.volume == pytest.approx(volume, rel=0.05)  # circles have 20 corners
    assert solid.extents == pytest.approx(extents, rel=0.03)


def test_a_hull_displaces_what_its_sections_do() -> None:
    hull = {"length": 10.0, "beam": [2.0] * 5, "draught": [0.5] * 5, "freeboard": 0.3}
    solid = _solid(mesh_of({"hull": hull}))
    below = solid.triangles[solid.triangles[:, :, 2].min(axis=1) > -1e-12]
    across = 0.5 * np.cross(below[:, 1] - below[:, 0], below[:, 2] - below[:, 0])
    # Gauss: the integral of z n_z over what is wet; the plane of the water line adds nothing.
    volume = float(np.sum(below[:, :, 2].mean(axis=1) * across[:, 2]))
    corners = 8  # of the half ellipse, whose area is that of the polygon in it
    polygon = 0.5 * corners * math.sin(math.pi / corners) * 1.0 * 0.5
    assert volume == pytest.approx(10.0 * polygon, rel=1e-9)
    assert solid.bounds[1][2] == pytest.approx(0.5)


def test_what_stretches_begins_at_its_origin() -> None:
    part = {"cylinder": {"radius": 0.1, "length": 2.0}, "stretch": {"signal": "a", "full": 1.0}}
    assert _solid(mesh_of(part)).bounds[:, 0] == pytest.approx([0.0, 2.0])


@pytest.mark.slow
def test_ports_become_the_signals_that_feed_them(gloria: Path, hydrone: Path) -> None:
    boat = load_run(gloria).manifest["components"]["boat"]
    moved = {part["turn"]["signal"] for part in boat["shape"] if "turn" in part}
    joints = {row[1]: row[0] for row in load_run(gloria).manifest["connections"]}
    fed = {joints.get(f"boat.{port}") for port in ("sail", "flap", "rudder")}
    assert moved == fed
    hull = load_run(hydrone).manifest["components"]["vehicle.hull"]
    jets = [part["stretch"]["signal"] for part in hull["shape"] if "stretch" in part]
    assert jets == ["vehicle.port_thruster.thrust", "vehicle.starboard_thruster.thrust"]


WRONG = [
    ("marine-craft = [{ box = [1, 1] }]", "shape.marine-craft.0.box"),
    ("marine-craft = [{ box = [1, 1, -1] }]", "greater than 0"),
    ("marine-craft = [{ at = [0, 0, 0] }]", "One of box, cylinder, capsule, hull, plate, file"),
    ('marine-craft = [{ box = [1, 1, 1], file = "a.stl" }]', "One of box"),
    ('marine-craft = [{ box = [1, 1, 1], color = "#ffffff" }]', "colour"),
    ('marine-craft = [{ box = [1, 1, 1], colour = "red" }]', "colour"),
    ('marine-craft = [{ box = [1, 1, 1], on = "mast" }]', "mast"),
    ("marine-craft = [{ box = [nan, 1, 1] }]", "shape.marine-craft.0.box.0"),
    ("hull = [{ box = [1, 1, 1] }]", "hull"),
]


@pytest.mark.parametrize(("shape", "says"), WRONG)
def test_a_wrong_shape_names_file_and_key(tmp_path: Path, shape: str, says: str) -> None:
    path = _vehicle(tmp_path, shape)
    with pytest.raises(InputError) as error:
        load_vehicle(str(path))
    assert str(path) in str(error.value)
    assert says in str(error.value)


def _vehicle(folder: Path, shape: str) -> Path:
    text = load_vehicle("hydrone").read_from.path.read_text("utf-8")
    before, _, _ = text.partition("\n# What is drawn")
    path = folder / "mine.toml"
    path.write_text(f"{before}\n[shape]\n{shape}\n", "utf-8")
    return path


def _run(folder: Path, shape: str) -> Path:
    vehicle = _vehicle(folder, shape)
    (folder / "rig.toml").write_text(
        'step = "10 ms"\n[components]\n'
        f'hull = {{ fmu = "marine-craft", parameters = "{vehicle.name}" }}\n'
    )
    (folder / "trial.toml").write_text('rig = "rig.toml"\nstop = "50 ms"\n')
    out = folder / "run"
    run_trial(load_trial(str(folder / "trial.toml")), out, engine="direct")
    return out


@pytest.mark.parametrize(
    ("turn", "says"),
    [
        ('turn = { port = "ruder" }', "ruder"),
        ('stretch = { port = "propulsion2.thrust.t1", full = 1 }', "propulsion2"),
    ],
)
def test_a_port_that_there_is_not(tmp_path: Path, turn: str, says: str) -> None:
    with pytest.raises(InputError, match=f"marine-craft.0.*{says}"):
        _run(tmp_path, f"marine-craft = [{{ box = [1, 1, 1], {turn} }}]")


def test_a_part_of_a_vehicle_that_the_rig_has_not_rests(tmp_path: Path) -> None:
    shape = 'marine-craft = [{ box = [1, 1, 1], stretch = { port = "propulsion.thrust.t1", full = 1 } }]'
    (part,) = load_run(_run(tmp_path, shape)).manifest["components"]["hull"]["shape"]
    assert "stretch" not in part


def test_a_mesh_of_ones_own_goes_with_the_run(tmp_path: Path) -> None:
    trimesh.creation.icosphere(radius=2.0).export(tmp_path / "ball.stl")
    out = _run(tmp_path, 'marine-craft = [{ file = "ball.stl", scale = 0.5 }]')
    (part,) = json.loads((out / "manifest.json").read_text())["components"]["hull"]["shape"]
    (kept,) = (out / "meshes").iterdir()
    assert kept.read_bytes() == (tmp_path / "ball.stl").read_bytes()
    assert kept.name == f"{part['sha256'][:16]}.stl"
    shutil.rmtree(out)
    with pytest.raises(InputError, match=r"file: 'ball.obj' is no .glb or .stl"):
        _run(tmp_path, 'marine-craft = [{ file = "ball.obj" }]')
    with pytest.raises(InputError, match=r"gone.stl: No such file"):
        _run(tmp_path, 'marine-craft = [{ file = "gone.stl" }]')


def test_water_is_where_the_waves_are() -> None:
    from seatrial.physics.sea.waves import Waves
    from seatrial_kits.live.water import Water

    rng = np.random.default_rng(2)
    parts = [rng.uniform(*span, 30) for span in ((0.01, 0.3), (0.4, 2.0), (0.0, 6.3), (0.0, 6.3))]
    waves = Waves(*parts)
    corners = Water(waves, 60.0, cells=12).vertices(7.3, 105.0, -42.0)
    places = corners[:, [1, 0]]  # north, east
    assert corners[:, 2] == pytest.approx(waves.elevation(7.3, places), abs=1e-9)
    assert abs(corners[:, :2].mean(axis=0) - [105.0, -42.0]).max() < 3.0


def test_still_water_lies_about_the_craft() -> None:
    from seatrial_kits.live.water import Water

    corners = Water(None, 60.0, cells=1).vertices(0.0, 29.0, -42.0)
    assert corners.tolist() == [[-1, -72, 0], [-1, -12, 0], [59, -72, 0], [59, -12, 0]]


def test_quaternions_are_those_of_scipy() -> None:
    from scipy.spatial.transform import Rotation

    from seatrial.trial.records import quaternions

    angles = np.random.default_rng(3).uniform(-1.5, 1.5, (50, 3))
    ours = quaternions.of_euler(angles)
    theirs = Rotation.from_euler("ZYX", angles[:, ::-1])
    both = [Rotation.from_quat(np.roll(ours, -1, axis=1)), theirs]
    assert (both[0] * both[1].inv()).magnitude() == pytest.approx(0.0, abs=1e-12)
    axis, angle = np.array([1.0, -2.0, 0.5]), 0.7
    turned = quaternions.product(ours, quaternions.about(axis, angle))
    wanted = theirs * Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
    error = Rotation.from_quat(np.roll(turned, -1, axis=1)) * wanted.inv()
    assert error.magnitude() == pytest.approx(0.0, abs=1e-12)
