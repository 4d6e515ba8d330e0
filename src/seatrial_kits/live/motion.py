"""Poses and signals of a run at any time, between the recorded rows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records import quaternions
from seatrial.trial.records.run_folder import Run
from seatrial.trial.records.scene import Craft, crafts

NED_IN_ENU = (0.0, math.sqrt(0.5), math.sqrt(0.5), 0.0)
"""Quaternion (w, x, y, z) that takes {n} to the world."""
_FRD = np.array([0.0, 1.0, 0.0, 0.0])
"""Quaternion (w, x, y, z) that takes ahead, starboard, down to ahead, left, up."""


@dataclass(frozen=True)
class Pose:
    """Of a craft's body axes (ahead, starboard, down) in the world (east, north, up), m."""

    position: FloatArray
    wxyz: FloatArray

    @property
    def ahead(self) -> FloatArray:
        """Horizontal unit vector to where the bow points."""
        w, x, y, z = self.wxyz
        bow = np.array([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 0.0])
        length = float(np.linalg.norm(bow))
        return bow / length if length > 0.0 else np.array([1.0, 0.0, 0.0])


class Frame:
    """A run at one time, linear between its rows."""

    def __init__(self, motion: Motion, time: float) -> None:
        self._motion = motion
        self.time = time
        """s."""
        rows = motion.run.time
        self.row = int(np.clip(np.searchsorted(rows, time, "right") - 1, 0, len(rows) - 1))
        """The last row that is not later."""
        self._next = min(self.row + 1, len(rows) - 1)
        span = rows[self._next] - rows[self.row]
        self._share = min(max((time - rows[self.row]) / span, 0.0), 1.0) if span > 0.0 else 0.0

    def pose(self, craft: int) -> Pose:
        """Return where a craft is, by its number in `Motion.crafts`."""
        of_it, turns = self._motion.crafts[craft], self._motion.turns[craft]
        turn = self._between(turns)
        return Pose(self._between(of_it.position), turn / np.linalg.norm(turn))

    def place(self, craft: int, ned: FloatArray) -> FloatArray:
        """Return a place in the {n} of a craft, m, in the world."""
        component = self._motion.crafts[craft].component
        own = self.values([f"{component}.position.{axis}" for axis in "xyz"])
        north, east, down = ned - own
        return np.asarray(np.add(self.pose(craft).position, [east, north, -down]), dtype=np.float64)

    def value(self, signal: str) -> float | None:
        """Return a signal; None if it was not recorded as a number, or is none here."""
        column = self._motion.run.signals.get(signal)
        if not isinstance(column, np.ndarray):
            return None
        value = float(self._between(column))
        return value if np.isfinite(value) else None

    def values(self, signals: list[str]) -> FloatArray:
        """Return signals that are recorded as numbers."""
        return np.array([self._between(self._motion.run.signals[name]) for name in signals])

    def _between(self, column: Any) -> FloatArray:
        before, after = column[self.row], column[self._next]
        return np.asarray(before + self._share * (after - before))


class Motion:
    """The craft of a run with a record of at least one row."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.crafts: list[Craft] = crafts(run, geodetic=False)
        self.turns = [_turns(craft) for craft in self.crafts]
        """Quaternions (w, x, y, z) of body axes with z down, row by row."""

    def at(self, time: float) -> Frame:
        """Return the run at a time, s; before its start and after its end, what was there."""
        return Frame(self, time)

    def tracks(self, columns: Mapping[str, FloatArray]) -> list[FloatArray]:
        """Return (east, north, up) of each craft for columns of its position in its own {n}.

        A craft with a home of its own is moved by as much as it is here.
        """
        found = []
        for craft in self.crafts:
            own = [columns.get(f"{craft.component}.position.{axis}") for axis in "xyz"]
            if any(column is None for column in own):
                found.append(craft.position)
                continue
            north, east, down = (np.asarray(column) for column in own)
            here = [self.run.signals[f"{craft.component}.position.{axis}"][-1] for axis in "yxz"]
            moved = craft.position[-1] - np.array(here) * [1.0, 1.0, -1.0]
            found.append(np.stack([east, north, -down], 1) + moved)
        return found

    @property
    def span(self) -> tuple[float, float]:
        """Times of the first and the last row, s."""
        return float(self.run.time[0]), float(self.run.time[-1])


def _turns(craft: Craft) -> FloatArray:
    down = quaternions.product(np.roll(craft.orientation, 1, axis=1), _FRD)
    return quaternions.continuous(down)
