"""Sea bed and obstacles that are drawn, from the parameters of a run's components."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import Run
from seatrial_kits.underwater.seabed.obstacles import read_obstacles
from seatrial_kits.underwater.seabed.plane import Plane
from seatrial_kits.underwater.seabed.shapes import Box, Capsule, Cylinder, Shape

from .meshes import Mesh
from .water import Water

_CELLS = 40


def bottom(run: Run, east: float, north: float, reach: float) -> Mesh | None:
    """Return the sea bed about a place, ``reach`` across, m; None where there is none.

    A bed from a file is not drawn: the record has its name alone.
    """
    for parameters in _beds(run):
        depth = parameters["seabed_depth"]
        if not isinstance(depth, (int, float)) or depth <= 0.0 or parameters["seabed_file"]:
            continue
        slope, towards = (parameters[f"seabed_{key}"] for key in ("slope", "direction"))
        plane = Plane(float(depth), float(slope), float(towards))
        patch = Water(None, reach, _CELLS)
        corners = patch.vertices(0.0, east, north)
        corners[:, 2] = [-plane.depth_at(y, x) for x, y, _ in corners.tolist()]
        return Mesh(corners, patch.faces())
    return None


def obstacles(run: Run) -> Iterator[tuple[dict[str, Any], FloatArray, FloatArray]]:
    """Yield a part as of a shape, its place and its turn (w, x, y, z) in {n}, m, of each."""
    for parameters in _beds(run):
        text = parameters["obstacles"]
        if not isinstance(text, str) or not text:
            continue
        try:
            found = read_obstacles(text)
        except InputError:  # a component of somebody else with a parameter of this name
            continue
        for shape in found:
            yield _part(shape)
        return


def _part(shape: Shape) -> tuple[dict[str, Any], FloatArray, FloatArray]:
    if isinstance(shape, Box):
        half = 0.5 * shape.heading
        turn = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
        return {"box": list(shape.size)}, np.array(shape.centre), turn
    if isinstance(shape, Cylinder | Capsule):
        axis = np.array(shape.axis)
        turn = np.array([1.0 + axis[0], 0.0, -axis[2], axis[1]])  # the half way from x to it
        turn = turn / np.linalg.norm(turn) if axis[0] > -1.0 else np.array([0.0, 0.0, 0.0, 1.0])
        part = {shape.kind: {"radius": shape.radius, "length": shape.length}}
        return part, np.array(shape.bound[0]), turn
    centre, radius = shape.bound
    part = {"capsule": {"radius": radius, "length": 1e-6}}
    return part, np.array(centre), np.array([1.0, 0.0, 0.0, 0.0])


def _beds(run: Run) -> Iterator[dict[str, Any]]:
    for component in run.manifest["components"].values():
        parameters = component["parameters"]
        names = ("seabed_depth", "seabed_slope", "seabed_direction", "seabed_file", "obstacles")
        if all(name in parameters for name in names):
            yield {name: parameters[name]["value"] for name in names}
