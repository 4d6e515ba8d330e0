"""What components declare to be seen: where it is drawn, against geometry by hand and by SciPy."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.control.deck_landing.landing_control import DeckLandingControl
from seatrial.devices.relative_pose import RelativePose
from seatrial.physics.craft.multirotor import Multirotor
from seatrial.physics.environment.prescribed_deck import PrescribedDeck
from seatrial.physics.environment.touch_down import TouchDown
from seatrial.trial.records.run_folder import Run
from seatrial_kits.live.motion import Motion
from seatrial_kits.live.views import Views
from seatrial_kits.live.water import followed
from tests.devices.running import started

LEVEL, LENS, HALF, REACH = 0.1, 0.15, math.radians(40.0), 12.0
TO_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


class Scene:
    """Keeps what is added to it, by the last two names of its path."""

    def __init__(self) -> None:
        self.nodes: dict[str, Any] = {}

    def _add(self, path: str, **given: Any) -> Any:
        return self.nodes.setdefault(path, SimpleNamespace(visible=True, **given))

    def add_mesh_simple(self, path: str, vertices: Any, faces: Any, **given: Any) -> Any:
        return self._add(path, vertices=vertices, faces=faces, **given)

    def add_line_segments(self, path: str, points: Any, colors: Any, **given: Any) -> Any:
        return self._add(path, points=points, colors=colors, **given)

    def add_label(self, path: str, text: str, **given: Any) -> Any:
        return self._add(path, text=text, **given)


def _entry(component: Any, **parameters: float) -> dict[str, Any]:
    given = {name: {"value": value} for name, value in parameters.items()}
    return {"fmu": "", "parameters": given, "views": component.views}


def shown(**signals: Any) -> dict[str, Any]:
    """Return the nodes of a drone 3 m over the water and of a deck, with some signals changed."""
    values = {
        "drone.position": (5.0, -2.0, -3.0),
        "drone.attitude": (0.0, 0.0, 0.0),
        "deck.position": (5.0, -2.0, 0.0),
        "deck.attitude": (0.0, 0.0, 0.0),
        **signals,
    }
    axes = {"position": "x y z", "attitude": "phi theta psi", "deck_ahead": "phi theta psi"}
    columns = {}
    for name, value in values.items():
        if isinstance(value, tuple):
            named = axes.get(name.rpartition(".")[2], "north east down").split()
            columns |= {f"{name}.{a}": np.array([v]) for a, v in zip(named, value, strict=True)}
        else:
            columns[name] = np.array([value])
    pad = {"pad.x": 0.0, "pad.y": 0.0, "pad.z": -0.2}
    manifest = {
        "components": {
            "deck": {"fmu": "", "parameters": {}},
            "drone": _entry(Multirotor, **pad, **{"deck_size.x": 1.2, "deck_size.y": 0.8}),
            "camera": _entry(RelativePose, lens=LENS, half_angle=HALF, reach=REACH),
            "control": _entry(DeckLandingControl),
            "figures": _entry(TouchDown, **pad, radius=0.3),
        },
        "connections": [
            ["deck.attitude", "drone.deck_attitude"],
            ["deck.attitude", "figures.deck_attitude"],
            *(["drone.attitude", f"{name}.attitude"] for name in ("camera", "control", "figures")),
        ],
        "signals": {},
    }
    run = Run(Path(), np.array([1.0]), columns, {}, manifest, [], {}, False, ())
    motion, scene = Motion(run), Scene()
    assert [craft.component for craft in motion.crafts] == ["deck", "drone"]
    Views(scene, motion, "/w", 1.0, LEVEL).show(motion.at(1.0))
    return scene.nodes


def test_the_cone_of_a_level_camera_ends_in_a_circle_over_the_crests() -> None:
    nodes = shown(**{"camera.valid": 1.0})
    lens, *ends = nodes["/w/view0/cone"].vertices
    assert lens == pytest.approx([-2.0, 5.0, 3.0 - LENS])  # east, north, up
    away = np.array(ends) - [-2.0, 5.0, LEVEL]
    radius = (3.0 - LENS - LEVEL) * math.tan(HALF)
    assert np.hypot(away[:, 0], away[:, 1]) == pytest.approx(radius)
    assert away[:, 2] == pytest.approx(0.0, abs=1e-6)
    assert nodes["/w/view0/rim1"].points[:, 0] == pytest.approx(np.array(ends))


def test_a_camera_high_up_sees_as_far_as_its_reach() -> None:
    nodes = shown(**{"drone.position": (0.0, 0.0, -40.0)})
    lens, *ends = nodes["/w/view0/cone"].vertices
    assert np.linalg.norm(np.array(ends) - lens, axis=1) == pytest.approx(REACH)


def test_every_ray_of_a_tilted_camera_is_its_half_angle_off_the_axis() -> None:
    angles = (0.15, -0.2, 0.7)
    nodes = shown(**{"drone.attitude": angles})
    turn = Rotation.from_euler("ZYX", angles[::-1])
    lens, *ends = nodes["/w/view0/cone"].vertices
    assert lens == pytest.approx(TO_ENU @ (turn.apply([0, 0, LENS]) + np.array([5.0, -2.0, -3.0])))
    rays = np.array(ends) - lens
    along = rays @ (TO_ENU @ turn.apply([0.0, 0.0, 1.0])) / np.linalg.norm(rays, axis=1)
    assert along == pytest.approx(math.cos(HALF), abs=1e-6)


def test_a_cone_says_whether_the_mark_is_seen() -> None:
    colours = []
    for valid in (0.0, 1.0):
        nodes = shown(**{"camera.valid": valid})
        rims = [nodes[f"/w/view0/rim{number}"].visible for number in (0, 1)]
        assert rims == [not valid, bool(valid)]
        colours.append(nodes["/w/view0/cone"].color)
    (red, green, _), (other_red, other_green, _) = colours
    assert red > green
    assert other_red < other_green


def test_edge_and_target_are_on_the_craft_that_is_the_deck() -> None:
    nodes = shown()
    edge = nodes["/w/craft0/edge0"].points.reshape(-1, 3)
    assert np.ptp(edge, axis=0) == pytest.approx([1.2, 0.8, 0.0])
    assert edge[:, 2] == pytest.approx(-0.2, abs=0.01)
    ring = nodes["/w/craft0/target0"].points[:, 0]
    assert np.hypot(ring[:, 0], ring[:, 1]) == pytest.approx(0.3)


def test_a_deck_is_drawn_where_and_as_it_is_expected() -> None:
    turned, place = (0.1, -0.15, 0.4), (5.1, -1.9, -0.35)
    nodes = shown(
        **{
            "control.pad": (5.05, -1.95, -0.2),
            "control.pad_ahead": place,
            "control.deck_ahead": turned,
            "control.time_ahead": 2.5,
            "control.window": 2.5,
        }
    )
    assert nodes["/w/foreseen0/pad"].position == pytest.approx([-1.95, 5.05, 0.2])
    deck = nodes["/w/foreseen0/deck"]
    assert deck.position == pytest.approx([-1.9, 5.1, 0.35])
    corner = np.array([0.6, 0.4, 0.0])
    drawn = Rotation.from_quat(np.roll(deck.wxyz, -1)).apply(corner)
    assert drawn == pytest.approx(TO_ENU @ Rotation.from_euler("ZYX", turned[::-1]).apply(corner))
    assert nodes["/w/foreseen0/deck/time"].text == "touch-down in 1.5 s"


def test_nothing_is_drawn_of_a_deck_that_nobody_expects() -> None:
    zeros = (0.0, 0.0, 0.0)
    unknown = {f"control.{name}": zeros for name in ("pad", "pad_ahead", "deck_ahead")}
    for signals in ({}, {**unknown, "control.time_ahead": 0.0}):
        nodes = shown(**signals)
        seen = [nodes[f"/w/foreseen0/{name}"].visible for name in ("pad", "deck", "deck/time")]
        assert seen == [False] * 3


@pytest.mark.parametrize(
    ("mode", "landed", "text"),
    [
        (5.0, 0.0, "descend"),
        (6.0, 1.0, "landed, rests on the deck"),
        (7.0, -1.0, "go-around, landing failed"),
        (99.0, 0.0, ""),
    ],
)
def test_states_are_words(mode: float, landed: float, text: str) -> None:
    label = shown(**{"control.mode": mode, "figures.landed": landed})["/w/craft1/state"]
    assert (label.text if label.visible else "") == text


@pytest.mark.parametrize("seed", [1, 2])
def test_the_water_is_that_which_a_deck_follows(seed: int) -> None:
    """A raft without extent goes up and down with the surface, and leans as its slope does."""
    given = {"wave_height": 0.4, "direction_by": "seed", "seed": float(seed), "pad_height": 0.0}
    size = {f"size.{axis}": 1e-6 for axis in "xyz"}
    parameters = {name: {"value": value} for name, value in (given | size).items()}
    component = {"fmu": "prescribed-deck", "parameters": parameters}
    waves = followed(SimpleNamespace(manifest={"components": {"raft": component}}))
    deck = started(PrescribedDeck, **{**given, "size": [1e-6] * 3})
    assert waves is not None
    for t in (0.0, 3.7, 12.1):
        deck.outputs(t)
        up = waves.elevation(t, np.zeros((1, 2)))[0]
        assert up == pytest.approx(-deck.get("pad_position")[2], abs=1e-5)
        near = 1e-4 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        heights = waves.elevation(t, near)
        slopes = (heights[0] - heights[1]) / 2e-4, (heights[2] - heights[3]) / 2e-4
        phi, theta, _ = deck.get("attitude")
        assert slopes == pytest.approx((math.tan(theta), -math.tan(phi)), abs=2e-3)


def test_a_deck_at_rest_and_one_of_a_file_are_on_still_water() -> None:
    for given in ({}, {"wave_height": 0.4, "file": "gone.json"}):
        parameters = {name: {"value": value} for name, value in given.items()}
        component = {"fmu": "prescribed-deck", "parameters": parameters}
        assert followed(SimpleNamespace(manifest={"components": {"raft": component}})) is None
