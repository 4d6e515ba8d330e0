"""What components declare to be seen (`ports.VIEWS`): decks, fields of view, forecasts, states."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

import numpy as np

from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records import quaternions
from seatrial.trial.records.run_folder import viewed

from .motion import NED_IN_ENU, Frame, Motion

_AROUND = 32
_EDGE, _TARGET = (245, 246, 247), (240, 176, 32)
_SEEN, _UNSEEN = (36, 168, 96), (214, 60, 44)
_NOW, _AHEAD = (170, 60, 200), (214, 96, 236)
_THROUGH = 0.24
"""Opacity of what must not hide the rest."""
_OVER = 0.006
"""Of lines over the deck that they are on, m."""


class Views:
    """Views of a run's components in its scene; `show` moves what moves.

    ``level`` is how high crests reach, m: what is seen of the water is drawn over them.
    """

    def __init__(self, scene: Any, motion: Motion, root: str, size: float, level: float) -> None:
        self._moving: list[Any] = []
        decks = list(_carried(motion, "deck"))
        for number, (craft, entry, ports) in enumerate(decks):
            _lines(scene, f"{root}/craft{craft}/edge{number}", _edge(entry, ports), _EDGE, 3.0)
        for number, (craft, entry, ports) in enumerate(_carried(motion, "target")):
            ring = _ring(_vector(entry, ports["place"]), _value(entry, ports["radius"]))
            _lines(scene, f"{root}/craft{craft}/target{number}", ring, _TARGET, 2.5)
        for number, found in enumerate(_carried(motion, "field-of-view")):
            self._moving.append(_FieldOfView(scene, f"{root}/view{number}", level, *found))
        corners = _edge(*decks[0][1:], level=True) if decks else _square(0.5 * size)
        for number, found in enumerate(_carried(motion, "foreseen")):
            self._moving.append(_Foreseen(scene, f"{root}/foreseen{number}", corners, *found))
        states: dict[int, list[Any]] = {}
        for craft, entry, ports in _carried(motion, "state"):
            states.setdefault(craft, []).append((entry, ports))
        self._states = {
            motion.crafts[craft].name: _State(scene, f"{root}/craft{craft}/state", entries, size)
            for craft, entries in states.items()
        }
        self._moving += self._states.values()

    def show(self, frame: Frame) -> None:
        """Move everything to where it is in a frame."""
        for each in self._moving:
            each.show(frame)

    def words(self, frame: Frame) -> str:
        """Return what the craft say of their states, with their names."""
        said = {name: state.text(frame) for name, state in self._states.items()}
        return "; ".join(f"{name}: {text}" for name, text in said.items() if text)


class _FieldOfView:
    """The cone that a camera sees, down to the water or its reach: green while it sees its mark."""

    def __init__(
        self,
        scene: Any,
        path: str,
        level: float,
        craft: int,
        entry: Mapping[str, Any],
        ports: Mapping[str, str],
    ) -> None:
        self._craft, self._seen = craft, f"{entry['name']}.{ports['seen']}"
        self._level = level
        self._height, self._reach = (_value(entry, ports[port]) for port in ("height", "reach"))
        angle = np.linspace(0.0, math.tau, _AROUND, endpoint=False)
        half = _value(entry, ports["angle"])
        across = math.sin(half)
        self._rays = np.stack(
            [across * np.cos(angle), across * np.sin(angle), 0.0 * angle + math.cos(half)], 1
        )
        i = np.arange(_AROUND)
        faces = np.stack([0 * i, 1 + i, 1 + (i + 1) % _AROUND], 1)
        corners = np.zeros((_AROUND + 1, 3), dtype=np.float32)
        self._cone = scene.add_mesh_simple(
            f"{path}/cone", corners, faces, color=_SEEN, opacity=_THROUGH, side="double"
        )
        self._rims = [
            _lines(scene, f"{path}/rim{number}", np.zeros((_AROUND, 3)), colour, 2.5)
            for number, colour in enumerate((_UNSEEN, _SEEN))
        ]

    def show(self, frame: Frame) -> None:
        pose = frame.pose(self._craft)
        lens = pose.position + quaternions.turned(pose.wxyz, [0.0, 0.0, self._height])
        rays = quaternions.turned(pose.wxyz, self._rays)
        down = np.maximum(-rays[:, 2], 1e-9)
        far = np.full(len(down), self._reach)
        if lens[2] > -self._level:
            far = np.minimum(far, max(lens[2] - self._level, 0.0) / down)
        ends = lens + rays * far[:, None]
        self._cone.vertices = np.concatenate([[lens], ends]).astype(np.float32)
        seen = bool(frame.value(self._seen))
        self._cone.color = _SEEN if seen else _UNSEEN
        self._rims[seen].points = _closed(ends)
        for number, rim in enumerate(self._rims):
            rim.visible = number == seen


class _Foreseen:
    """A pad where it is taken to be, as a cross, and the deck where it is expected, as a plate."""

    def __init__(
        self,
        scene: Any,
        path: str,
        corners: FloatArray,
        craft: int,
        entry: Mapping[str, Any],
        ports: Mapping[str, str],
    ) -> None:
        self._ports = {port: f"{entry['name']}.{of_it}" for port, of_it in ports.items()}
        self._craft = craft
        arm = 0.25 * float(np.ptp(corners[:, 0]))
        cross = np.array([[[-arm, 0, 0], [arm, 0, 0]], [[0, -arm, 0], [0, arm, 0]]])
        rise = np.array([[[0, 0, 0.4 * arm], [0, 0, -0.4 * arm]]])
        self._pad = _segments(scene, f"{path}/pad", np.concatenate([cross, rise]), _NOW, 4.0)
        self._deck = scene.add_mesh_simple(
            f"{path}/deck",
            corners,
            np.array([[0, 1, 2], [0, 2, 3]]),
            color=_AHEAD,
            opacity=1.5 * _THROUGH,
            side="double",
        )
        _lines(scene, f"{path}/deck/edge", corners, _AHEAD, 2.5)
        self._label = scene.add_label(f"{path}/deck/time", "deck", position=tuple(corners[1]))

    def show(self, frame: Frame) -> None:
        when = frame.value(self._ports["time"])
        now, ahead = (_of(frame, self._ports[port], "north east down") for port in ("now", "place"))
        turn = _of(frame, self._ports["turn"], "phi theta psi")
        if not when or now is None or ahead is None or turn is None:
            self._pad.visible = self._deck.visible = self._label.visible = False
            return
        self._pad.visible = self._deck.visible = self._label.visible = True
        self._pad.position = frame.place(self._craft, now)
        self._deck.position = frame.place(self._craft, ahead)
        self._deck.wxyz = quaternions.product(NED_IN_ENU, quaternions.of_euler(turn))
        aim = frame.value(self._ports["aim"])
        what = "touch-down" if aim and aim >= frame.time else "deck expected"
        _say(self._label, f"{what} in {max(when - frame.time, 0.0):.1f} s")


class _State:
    """Words over a craft for the states of its components."""

    def __init__(self, scene: Any, path: str, entries: list[Any], size: float) -> None:
        self._of = [
            (f"{entry['name']}.{ports['value']}", ports["first"], ports["words"].split(","))
            for entry, ports in entries
        ]
        self._label = scene.add_label(path, "state", position=(0.0, 0.0, -0.35 * size))

    def show(self, frame: Frame) -> None:
        text = self.text(frame)
        self._label.visible = bool(text)
        if text:
            _say(self._label, text)

    def text(self, frame: Frame) -> str:
        said = [word_of(frame.value(signal), first, words) for signal, first, words in self._of]
        return ", ".join(word for word in said if word)


def html_of_words(words: str) -> str:
    """Return what craft say of their states for a panel; names are escaped."""
    return f'<div class="words" style="padding:0 .8em">{escape(words)}</div>' if words else ""


def word_of(value: float | None, first: str, words: list[str]) -> str:
    """Return the word for a number of a state; empty for none."""
    place = -1 if value is None or not first.lstrip("-").isdigit() else round(value) - int(first)
    return words[place].strip() if 0 <= place < len(words) else ""


def _carried(motion: Motion, kind: str) -> Iterator[tuple[int, dict[str, Any], dict[str, str]]]:
    """Yield craft's number, entry with its name, and ports of the views that a craft carries."""
    manifest = motion.run.manifest
    numbers = {craft.component: number for number, craft in enumerate(motion.crafts)}
    feeding = {row[1]: row[0] for row in manifest["connections"]}
    for name, entry, ports in viewed(manifest, kind):
        source = feeding.get(f"{name}.{ports['attitude']}", "").rpartition(".")[0]
        if (craft := numbers.get(source)) is not None:
            yield craft, {**entry, "name": name}, ports


def _value(entry: Mapping[str, Any], parameter: str) -> float:
    return float(entry["parameters"].get(parameter, {"value": 0.0})["value"])


def _vector(entry: Mapping[str, Any], parameter: str) -> FloatArray:
    return np.array([_value(entry, f"{parameter}.{axis}") for axis in "xyz"])


def _edge(entry: Mapping[str, Any], ports: Mapping[str, str], *, level: bool = False) -> FloatArray:
    """Return the corners of a deck, in its craft's axes; ``level``: about its place."""
    half = [0.5 * _value(entry, f"{ports['size']}.{axis}") for axis in "xy"]
    corners = _square(1.0) * [*half, 0.0]
    up = 0.0 if level else _value(entry, f"{ports['place']}.z") - _OVER
    return np.asarray(np.add(corners, [0.0, 0.0, up]), dtype=np.float64)


def _square(half: float) -> FloatArray:
    return half * np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]])


def _ring(middle: FloatArray, radius: float) -> FloatArray:
    angle = np.linspace(0.0, math.tau, _AROUND, endpoint=False)
    flat = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], 1)
    return middle + radius * flat - [0.0, 0.0, _OVER]


def _of(frame: Frame, signal: str, axes: str) -> FloatArray | None:
    values = [frame.value(f"{signal}.{axis}") for axis in axes.split()]
    return None if None in values else np.array(values, dtype=float)


def _closed(corners: FloatArray) -> Any:
    return np.stack([corners, np.roll(corners, -1, axis=0)], 1).astype(np.float32)


def _lines(scene: Any, path: str, corners: FloatArray, colour: Any, width: float) -> Any:
    """Add the closed line through corners."""
    return _segments(scene, path, _closed(corners), colour, width)


def _segments(scene: Any, path: str, points: Any, colour: Any, width: float) -> Any:
    return scene.add_line_segments(
        path, np.asarray(points, np.float32), colour, thickness=width, thickness_units="screen"
    )


def _say(label: Any, text: str) -> None:
    if label.text != text:
        label.text = text
