"""Numbers that a run comes to, by the names of the columns of its campaign's table."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

from seatrial.trial.files.trial import Trial
from seatrial.trial.running.measuring import Measured

from .asking import robustness_of

_PLACES = ("least", "greatest", "last")
Output = Callable[[Measured], float]


def figures_of(trial: Trial) -> dict[str, Output]:
    """Return the figures of a trial as functions of what a run came to."""
    return {
        f"{which} {signal}": partial(_figure, i, j)
        for i, signal in enumerate(trial.figures)
        for j, which in enumerate(_PLACES)
    }


def outputs_of(trial: Trial) -> dict[str, Output]:
    """Return all columns of numbers; a run that has no number there has NaN."""
    names = [name for name, _ in trial.criteria]
    found = {f"robustness of {name}": partial(robustness_of, names=[name]) for name in names}
    found |= {f"worst of {name}": partial(_worst, name) for name in names}
    return found | figures_of(trial)


def _figure(place: int, which: int, measured: Measured) -> float:
    figures = measured.figures
    return float(figures[place][which]) if place < len(figures) else math.nan


def _worst(name: str, measured: Measured) -> float:
    found = [v["worst"] for v in measured.verdicts if v["name"] == name]
    return float(found[0]) if found and found[0] is not None else math.nan
