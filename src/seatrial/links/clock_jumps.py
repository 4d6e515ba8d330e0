"""Clocks of recorders that were set while they recorded."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SET_BACK = 1.0
"""s; a clock that goes back by more, and stays there, was set."""
SET_FORWARD = 86400.0
"""s; a longer time without an entry is a clock that was set: a receiver that found its date."""

_LOOKED_AT = 20
"""Entries after a step back that are looked at."""


def clock_jumps(times: Array) -> tuple[NDArray[np.int64], Array]:
    """Return where the clock of entries in the order of a file was set, and what each adds.

    ``times`` (n,), s, finite. The first array has the indices of the first entries after, the
    second what has to be added to the times from there on so that they follow the latest before by
    a usual step. Entries that are behind while others go on, as those of a second and slower
    device, are late and no clock that was set.
    """
    steps = np.diff(times)
    places = np.flatnonzero((steps < -SET_BACK) | (steps > SET_FORWARD)) + 1
    usual = usual_step(times) if len(places) else 0.0
    found: list[int] = []
    shifts: list[float] = []
    latest, shift, done = -np.inf, 0.0, 0
    for place in places:
        latest = max(latest, float(times[done:place].max()) + shift)
        done = int(place)
        ahead = float(times[place]) + shift - latest
        is_set = abs(ahead) > SET_FORWARD or (
            ahead < -SET_BACK and _stays(times[place:], latest - shift, -ahead, usual)
        )
        if is_set:
            shift = latest + usual - float(times[place])
            found.append(int(place))
            shifts.append(shift)
    return np.array(found, np.int64), np.array(shifts, np.float64)


def _stays(times: Array, latest: float, behind: float, usual: float) -> bool:
    """Say if entries stay behind the latest before, so many as a clock set back leaves there."""
    count = min(math.ceil(behind / usual) if usual > 0.0 else 1, _LOOKED_AT)
    return bool(times[:count].max() < latest)


def usual_step(times: Array) -> float:
    """Return the median time, s, from an entry (n,) to a later one within a day; 0 without any."""
    steps = np.diff(times)
    rising = steps[(steps > 0.0) & (steps < SET_FORWARD)]
    return float(np.median(rising)) if len(rising) else 0.0
