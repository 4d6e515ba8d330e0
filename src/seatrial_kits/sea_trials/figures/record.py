"""Record of a manoeuvre: checked arrays, and cubic interpolation of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from seatrial.errors import InputError
from seatrial_kits.logs.paired.common_time import GAP, unwrapped

Array = NDArray[np.float64]

_LEAST_ROWS = 8
_LARGEST_HELM = math.pi


@dataclass(frozen=True, eq=False)
class Record:
    """What was measured during a manoeuvre: arrays (n,), SI, angles in rad.

    ``time`` rises, and no step is longer than five usual ones. ``north`` and ``east`` are those of
    the reference point, midship by the convention of the IMO, over ground; ``heading`` is
    clockwise from north, wrapped or not, and unwrapped here. ``helm`` is positive to turn to
    starboard: an angle, or the share of full helm from -1 to 1. ``roll`` is positive to starboard,
    ``depth`` down, ``pitch`` bow up; ``power`` in W, ``pull`` of a line in N. What was not measured
    is None.

    Between rows, values are those of the cubic spline through all of them (not-a-knot).

    Raises InputError for less than eight rows, arrays of different lengths, values that are not
    finite, time that does not rise, gaps, a heading that turns by more than 90 deg from one row to
    the next or faster than 30 rad/s (degrees in place of radians), and a helm beyond pi.
    """

    time: Any
    north: Any
    east: Any
    heading: Any
    helm: Any = None
    roll: Any = None
    depth: Any = None
    pitch: Any = None
    power: Any = None
    pull: Any = None

    def __post_init__(self) -> None:
        columns = {name: np.asarray(values, np.float64) for name, values in self.columns().items()}
        _check_shapes(columns)
        _check_time(columns["time"])
        _check_helm(columns.get("helm"))
        columns["heading"] = unwrapped(columns["time"], columns["heading"], _heading_at)
        for name, column in columns.items():
            object.__setattr__(self, name, column)

    # ------------------------------------------------------------------ interpolation

    @cached_property
    def place(self) -> CubicSpline:
        """Spline of north and east over time, m."""
        return CubicSpline(self.time, np.column_stack((self.north, self.east)))

    @cached_property
    def course_kept(self) -> CubicSpline:
        """Spline of the unwrapped heading over time, rad."""
        return CubicSpline(self.time, self.heading)

    @property
    def start(self) -> float:
        """Time of the first row, s."""
        return float(self.time[0])

    @property
    def end(self) -> float:
        """Time of the last row, s."""
        return float(self.time[-1])

    def columns(self) -> dict[str, Array]:
        """Return what was measured, by name."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: values for name, values in found.items() if values is not None}

    def spline(self, name: str) -> CubicSpline:
        """Return the spline of another column; raises InputError if it was not measured."""
        column = getattr(self, name)
        if column is None:
            raise InputError(f"the record has no {name}")
        return CubicSpline(self.time, column)

    def speed(self, at: Any) -> Array:
        """Return the speed of the reference point over ground, m/s."""
        velocity = self.place(at, 1)
        return np.asarray(np.hypot(velocity[..., 0], velocity[..., 1]))

    def track(self, first: float, last: float) -> float:
        """Return the distance along the path between two times, m: Simpson's rule per row."""
        inside = self.time[(self.time > first) & (self.time < last)]
        nodes = np.concatenate(([first], inside, [last]))
        middle = (nodes[1:] + nodes[:-1]) / 2.0
        speeds = self.speed(nodes)
        sums = speeds[1:] + 4.0 * self.speed(middle) + speeds[:-1]
        return float(np.sum(np.diff(nodes) * sums) / 6.0)

    # ------------------------------------------------------------------ other frames

    def through_water(self, north: float, east: float, at: float) -> Record:
        """Return the record in water that moves by (north, east), m/s, which is in place at ``at``.

        Positions become x - c (t - at): figures of the water, as IMO MSC/Circ.1053 wants them.
        """
        elapsed = self.time - at
        return replace(self, north=self.north - north * elapsed, east=self.east - east * elapsed)

    def of_point(self, ahead: float) -> Record:
        """Return the record of the point ``ahead`` m before the one that was recorded."""
        north = self.north + ahead * np.cos(self.heading)
        return replace(self, north=north, east=self.east + ahead * np.sin(self.heading))


# ---------------------------------------------------------------------- checks


def _check_shapes(columns: dict[str, Array]) -> None:
    rows = columns["time"].shape
    if len(rows) != 1 or rows[0] < _LEAST_ROWS:
        raise InputError(f"time: at least {_LEAST_ROWS} rows are needed, found {rows}")
    for name, column in columns.items():
        if column.shape != rows:
            raise InputError(f"{name}: {rows[0]} values are needed, found {column.shape}")
        wrong = np.flatnonzero(~np.isfinite(column))
        if len(wrong):
            raise InputError(
                f"{name}: row {wrong[0] + 1}: a finite number is needed, found {column[wrong[0]]}"
            )


def _check_time(time: Array) -> None:
    steps = np.diff(time)
    back = np.flatnonzero(steps <= 0.0)
    if len(back):
        row = int(back[0])
        raise InputError(
            f"time: row {row + 2}: {time[row + 1]:g} s follows {time[row]:g} s; time must rise"
        )
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * usual)
    if len(gaps):
        row = int(gaps[0])
        raise InputError(
            f"time: a gap from {time[row]:g} s to {time[row + 1]:g} s; rows are usually "
            f"{usual:g} s apart, up to {GAP:g} times that is allowed"
        )


def _heading_at(row: int) -> str:
    return f"heading: row {row + 1}"


def _check_helm(helm: Array | None) -> None:
    if helm is not None and np.abs(helm).max() > _LARGEST_HELM:
        raise InputError(
            f"helm: {np.abs(helm).max():g} is beyond pi: radians, or shares of full helm from -1 "
            "to 1 are needed, not degrees"
        )
