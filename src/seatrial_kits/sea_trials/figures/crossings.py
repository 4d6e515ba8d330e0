"""Instants of a record: the order, crossings of a level, extrema."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from seatrial.errors import InputError

from .record import Array, Record

_CLEAR = math.radians(5.0)
"""Heading change that is due to the helm."""
_ROOT = 1e-9
"""Error of a crossing, s."""
_LATE = 0.1
"""Largest rate of turn at the order, as a share of the largest in the record."""
_STRAIGHT = 1e-3
"""rad/s; a rate of turn within which every approach is straight."""
_APPROACH = 60.0
"""Length of the approach that must be straight, s."""
_LEAST = 4
"""Rows of heading that show a rate."""
_LOW, _HIGH = 0.02, 0.1
"""Shares of the first change of helm through which its ramp is extended back to the order."""


def crossings(curve: CubicSpline, level: float, first: float, last: float) -> Array:
    """Return the times in (first, last] at which a spline has a value, ascending, to 1e-9 s.

    A crossing lies between two rows with the level between them.
    """
    inside = curve.x[(curve.x > first) & (curve.x < last)]
    times = np.concatenate(([first], inside, [last]))
    above = curve(times) - level
    changes = np.flatnonzero((above[:-1] * above[1:] < 0.0) | (above[1:] == 0.0))
    return np.array(
        [
            brentq(lambda at: float(curve(at)) - level, times[n], times[n + 1], xtol=_ROOT)
            if above[n + 1]
            else times[n + 1]
            for n in changes
        ]
    )


def crossing(curve: CubicSpline, level: float, first: float, last: float) -> float | None:
    """Return the first time in (first, last] at which a spline has a value, s; None without."""
    found = crossings(curve, level, first, last)
    return float(found[0]) if len(found) else None


def largest(curve: Any, first: float, last: float) -> tuple[float, float]:
    """Return time and value of the largest value of a spline in [first, last]."""
    inner = np.asarray(curve.derivative().roots(extrapolate=False))
    inner = inner[np.isfinite(inner)]
    times = np.concatenate(([first, last], inner[(inner > first) & (inner < last)]))
    values = curve(times)
    best = int(np.argmax(values))
    return float(times[best]), float(values[best])


def order_time(record: Record) -> float:
    """Return the instant of the order, s: when the helm begins to leave its first value.

    A helm that moves at a rate is extended back along its ramp; a helm order that steps is given
    at the row with its new value. Without helm, or with one that is over from the beginning, the
    order is at the first row.
    """
    if record.helm is None or _is_over(record):
        return record.start
    change = np.abs(record.helm - record.helm[0])
    moved = np.flatnonzero(change > _HIGH * change.max())
    if not len(moved):
        return record.start
    row = int(moved[0])
    # The first plateau or extremum is the change that was ordered.
    after = change[row:]
    falls = np.flatnonzero(np.diff(after) <= 0.0)
    ordered = float(after[falls[0]] if len(falls) else after[-1])
    if change[row] >= ordered and change[row - 1] <= _LOW * ordered:
        return float(record.time[row])
    at = []
    for share in (_LOW, _HIGH):
        below = int(np.flatnonzero(change[: row + 1] <= share * ordered)[-1])
        ramp = slice(below, below + 2)
        at.append(float(np.interp(share * ordered, change[ramp], record.time[ramp])))
    slope = (at[1] - at[0]) / (_HIGH - _LOW)
    return max(at[0] - _LOW * slope, record.start)


def check_approach(record: Record, order: float) -> None:
    """Raise InputError if the record starts in a turn.

    The rate of turn must be within a tenth of the largest rate of the record, or 1e-3 rad/s: that
    at the order, or that of the line through the heading over the last 60 s before (through the
    first four rows where less is recorded before) less two of its standard deviations.
    """
    before = (record.time <= order) & (record.time >= order - _APPROACH)
    if before.sum() < _LEAST:
        before = record.time <= record.time[_LEAST - 1]
    line, covariance = np.polyfit(record.time[before] - order, record.heading[before], 1, cov=True)
    mean = abs(float(line[0])) - 2.0 * math.sqrt(float(covariance[0, 0]))
    rate = min(mean, abs(float(record.course_kept(order, 1))))
    fastest = float(np.abs(record.course_kept(record.time, 1)).max())
    if rate > max(_LATE * fastest, _STRAIGHT):
        raise InputError(
            f"the record starts in a turn: {math.degrees(rate):.3g} deg/s at the order, at "
            f"{order:g} s; up to a tenth of the largest rate, {math.degrees(fastest):.3g} deg/s, "
            "is allowed"
        )


def side_of(record: Record, order: float) -> float:
    """Return 1 for a manoeuvre that begins to starboard, -1 to port.

    The helm after the order decides; without helm the first heading change of a third of the
    largest one. Raises InputError for a record without a turn, and for one that turns by 5 deg
    against its helm: its helm has the opposite sign.
    """
    after = record.time >= order
    turned = record.heading[after] - float(record.course_kept(order))
    if record.helm is not None and _is_over(record):
        moved = record.helm
    elif record.helm is not None and np.ptp(record.helm):
        moved = record.helm[after] - record.helm[0]
    else:
        moved = turned
    far = np.flatnonzero(np.abs(moved) > np.abs(moved).max() / 3.0)
    if not len(far):
        raise InputError("the record holds no turn: neither helm nor heading changes")
    side = math.copysign(1.0, moved[far[0]])
    clear = np.flatnonzero(np.abs(turned) > _CLEAR)
    if len(clear) and side * turned[clear[0]] < 0.0:
        to, away = ("starboard", "port") if side > 0.0 else ("port", "starboard")
        raise InputError(
            f"the helm is to {to}, and the heading goes to {away}: helm is positive to turn to "
            "starboard; in a log of the opposite sign name it -NAME"
        )
    return side


def _is_over(record: Record) -> bool:
    """Return whether the helm is over in the first row: more than half of the most that it is."""
    return bool(abs(record.helm[0]) > 0.5 * np.abs(record.helm).max())
