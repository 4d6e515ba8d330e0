"""Block diagrams of rigs as SVG: components, inner rigs around them, what connects them."""

from __future__ import annotations

import itertools
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from ...system.paths import split_path
from .templates import environment

MOST_BOXES = 40
"""Boxes up to which every component has its own; else the innermost rigs are one box each."""
MOST_DRAWN = 200
"""Boxes up to which there is a diagram."""
_LONGEST = 32
"""Letters of a text; one that is longer is cut, and stands whole under the pointer."""
_SHORT = 18
"""Letters up to which an edge has the names of several ports."""
_LETTER, _SMALL = 7.7, 6.3
"""Width of a letter of a name and of other text, px: that of a wide font."""
_LINE = 15.0
"""Height of a line, px."""


@dataclass(frozen=True)
class Box:
    """A component, or a rig that is drawn as one."""

    lines: tuple[str, ...]
    """Its name, and what it is if its name does not say so."""
    title: str
    """Whole, for the pointer."""

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, px."""
        widths = [len(self.lines[0]) * _LETTER, *(len(line) * _SMALL for line in self.lines[1:])]
        return max(*widths, 40.0) + 20.0, len(self.lines) * _LINE + 14.0


@dataclass
class Edge:
    """All connections from one box to another."""

    source: int
    target: int
    ports: dict[str, None] = field(default_factory=dict)
    """Those that give, in their order."""
    connections: list[str] = field(default_factory=list)

    @property
    def label(self) -> str:
        """The ports that give, or how many connections there are."""
        given = ", ".join(self.ports)
        if len(self.ports) == 1 or len(given) <= _SHORT:
            return _cut(given)
        return f"{len(self.connections)} signals"

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the label, px."""
        return len(self.label) * _SMALL + 6.0, _LINE


@dataclass
class Scope:
    """A rig inside the rig: the numbers of its boxes, and rigs in it."""

    name: str
    boxes: list[int] = field(default_factory=list)
    inner: dict[str, Scope] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """Its name, not too long."""
        return _cut(self.name)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the label, px."""
        return len(self.label) * _LETTER + 6.0, _LINE

    def walk(self) -> Iterator[Scope]:
        """Yield the rigs in it, each before those in it."""
        for scope in self.inner.values():
            yield scope
            yield from scope.walk()


def diagram(components: Mapping[str, str], connections: Iterable[tuple[str, str]]) -> str | None:
    """Return a rig's block diagram as SVG; the same rig has the same bytes.

    ``components`` says what each is, by its path; ``connections`` are (from, to),
    ``path.port`` each. None of a rig without components, or with too many of them to be read.
    """
    boxed = _boxed(list(components))
    paths = list(dict.fromkeys(boxed.values()))
    if not 0 < len(paths) <= MOST_DRAWN:
        return None
    inside: dict[str, list[str]] = {}
    for component, path in boxed.items():
        inside.setdefault(path, []).append(component)
    boxes = [_box(path, inside[path], components) for path in paths]
    edges = _edges(boxed, {path: number for number, path in enumerate(paths)}, connections)
    top = _scopes(paths)
    layout = placed(laid_out(_dot(boxes, top, edges)))
    content = {
        "boxes": list(zip(boxes, layout.boxes, strict=True)),
        "edges": list(zip(edges, layout.edges, strict=True)),
        "scopes": list(zip(top.walk(), layout.scopes, strict=True)),
    }
    template = environment().get_template("diagram.svg.j2")
    return template.render(width=layout.width, height=layout.height, line=_LINE, **content)


def _boxed(components: list[str]) -> dict[str, str]:
    """Return the path of the box that each component is drawn in."""
    boxed = {component: component for component in components}
    while len(set(boxed.values())) > MOST_BOXES:
        deepest = max(path.count(".") for path in boxed.values())
        if not deepest:
            break
        boxed = {
            c: path.rpartition(".")[0] if path.count(".") == deepest else path
            for c, path in boxed.items()
        }
    return boxed


def _box(path: str, inside: list[str], components: Mapping[str, str]) -> Box:
    name = path.rpartition(".")[2]
    if inside != [path]:
        listed = "\n".join(f"{component}: {components[component]}" for component in inside)
        return Box((_cut(name), f"{len(inside)} components"), f"{path}\n{listed}")
    what = components[path]
    lines = (_cut(name),) if what == name else (_cut(name), _cut(what))
    return Box(lines, f"{path}: {what}")


def _edges(
    boxed: Mapping[str, str], numbers: Mapping[str, int], connections: Iterable[tuple[str, str]]
) -> list[Edge]:
    edges: dict[tuple[int, int], Edge] = {}
    for source, target in connections:
        giving, port = split_path(boxed, source)
        taking, _ = split_path(boxed, target)
        if giving not in boxed or taking not in boxed:
            continue
        ends = numbers[boxed[giving]], numbers[boxed[taking]]
        if ends[0] == ends[1] and giving != boxed[giving]:
            continue  # inside a rig that is one box
        edge = edges.setdefault(ends, Edge(*ends))
        edge.ports[port] = None
        edge.connections.append(f"{source} → {target}")
    return list(edges.values())


def _scopes(paths: list[str]) -> Scope:
    top = Scope("")
    for number, path in enumerate(paths):
        scope = top
        for name in path.split(".")[:-1]:
            scope = scope.inner.setdefault(name, Scope(name))
        scope.boxes.append(number)
    return top


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"


# ---------------------------------------------------------------------- for Graphviz


def _dot(boxes: list[Box], top: Scope, edges: list[Edge]) -> str:
    """Return the graph in DOT: numbers and sizes alone, no text.

    What a text measures on a machine would move the boxes, and names are somebody else's.
    """
    numbers = itertools.count()
    lines = ["digraph {", "rankdir=LR; nodesep=0.3; ranksep=0.5;"]
    lines += ['node [shape=box, fixedsize=true, label=""]; edge [arrowsize=0.7];']
    lines += _statements(top, boxes, numbers)
    for number, edge in enumerate(edges):
        lines.append(f"{edge.source} -> {edge.target} [id={number}, label={_space(edge.size)}];")
    return "\n".join([*lines, "}"])


def _statements(scope: Scope, boxes: list[Box], numbers: Iterator[int]) -> Iterator[str]:
    for number in scope.boxes:
        width, height = (length / PX_PER_INCH for length in boxes[number].size)
        yield f"{number} [width={width:.4f}, height={height:.4f}];"
    for inner in scope.inner.values():
        yield f"subgraph {CLUSTER}{next(numbers)} {{ labeljust=l; label={_space(inner.size)};"
        yield from _statements(inner, boxes, numbers)
        yield "}"


def _space(size: tuple[float, float]) -> str:
    """Return a label that takes a size, px, and is empty."""
    width, height = (round(length) for length in size)
    table = f'<TABLE BORDER="0" FIXEDSIZE="TRUE" WIDTH="{width}" HEIGHT="{height}">'
    return f"<{table}<TR><TD></TD></TR></TABLE>>"


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
