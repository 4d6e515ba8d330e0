"""Description of the vehicle as URDF, from the shape of its file: for RViz and Foxglove.

One link, base_link, in its own axes, ahead-left-up, with a visual for each part. A hull and a plate
are the boxes about them; parts that follow a port are drawn at rest; jets of water and parts from
files are left out.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

import numpy as np

from seatrial.physics.craft.kinematics import rotation

from .frames import TO_FLU

Part = Mapping[str, Any]
Placed = tuple[np.ndarray, np.ndarray]
"""Origin and axes of a part, in body axes bow-starboard-down."""
_ALONG_X = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Axes of a cylinder of URDF, which is along its z, in those of one along x."""


def urdf(name: str, shape: str, link: str) -> str:
    """Return the URDF of the ``shape``, JSON of its parts as the vehicle's file has them."""
    robot = ElementTree.Element("robot", name=name)
    drawn = ElementTree.SubElement(robot, "link", name=link)
    places: dict[str, Placed] = {}
    for number, part in enumerate(json.loads(shape or "[]")):
        at, turn = _placed(part, places)
        if part.get("name"):
            places[part["name"]] = at, turn
        found = _geometry(part)
        if found is not None:
            kind, sizes, middle, own = found
            visual = ElementTree.SubElement(drawn, "visual", name=f"part_{number}")
            _origin(visual, at + turn @ middle, turn @ own)
            geometry = ElementTree.SubElement(visual, "geometry")
            ElementTree.SubElement(geometry, kind, sizes)
            _material(visual, f"colour_{number}", part)
    return ElementTree.tostring(robot, encoding="unicode")


def _placed(part: Part, places: Mapping[str, Placed]) -> Placed:
    turn = np.array(rotation(*(math.radians(angle) for angle in part["turned"])))
    at = np.array(part["at"])
    if part.get("on"):
        base, axes = places[part["on"]]
        return base + axes @ at, axes @ turn
    return at, turn


def _geometry(part: Part) -> tuple[str, dict[str, str], np.ndarray, np.ndarray] | None:
    """Return kind, sizes, middle and axes of what a part is drawn as; None for what is left out."""
    middle, plain = np.zeros(3), np.eye(3)
    if part.get("stretch"):
        return None
    if part.get("box"):
        return "box", _box(part["box"]), middle, plain
    if part.get("cylinder") or part.get("capsule"):
        whole = part.get("cylinder") or part["capsule"]
        ends = 2.0 * whole["radius"] if part.get("capsule") else 0.0
        sizes = {"radius": _number(whole["radius"]), "length": _number(whole["length"] + ends)}
        return "cylinder", sizes, middle, _ALONG_X
    if part.get("hull"):
        hull = part["hull"]
        deep, high = max(hull["draught"]), hull["freeboard"]
        middle = np.array([0.0, 0.0, 0.5 * (deep - high)])
        return "box", _box([hull["length"], max(hull["beam"]), deep + high]), middle, plain
    if part.get("plate"):
        corners = np.array(part["plate"]["outline"])
        low, far = corners.min(axis=0), corners.max(axis=0)
        middle = np.array([0.5 * (low[0] + far[0]), 0.0, 0.5 * (low[1] + far[1])])
        size = far - low
        return "box", _box([size[0], part["plate"]["thickness"], size[1]]), middle, plain
    return None


def _origin(visual: ElementTree.Element, at: np.ndarray, turn: np.ndarray) -> None:
    """Write a place in ahead-left-up; rpy are angles about the fixed x, y and z, in this order."""
    r = TO_FLU @ turn @ TO_FLU
    pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    roll, yaw = math.atan2(r[2, 1], r[2, 2]), math.atan2(r[1, 0], r[0, 0])
    if math.hypot(r[0, 0], r[1, 0]) < 1e-9:  # roll and yaw turn about one axis
        roll, yaw = 0.0, math.atan2(-r[0, 1], r[1, 1])
    xyz = _numbers(TO_FLU @ at)
    ElementTree.SubElement(visual, "origin", xyz=xyz, rpy=_numbers((roll, pitch, yaw)))


def _material(visual: ElementTree.Element, name: str, part: Part) -> None:
    red, green, blue = (int(part["colour"][i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    material = ElementTree.SubElement(visual, "material", name=name)
    shade = _numbers((red, green, blue, part["opacity"]))
    ElementTree.SubElement(material, "color", rgba=shade)


def _box(sizes: Sequence[float]) -> dict[str, str]:
    return {"size": _numbers(sizes)}


def _numbers(values: Any) -> str:
    return " ".join(map(_number, values))


def _number(value: float) -> str:
    return f"{value:.6g}"
