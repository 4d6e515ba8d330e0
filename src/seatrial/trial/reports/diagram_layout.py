"""Graphviz' ``dot``, of pygraphviz' wheel: a graph laid out, and its places read."""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

PX_PER_INCH = 72.0
"""Graphviz writes sizes in inches, places in points; a point is one px here."""
CLUSTER = "cluster_"
_LABEL = 13.0
"""Height of a label, px."""
_NUMBER = re.compile(r"-?[\d.]+(?:e[+-]\d+)?")


@dataclass(frozen=True)
class Place:
    """A rectangle, px, from the picture's left and top."""

    left: float
    top: float
    width: float
    height: float


@dataclass(frozen=True)
class Way:
    """A line from box to box: SVG paths of it and of its arrow; the middle of its label, px."""

    line: str
    arrow: str
    x: float
    y: float


@dataclass(frozen=True)
class Layout:
    """Places of boxes, lines between them and rigs around them, each in the order of the graph."""

    width: float
    height: float
    boxes: list[Place]
    edges: list[Way]
    scopes: list[Place]


@cache
def laid_out(graph: str) -> str:
    """Return a graph in DOT with places, in Graphviz' JSON. Cases of a campaign share theirs.

    Where Graphviz loses an edge between clusters, as it does in some graphs, it ranks all nodes
    together instead, ``newrank``.
    """
    found = _drawn(graph)
    if all("pos" in edge for edge in json.loads(found).get("edges", ())):
        return found
    return _drawn(graph.replace("{", "{ newrank=true;", 1))


def _drawn(graph: str) -> str:
    import pygraphviz

    found: bytes = pygraphviz.AGraph(string=graph).draw(format="json0", prog="dot")
    return found.decode()


def placed(laid: str) -> Layout:
    """Read the places of nodes 0, 1, ..., edges of such ``id``, and clusters cluster_0, ..."""
    found = json.loads(laid)
    _, _, width, height = _numbers(found["bb"])
    objects: dict[str, dict[str, Any]] = {one["name"]: one for one in found["objects"]}
    boxes = {int(name): one for name, one in objects.items() if name.isdigit()}
    scopes = {
        int(name.removeprefix(CLUSTER)): one
        for name, one in objects.items()
        if name.startswith(CLUSTER)
    }
    edges = {int(one["id"]): one for one in found.get("edges", ())}
    ways = [_way(edges[number], height) for number in range(len(edges))]
    return Layout(
        width,
        height,
        [_around(boxes[number], height) for number in range(len(boxes))],
        _apart(ways),
        [_bounds(scopes[number], height) for number in range(len(scopes))],
    )


def _numbers(text: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(text)]


def _around(node: dict[str, Any], height: float) -> Place:
    x, y = _numbers(node["pos"])
    wide, high = (PX_PER_INCH * float(node[key]) for key in ("width", "height"))
    return _rounded(x - 0.5 * wide, height - y - 0.5 * high, wide, high)


def _bounds(cluster: dict[str, Any], height: float) -> Place:
    left, low, right, top = _numbers(cluster["bb"])
    return _rounded(left, height - top, right - left, top - low)


def _rounded(*numbers: float) -> Place:
    return Place(*(round(number, 1) for number in numbers))


def _way(edge: dict[str, Any], height: float) -> Way:
    """Return a line of cubic Bézier curves, ``e,TIP START C C P C C P ...`` in Graphviz' JSON."""
    numbers = _numbers(edge["pos"])
    points = [(x, height - y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
    tip, first, *rest = points
    line = f"M{_point(first)}C{' '.join(_point(point) for point in rest)}"
    x, y = _numbers(edge["lp"])
    return Way(line, _arrow(rest[-1], tip), round(x, 1), round(height - y, 1))


def _apart(ways: list[Way]) -> list[Way]:
    """Return lines whose labels do not lie on each other, as Graphviz leaves those there and back.

    That is so between boxes of one column.
    """
    places: Counter[tuple[int, int]] = Counter()
    apart = []
    for way in ways:
        place = round(way.x), round(way.y)
        apart.append(replace(way, y=way.y + places[place] * _LABEL))
        places[place] += 1
    return apart


def _arrow(foot: tuple[float, float], tip: tuple[float, float]) -> str:
    """Return a head from where the line ends to its tip."""
    (x, y), half = foot, 0.4
    aside = half * (tip[1] - y), -half * (tip[0] - x)
    corners = (tip, (x + aside[0], y + aside[1]), (x - aside[0], y - aside[1]))
    return f"M{'L'.join(_point(corner) for corner in corners)}Z"


def _point(point: tuple[float, float]) -> str:
    return f"{point[0]:.1f},{point[1]:.1f}"
