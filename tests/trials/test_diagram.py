"""Block diagrams: all of a rig is in them, nothing lies on another, no name is markup."""

from __future__ import annotations

import re
from itertools import combinations
from typing import Any

import pytest
from lxml import etree

from seatrial.system.flattening import load_rig
from seatrial.trial.reports.diagram import MOST_BOXES, MOST_DRAWN, diagram
from tests.command import seatrial

EVIL = '</title><script>alert("x")</script>'
SVG = "{http://www.w3.org/2000/svg}"


class Drawing:
    """A diagram taken apart."""

    def __init__(self, text: str | None) -> None:
        assert text is not None
        self.root = etree.fromstring(text.encode())
        self.boxes = {
            self._title(group).partition(":")[0].partition("\n")[0]: self._rectangle(group)
            for group in self.root.iterfind(f"{SVG}g[@class='box']")
        }
        self.scopes = [
            self._bounds(one) for one in self.root.iterfind(f"{SVG}rect[@class='scope']")
        ]
        edges = [one for one in self.root.iterfind(f"{SVG}g") if "edge" in one.get("class")]
        self.connections = [line for one in edges for line in self._title(one).split("\n")]
        self.labels = [one.findtext(f"{SVG}text") for one in edges]
        self.ends = [
            re.findall(r"-?[\d.]+", one.findall(f"{SVG}path")[0].get("d")) for one in edges
        ]

    @staticmethod
    def _title(group: Any) -> str:
        return str(group.findtext(f"{SVG}title"))

    def _rectangle(self, group: Any) -> tuple[float, ...]:
        return self._bounds(group.find(f"{SVG}rect"))

    @staticmethod
    def _bounds(rectangle: Any) -> tuple[float, ...]:
        x, y, width, height = (float(rectangle.get(k)) for k in ("x", "y", "width", "height"))
        return x, y, x + width, y + height


def apart(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


def within(inner: tuple[float, ...], outer: tuple[float, ...]) -> bool:
    return (
        inner[0] >= outer[0] and inner[1] >= outer[1]
        and inner[2] <= outer[2] and inner[3] <= outer[3]
    )  # fmt: skip


@pytest.mark.slow
def test_a_shipped_rig_is_drawn_whole(tmp_path) -> None:
    done = seatrial("describe", "sil", "--vehicle", "otter", "--diagram", "g.svg", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "diagram: g.svg"
    drawing = Drawing((tmp_path / "g.svg").read_text("utf-8"))
    listed = [line.strip() for line in done.stdout.splitlines() if " -> " in line]
    ends = [re.split(r"\s+->\s+|  \(", line)[:2] for line in listed]
    assert sorted(drawing.connections) == sorted(f"{a} → {b}" for a, b in ends)
    parts = load_rig("sil", None, {"vehicle": "otter"}).components
    assert set(drawing.boxes) <= set(parts)
    assert {end.rpartition(".")[0] for pair in ends for end in pair}  # below: each has its box
    for end in (end for pair in ends for end in pair):
        assert any(end.startswith(f"{path}.") for path in drawing.boxes), end
    for (_, one), (_, other) in combinations(drawing.boxes.items(), 2):
        assert apart(one, other)
    inside = [box for path, box in drawing.boxes.items() if path.startswith("vehicle.")]
    assert any(all(within(box, scope) for box in inside) for scope in drawing.scopes)
    again = seatrial("describe", "sil", "--vehicle", "otter", "--diagram", "h.svg", cwd=tmp_path)
    assert again.returncode == 0
    assert (tmp_path / "h.svg").read_bytes() == (tmp_path / "g.svg").read_bytes()


def test_connections_of_two_components_are_one_line() -> None:
    joined = [("a.x", "b.u"), ("a.y", "b.v"), ("b.long_name_of_it", "a.u"), ("b.other_name", "a.v")]
    drawing = Drawing(diagram({"a": "gain", "b": "gain"}, [*joined, ("b.x", "b.w")]))
    assert drawing.labels == ["x, y", "2 signals", "x"]
    assert drawing.connections == [f"{one} → {other}" for one, other in [*joined, ("b.x", "b.w")]]


def test_a_line_goes_from_the_box_that_gives_to_the_one_that_takes() -> None:
    drawing = Drawing(diagram({"a": "gain", "b": "gain"}, [("b.x", "a.u")]))
    (line,) = drawing.ends
    begin = tuple(map(float, line[:2]))
    assert begin[0] == pytest.approx(drawing.boxes["b"][2], abs=1.0)
    assert drawing.boxes["b"][1] < begin[1] < drawing.boxes["b"][3]
    assert drawing.boxes["a"][0] > float(line[-2])  # then comes the arrow


def test_names_are_text_and_move_nothing() -> None:
    """Graphviz has escapes of its own, of \\N and HTML, in names."""
    for name in (EVIL, '"];evil[x="', "\\N\\G", "<b>bold</b>", "&amp;", "ж" * 200):
        text = diagram({name: name, "b": f"what {name}"}, [(f"{name}.{name}", "b.x")])
        drawing = Drawing(text)
        assert [one.tag for one in drawing.root.iter() if "script" in str(one.tag)] == []
        assert drawing.connections == [f"{name}.{name} → b.x"]
        harmless = Drawing(diagram({"n" * len(name): "n" * len(name), "b": f"what {'n' * len(name)}"},
                                   [(f"{'n' * len(name)}.{'n' * len(name)}", "b.x")]))  # fmt: skip
        assert list(drawing.boxes.values()) == list(harmless.boxes.values())


def test_of_large_rigs_the_innermost_are_one_box_each() -> None:
    parts = {f"boat{b}.engine.part{p}": "gain" for b in range(8) for p in range(6)}
    joined = [(f"boat{b}.engine.part{p}.y", f"boat{b}.engine.part{p + 1}.u")
             for b in range(8) for p in range(5)]  # fmt: skip
    joined.append(("boat0.engine.part0.y", "boat1.engine.part0.u"))
    assert len(parts) > MOST_BOXES
    drawing = Drawing(diagram(parts, joined))
    assert set(drawing.boxes) == {f"boat{b}.engine" for b in range(8)}
    assert drawing.connections == ["boat0.engine.part0.y → boat1.engine.part0.u"]
    assert diagram({f"part{n}": "gain" for n in range(MOST_DRAWN + 1)}, []) is None
    assert diagram({}, []) is None


def test_mistakes(tmp_path) -> None:
    done = seatrial("describe", "sil", "--diagram", "rig.png", cwd=tmp_path)
    assert done.returncode == 2
    assert "--diagram: rig.png: the drawing is SVG: a name that ends in .svg" in done.stderr
    done = seatrial("describe", "otter-straight", "--diagram", "none/rig.svg", cwd=tmp_path)
    assert done.returncode == 3, done.stderr
    assert "none/rig.svg: No such file or directory" in done.stderr
