"""Forces on the craft as arrows, from what is connected to them and recorded."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.system.paths import split_path

from .motion import Frame, Motion

_TERM = re.compile(r"force(_\d+)?")
"""Inputs of a craft in body axes, see `craft.six_dof` and `craft.planar`."""
_ATTACHED = "attachment_force"
"""In {n}: north, east, down."""
_COLOUR = (196, 68, 160)
_LONGEST = 2.0
"""Of an arrow, in sizes of the largest craft: that of the largest force so far."""


@dataclass(frozen=True)
class _Force:
    craft: int
    name: str
    signals: tuple[str, ...]
    in_body_axes: bool


class Forces:
    """Arrows at the origins of the craft; `show` moves them while they are wanted."""

    def __init__(self, scene: Any, motion: Motion, root: str, world: str, size: float) -> None:
        self._wanted = False
        self._frame: Frame | None = None
        self._size = size
        self._largest = 0.0
        self._drawn = []
        for number, force in enumerate(_forces(motion)):
            place = f"{root}/craft{force.craft}" if force.in_body_axes else world
            arrow = scene.add_arrows(
                f"{place}/force{number}",
                np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, size]]]),
                _COLOUR,
                shaft_radius=0.03 * size,
                head_radius=0.09 * size,
                head_length=0.22 * size,
                visible=False,
            )
            label = scene.add_label(f"{place}/force{number}/n", force.name, visible=False)
            self._drawn.append((force, arrow, label))
            columns = [motion.run.signals.get(signal) for signal in force.signals]
            squares = sum(np.square(c) for c in columns if isinstance(c, np.ndarray))
            self._largest = max(self._largest, float(np.sqrt(np.nanmax(squares, initial=0.0))))

    def add_switch(self, gui: Any) -> None:
        """Let viewers want them, if there are any."""
        if not self._drawn:
            return
        box = gui.add_checkbox("forces as arrows", False)

        def switched(_: Any) -> None:
            self._wanted = box.value
            if self._frame is not None:
                self.show(self._frame)

        box.on_update(switched)

    def show(self, frame: Frame) -> None:
        """Draw each force that is known and not 0, if they are wanted."""
        self._frame = frame
        for force, arrow, label in self._drawn:
            values = [frame.value(signal) for signal in force.signals] if self._wanted else [None]
            is_known = any(value for value in values)
            arrow.visible = label.visible = is_known
            if not is_known:
                continue
            vector = np.array([value or 0.0 for value in values] + [0.0] * (3 - len(values)))
            length = float(np.linalg.norm(vector))
            self._largest = max(self._largest, length)
            way = vector if force.in_body_axes else vector[[1, 0, 2]] * [1.0, 1.0, -1.0]
            tip = way / self._largest * _LONGEST * self._size
            arrow.points = np.array([[np.zeros(3), tip]], dtype=np.float32)
            if not force.in_body_axes:
                arrow.position = frame.pose(force.craft).position
            label.position = tip
            label.text = f"{force.name} {length:.3g} N"


def _forces(motion: Motion) -> Iterator[_Force]:
    manifest = motion.run.manifest
    numbers = {craft.component: number for number, craft in enumerate(motion.crafts)}
    for source, target, *_ in manifest["connections"]:
        craft, port = split_path(manifest["components"], target)
        in_body_axes = _TERM.fullmatch(port) is not None
        if craft not in numbers or not (in_body_axes or port == _ATTACHED):
            continue
        axes = ("x", "y", "z") if in_body_axes else ("north", "east", "down")
        signals = tuple(f"{source}.{axis}" for axis in axes)
        known = tuple(signal for signal in signals if signal in motion.run.signals)
        if known:
            name, _ = split_path(manifest["components"], source)
            yield _Force(numbers[craft], name, known, in_body_axes)
