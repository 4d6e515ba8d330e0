"""Margins of formulas that look back, step by step, of many copies at once.

They are the lower margins of `seatrial.trial.criteria.robustness` at the last row of the record of
a copy from its start; rows are decisions.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError
from seatrial.trial.criteria.formulas import PREDICATES, Formula, Interval, Logic, Temporal, Until
from seatrial.trial.criteria.predicates import Record

Floats = NDArray[np.float64]
Columns = slice | NDArray[np.bool_]
EVERY = slice(None)


class Margins:
    """The margin of one formula in each of ``count`` copies, with a row every ``period`` s."""

    def __init__(self, formula: Formula, count: int, period: float) -> None:
        self._formula, self._parts = formula, list[Margins]()
        self._window: _Window | None = None
        if isinstance(formula, PREDICATES):
            return
        self._parts = [Margins(part, count, period) for part in formula.parts]
        if not isinstance(formula, Logic):
            greatest = formula.name != "historically"
            self._window = _Window(formula.interval, count, period, greatest=greatest)

    def start(self, chosen: NDArray[np.bool_]) -> None:
        """Forget the rows of copies that start anew."""
        for part in self._parts:
            part.start(chosen)
        if self._window is not None:
            self._window.start(chosen)

    def at(self, now: Record, chosen: Columns = EVERY) -> Floats:
        """Return the margins at a further row of the chosen copies; of others they mean nothing.

        Rows of ``now`` are the copies' values.
        """
        formula = self._formula
        if isinstance(formula, PREDICATES):
            return formula.margins(now)[0]
        parts = [part.at(now, chosen) for part in self._parts]
        if self._window is not None:
            since = parts[0] if isinstance(formula, Until) else None
            return self._window.at(parts[-1], since, chosen)
        name = cast(Logic, formula).name
        if name == "not":
            return -parts[0]
        if name == "implies":
            parts = [-parts[0], parts[1]]
        join: Any = np.minimum if name == "and" else np.maximum
        return np.asarray(join(*parts), dtype=np.float64)


class _Window:
    """The extreme of values from ``interval`` before now, and before each the least of others."""

    def __init__(self, interval: Interval, count: int, period: float, *, greatest: bool) -> None:
        self._first = _rows(interval.first, period)
        last = self._first if interval.last is None else _rows(interval.last, period)
        self._endless = interval.last is None
        self._extreme: Any = np.maximum if greatest else np.minimum
        self._none = -np.inf if greatest else np.inf
        self._past = np.full((last + 1, count), self._none)
        """Values by age."""
        self._before = np.full(count, self._none)
        """Extreme of those that are older."""

    def start(self, chosen: NDArray[np.bool_]) -> None:
        self._past[:, chosen] = self._before[chosen] = self._none

    def at(self, values: Floats, since: Floats | None, chosen: Columns) -> Floats:
        past, before = self._past[:, chosen], self._before[chosen]
        if self._endless:
            before = self._extreme(before, past[-1])
        past[1:] = past[:-1]
        if since is not None:
            np.minimum(past[1:], since[chosen], out=past[1:])
            before = np.minimum(before, since[chosen])
        past[0] = values[chosen]
        self._past[:, chosen], self._before[chosen] = past, before
        found = values.copy()
        found[chosen] = self._extreme(self._extreme.reduce(past[self._first :]), before)
        return found


def _rows(time: float, period: float) -> int:
    rows = round(time / period)
    if abs(rows * period - time) > 1e-9:
        raise InputError(f"{time:g} s is not a whole number of decisions of {period:g} s")
    return rows


def is_of_past(formula: Formula) -> bool:
    """Say if `Margins` has a formula: no function of a whole record is in it, no look ahead."""
    if isinstance(formula, PREDICATES):
        return formula.is_timeless
    if isinstance(formula, (Temporal, Until)) and formula.name not in (
        "once",
        "historically",
        "since",
    ):
        return False
    return all(is_of_past(part) for part in formula.parts)
