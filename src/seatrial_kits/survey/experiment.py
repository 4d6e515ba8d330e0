"""The times at which an FMU is surveyed: those of its default experiment, as far as they go."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.model.component import NS

_MOST_STEPS = 1000
_STEPS = 100
"""Of an experiment that says no step."""
_LONGEST_S = 0.1
"""Of steps that are chosen here."""
_SHORTEST_S = 2.0**-9
"""The least power of two that is whole nanoseconds."""


@dataclass(frozen=True)
class Experiment:
    """Communication points ``start_ns + i step_ns``, i = 0 ... steps."""

    start_ns: int
    step_ns: int
    steps: int

    @property
    def stop_ns(self) -> int:
        """Last communication point, ns."""
        return self.start_ns + self.steps * self.step_ns

    def __str__(self) -> str:
        """Return the times in words."""
        return f"{self.steps} steps of {self.step_ns / NS:g} s from {self.start_ns / NS:g} s"


def experiment_of(fmu: LoadedFmu) -> Experiment:
    """Return the times of an FMU's default experiment, 1 s where it says none.

    The step is the FMU's fixed internal step (FMI 3.0), else that of the experiment, else a
    hundredth of it, at most 0.1 s. An FMU that takes any step gets the next shorter power of two,
    in seconds, if that is whole nanoseconds: every tool then has the same times to the last bit.
    An experiment of more than 1000 steps is cut there.
    """
    said = fmu.description.defaultExperiment
    start = _number(said, "startTime") or 0.0
    stop = _number(said, "stopTime")
    length = stop - start if stop is not None and stop > start else 1.0
    fixed = _number(fmu.simulation, "fixedInternalStepSize") or 0.0
    step = fixed or _number(said, "stepSize") or 0.0
    most = _MOST_STEPS if step else _STEPS
    if not 0.0 < step <= length:
        step = min(length / _STEPS, _LONGEST_S)
    if fmu.any_step and not fixed and step >= _SHORTEST_S:
        step = 2.0 ** math.floor(math.log2(step))
    step_ns = max(1, round(step * NS))
    return Experiment(round(start * NS), step_ns, min(max(1, round(length * NS / step_ns)), most))


def _number(of: Any, name: str) -> float | None:
    """Return a number of a model description, None for one that is not there or is none."""
    try:
        found = float(getattr(of, name))
    except (AttributeError, TypeError, ValueError):
        return None
    return found if math.isfinite(found) else None
