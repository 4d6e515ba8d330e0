"""Vehicles in the scene: parts of their shapes, those that move, on craft or on decks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.system.assembling.shape_ports import MESHES, mesh_name
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records import quaternions
from seatrial.trial.records.run_folder import Run, viewed

from .meshes import mesh_of
from .motion import Frame, Motion

_DEFAULT_SIZE = (1.0, 0.5)
_HEIGHT = 0.25
_MOST_STRETCHED = 3.0


def shape_of(component: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the shape of a craft: its own, or a box of its outline with an arrow's colour."""
    own: list[dict[str, Any]] = component.get("shape", [])
    if own:
        return own
    outline = component.get("outline")
    length, beam = (outline["length"], outline["beam"]) if outline else _DEFAULT_SIZE
    half = 0.5 * length
    bow = [[0.0, 0.12 * beam], [0.0, -0.12 * beam], [half, 0.0]]
    return [
        {"box": [length, beam, _HEIGHT * beam]},
        {"plate": {"outline": bow, "thickness": 0.2 * beam}, "colour": "#e8892b"},
    ]


def extent(component: Mapping[str, Any]) -> float:
    """Return how far the parts of a craft's shape reach from its origin, m; more than 0."""
    reach = [
        float(np.linalg.norm(mesh.vertices, axis=1).max()) + math.hypot(*part.get("at", ()))
        for part in shape_of(component)
        if "stretch" not in part and (mesh := mesh_of(part)) is not None
    ]
    outline = component.get("outline")
    return max([*reach, 0.5 * outline["length"] if outline else 0.05])


class Bodies:
    """The bodies of a run as nodes of a scene; `show` moves them.

    Nodes have numbers, not names of the run: those are text of somebody else.
    """

    def __init__(
        self, scene: Any, motion: Motion, folder: Path, root: str, *, ghost: bool = False
    ) -> None:
        self._scene, self._folder, self._ghost = scene, folder, ghost
        self._motion = motion
        self._frames = []
        self._moving: list[_Moving] = []
        for number, craft in enumerate(motion.crafts):
            path = f"{root}/craft{number}"
            self._frames.append(scene.add_frame(path, show_axes=False))
            self._add(path, shape_of(motion.run.manifest["components"][craft.component]))
        for number, (place, entry, craft_number) in enumerate(_on_decks(motion)):
            path = f"{root}/craft{craft_number}/deck{number}"
            scene.add_frame(path, show_axes=False, position=place)
            self._add(path, entry["shape"])

    def show(self, frame: Frame) -> None:
        """Move everything to where it is in a frame."""
        for number, handle in enumerate(self._frames):
            pose = frame.pose(number)
            handle.position, handle.wxyz = pose.position, pose.wxyz
        for part in self._moving:
            part.show(frame)

    def _add(self, root: str, parts: list[dict[str, Any]]) -> None:
        named: dict[str, str] = {}
        for number, part in enumerate(parts):
            path = f"{named.get(part.get('on', ''), root)}/p{number}"
            if "name" in part:
                named[part["name"]] = path
            at, turned = np.array(part.get("at", [0.0] * 3)), _turned(part)
            moves = any(kind in part for kind in ("turn", "stretch", "slide"))
            frame = self._scene.add_frame(path, show_axes=False, position=at, wxyz=turned)
            shown = self._shown(f"{path}/m", part)
            if moves:
                self._moving.append(_Moving(part, frame, shown, at, turned))

    def _shown(self, path: str, part: dict[str, Any]) -> Any:
        """Add what is seen of a part."""
        opacity = part.get("opacity", 1.0) * (0.35 if self._ghost else 1.0)
        if "file" in part:
            return self._from_file(path, part)
        mesh = mesh_of(part)
        assert mesh is not None
        return self._scene.add_mesh_simple(
            path,
            mesh.vertices,
            mesh.faces,
            color=rgb(part.get("colour", "#8795a1")),
            opacity=opacity if opacity < 1.0 else None,
            flat_shading="hull" not in part,
            side="double",
        )

    def _from_file(self, path: str, part: dict[str, Any]) -> Any:
        """Add a mesh that the run's folder has; nothing is seen of one that has gone."""
        file = self._folder / MESHES / mesh_name(part["file"], part.get("sha256", ""))
        if not file.is_file():
            return self._scene.add_frame(path, show_axes=False)
        if file.suffix == ".glb":
            return self._scene.add_glb(path, file.read_bytes(), scale=part.get("scale", 1.0))
        import trimesh

        try:
            loaded: Any = trimesh.load_mesh(file)
            vertices, faces = np.asarray(loaded.vertices), np.asarray(loaded.faces)
        except Exception:  # a reader of any file: what it raises is not said anywhere
            return self._scene.add_frame(path, show_axes=False)
        return self._scene.add_mesh_simple(
            path,
            vertices * part.get("scale", 1.0),
            faces,
            color=rgb(part.get("colour", "#8795a1")),
            side="double",
        )


class _Moving:
    """A part that follows signals."""

    def __init__(self, part: dict[str, Any], frame: Any, shown: Any, at: FloatArray, turn: Any):
        self._part, self._frame, self._shown = part, frame, shown
        self._at, self._turn = at, turn

    def show(self, frame: Frame) -> None:
        if (turn := self._part.get("turn")) and (value := _value(turn, frame)) is not None:
            by = quaternions.about(turn["about"], value * turn.get("factor", 1.0))
            self._frame.wxyz = quaternions.product(self._turn, by)
        if (slide := self._part.get("slide")) and (value := _value(slide, frame)) is not None:
            self._frame.position = self._at + value * np.array(slide["along"])
        if (stretch := self._part.get("stretch")) and (value := _value(stretch, frame)) is not None:
            share = value / stretch["full"]
            share = math.copysign(min(max(abs(share), 1e-3), _MOST_STRETCHED), share)
            self._shown.scale = (share, 1.0, 1.0)


def _value(moved: Mapping[str, Any], frame: Frame) -> float | None:
    value = frame.value(moved["signal"])
    return None if value is None else value * moved.get("gain", 1.0) + moved.get("offset", 0.0)


def _turned(part: Mapping[str, Any]) -> FloatArray:
    return quaternions.of_euler(np.radians(part.get("turned", (0.0, 0.0, 0.0))))


def _on_decks(motion: Motion) -> list[tuple[FloatArray, dict[str, Any], int]]:
    """Return place, entry and craft's number of what stands on decks and has a shape."""
    run: Run = motion.run
    numbers = {craft.component: number for number, craft in enumerate(motion.crafts)}
    found = []
    for name, entry, ports in viewed(run.manifest, "landing-point"):
        if name in numbers or not entry.get("shape"):
            continue
        feeding = [row[0] for row in run.manifest["connections"] if row[1] == f"{name}.attitude"]
        craft = numbers.get(feeding[0].rpartition(".")[0]) if feeding else None
        if craft is not None:
            values = entry["parameters"]
            place = [values.get(f"{ports['place']}.{a}", {"value": 0.0})["value"] for a in "xyz"]
            found.append((np.array(place, dtype=float), entry, craft))
    return found


def rgb(colour: str) -> tuple[int, int, int]:
    """Return a colour written #rrggbb as numbers from 0 to 255."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
