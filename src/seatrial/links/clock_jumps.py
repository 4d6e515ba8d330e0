"""Clocks of recorders that were set while they recorded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SET_BACK = 1.0
"""s; a clock that goes back by more, and stays there, was set."""
SET_FORWARD = 86400.0
"""s; a longer time without an entry is a clock that was set: a receiver that found its date."""


def clock_jumps(times: Array) -> tuple[NDArray[np.int64], Array]:
    """Return where the clock of entries in the order of a file was set, and what each adds.

    ``times`` (n,), s. The first array has the indices of the first entries after, the second what
    has to be added to the times from there on so that each follows the one before by a usual step.
    """
    steps = np.diff(times)
    following = np.append(times[2:], times[-1:]) if len(times) > 1 else times[:0]
    # A late entry alone goes back, too; after a clock that was set the next one is behind as well.
    stays = following[: len(steps)] < times[:-1]
    found = np.flatnonzero(((steps < -SET_BACK) & stays) | (steps > SET_FORWARD))
    return found + 1, np.cumsum(usual_step(times) - steps[found])


def usual_step(times: Array) -> float:
    """Return the median of the times between entries (n,) that rise, s; 0 without any."""
    steps = np.diff(times)
    rising = steps[steps > 0.0]
    return float(np.median(rising)) if len(rising) else 0.0
