"""Differences of two runs of an FMU, relative to the outputs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...model.component import NS
from .experiment import Experiment
from .ways import Rows

SOLVERS = 1e-8
"""Relative tolerance of both solvers in model exchange, where each tool has one of its own."""
LIMITS = {"co-simulation": 1e-9, "model exchange": 1e3 * SOLVERS}
"""Greatest difference of two runs that agree."""
_SMALLEST = 1e-12
"""Least scale of an output: differences of outputs that are all but zero are round-off."""


@dataclass(frozen=True)
class Difference:
    """The greatest difference of two runs, relative to the greatest value of its output."""

    value: float
    output: str
    time: float
    """s, of the first communication point beyond the limit, else of the greatest difference."""

    def __str__(self) -> str:
        """Return the difference in words."""
        return f"{self.output} by {self.value:.3g} at t = {self.time:g} s"


def difference(ours: Rows, theirs: Rows, experiment: Experiment, limit: float) -> Difference:
    """Return the greatest difference of all outputs, of which there is one at least.

    Both end where the FMU asks for that, one of them perhaps a point later: the common points are
    compared. Of runs whose ends lie further apart the difference is infinite.
    """
    return max(
        (
            _of_output(name, ours[name], values, experiment, limit)
            for name, values in theirs.items()
        ),
        key=lambda one: one.value,
    )


def _of_output(
    name: str, found: Sequence[Any], values: Sequence[Any], experiment: Experiment, limit: float
) -> Difference:
    scale = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    apart = [_apart(a, b) / max(scale, _SMALLEST) for a, b in zip(found, values, strict=False)]
    if abs(len(found) - len(values)) > 1:
        apart.append(math.inf)
    worst = max(apart)
    at = next((i for i, value in enumerate(apart) if value > limit), apart.index(worst))
    return Difference(worst, name, (experiment.start_ns + at * experiment.step_ns) / NS)


def _apart(a: Any, b: Any) -> float:
    if a == b or (math.isnan(a) and math.isnan(b)):
        return 0.0
    apart = abs(float(a) - float(b))
    return math.inf if math.isnan(apart) else apart
