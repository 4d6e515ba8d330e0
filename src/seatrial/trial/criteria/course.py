"""The course of what decides a criterion: both sides of its comparison over the record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.readable import from_si
from .criteria import Criterion
from .expressions import FloatArray, Units, unit_of, written
from .predicates import Comparison
from .robustness import Evaluation
from .settling import Settling
from .verdict import flaw


@dataclass(frozen=True)
class Course:
    """A measured value and its bound at each row, in the unit of the criterion."""

    name: str
    unit: str
    time: FloatArray
    values: FloatArray
    bound: FloatArray
    row: int
    """The one that decides."""
    first: int
    """The first that is beyond the bound, if there is one before that; else that."""


def course(
    criterion: Criterion, time: FloatArray, signals: Mapping[str, Any], units: Units
) -> Course | None:
    """Return the course of the comparison that decides a criterion; None if none does."""
    record = criterion.record(np.asarray(time, dtype=float), signals, units)
    if isinstance(criterion.says, Settling) or flaw(record):
        return None
    with np.errstate(all="ignore"):
        found = Evaluation(record).decisive(criterion.says, 0)
        if found is None:
            return None
        comparison, row = found
        if not isinstance(comparison, Comparison):
            return None
        unit = unit_of(comparison, units, comparison.left.exponents(units))
        measured, bound = (
            np.broadcast_to(np.asarray(side.evaluate(record.values), dtype=float), time.shape)
            for side in (comparison.measured, comparison.bound)
        )
        beyond = comparison.margins(record)[1][: row + 1] < 0
    zero, scale = from_si(0.0, unit), from_si(1.0, unit) - from_si(0.0, unit)
    return Course(
        written(comparison.measured),
        unit,
        record.time,
        measured * scale + zero,
        bound * scale + zero,
        row,
        int(np.argmax(beyond)) if beyond.any() else row,
    )
