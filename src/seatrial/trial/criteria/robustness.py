"""Truth and robustness of a formula on a record that ends: signal temporal logic, point by point.

The margin of a formula at a row is positive where it holds and negative where it does not:

- of ``not``, ``and``, ``or``, ``a implies b``: -a, min, max, max(-a, b);
- of ``always[a, b]`` and ``historically[a, b]``: the least in [t + a, t + b], or [t - b, t - a];
- of ``eventually[a, b]`` and ``once[a, b]``: the greatest there;
- of ``p until[a, b] q``: the greatest over t' in [t + a, t + b] of min(q(t'), least p in [t, t'));
  ``since`` is the same with time reversed;
- of ``finally``: that of the last row.

This is the space robustness of Donzé and Maler (2010, Robust satisfaction of temporal logic over
real-valued signals) on the rows alone. Nothing is interpolated, and nothing was before the first
row: a window of the past is cut there.

What the record does not decide is kept: each formula has a lower and an upper margin at each row
(robust satisfaction intervals: [Deshmukh2017], Robust online monitoring of signal temporal
logic). A window of the future that reaches beyond the last row, and a comparison with what is no
number, are between minus infinity and infinity. A formula holds if its lower margin is positive,
and is broken if its upper one is negative.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from . import sliding
from .expressions import BoolArray, FloatArray
from .formulas import PREDICATES, Formula, Interval, Logic, Temporal, Until, is_timeless
from .predicates import Predicate, Record
from .sliding import Rows

HALF_NS = 0.5e-9
"""Times are whole nanoseconds; less than half of one is rounding."""

_PAST = ("once", "historically", "since")


@dataclass
class Evaluation:
    """Margins of formulas on one record of at least one row."""

    record: Record
    _known: dict[int, tuple[FloatArray, FloatArray]] = field(default_factory=dict)
    _windows: dict[tuple[Interval, bool], tuple[Rows, Rows]] = field(default_factory=dict)

    def margins(self, node: Formula) -> tuple[FloatArray, FloatArray]:
        """Return the lower and the upper margin of a formula at every row."""
        if id(node) not in self._known:
            self._known[id(node)] = self._margins(node)
        return self._known[id(node)]

    def windows(self, interval: Interval, *, past: bool) -> tuple[Rows, Rows]:
        """Return the first row of the window of every row, and the one after its last."""
        if (interval, past) not in self._windows:
            self._windows[interval, past] = self._found(interval, past)
        return self._windows[interval, past]

    def _found(self, interval: Interval, past: bool) -> tuple[Rows, Rows]:
        time, n = self.record.time, len(self.record.time)
        first, last = interval
        if past:
            ends = np.searchsorted(time, time - first + HALF_NS, side="right")
            if last is None:
                return np.zeros(n, dtype=np.intp), ends
            return np.searchsorted(time, time - last - HALF_NS, side="left"), ends
        if first == 0.0 and (np.diff(time) > 2.0 * HALF_NS).all():
            starts = np.arange(n)
        else:
            starts = np.searchsorted(time, time + first - HALF_NS, side="left")
        if last is None:
            return starts, np.full(n, n, dtype=np.intp)
        return starts, np.searchsorted(time, time + last + HALF_NS, side="right")

    def decisive(self, node: Formula, row: int) -> tuple[Predicate, int] | None:
        """Return the predicate, and its row, that decides a formula at a row; None if none does.

        It is the one nearest to its limit, or furthest beyond it. Where a condition had to be met
        at some time and was, it is the first time.
        """
        if isinstance(node, PREDICATES):
            return node, row
        side = 0 if self.margins(node)[0][row] > 0 else 1
        if isinstance(node, Logic):
            return self.decisive(self._deciding_part(node, row, side), row)
        if isinstance(node, Until):
            return self._decisive_until(node, row, side)
        found = self._deciding_row(node, row, side)
        return None if found is None else self.decisive(node.parts[0], found)

    # ------------------------------------------------------------------ margins

    def _margins(self, node: Formula) -> tuple[FloatArray, FloatArray]:
        if isinstance(node, PREDICATES):
            return node.margins(self.record)
        parts = [self.margins(part) for part in node.parts]
        if isinstance(node, Logic):
            return _logic(node, parts)
        if isinstance(node, Until):
            return self._until(node, *parts)
        ((low, high),) = parts
        n = len(low)
        if node.name == "finally":
            return np.full(n, low[-1]), np.full(n, high[-1])
        past = node.name in _PAST
        windows = self.windows(node.interval, past=past)
        extreme = sliding.least if node.name in ("always", "historically") else sliding.greatest
        new_low = extreme(low, *windows)
        new_high = new_low if high is low else extreme(high, *windows)
        cut = self._cut(node.interval, past)
        if not cut.any():
            return new_low, new_high
        if node.name == "always":
            return np.where(cut, -np.inf, new_low), new_high
        return new_low, np.where(cut, np.inf, new_high)

    def _until(
        self,
        node: Until,
        first: tuple[FloatArray, FloatArray],
        second: tuple[FloatArray, FloatArray],
    ) -> tuple[FloatArray, FloatArray]:
        past = node.name == "since"
        starts, ends = self.windows(node.interval, past=past)
        n = len(starts)

        def margin(a: FloatArray, b: FloatArray) -> FloatArray:
            if not past:
                return sliding.until(a, b, starts, ends)
            return sliding.until(a[::-1], b[::-1], n - ends[::-1], n - starts[::-1])[::-1]

        low = margin(first[0], second[0])
        same = first[0] is first[1] and second[0] is second[1]
        high = low if same else margin(first[1], second[1])
        cut = self._cut(node.interval, past)
        if not cut.any():
            return low, high
        still = sliding.least(first[1], np.arange(n), np.full(n, n, dtype=np.intp))
        return low, np.where(cut, np.maximum(high, still), high)

    def _cut(self, interval: Interval, past: bool) -> BoolArray:
        """Return at which rows the window reaches beyond the end of the record."""
        time = self.record.time
        if past:
            return np.zeros(len(time), dtype=bool)
        needed = interval.first if interval.last is None else interval.last
        cut: BoolArray = time + needed > time[-1] + HALF_NS
        return cut

    # ------------------------------------------------------------------ what decides

    def _deciding_part(self, node: Logic, row: int, side: int) -> Formula:
        """Return the part of a formula that decides it."""
        if node.name == "not":
            return node.parts[0]
        # A part that stands negated has its sides exchanged.
        signs = (-1, 1) if node.name == "implies" else (1,) * len(node.parts)
        margins = [
            sign * self.margins(part)[side if sign > 0 else 1 - side][row]
            for part, sign in zip(node.parts, signs, strict=True)
        ]
        chosen = int(np.argmin(margins) if node.name == "and" else np.argmax(margins))
        return node.parts[chosen]

    def _deciding_row(self, node: Temporal, row: int, side: int) -> int | None:
        values = self.margins(node.parts[0])[side]
        if node.name == "finally":
            return len(values) - 1
        starts, ends = self.windows(node.interval, past=node.name in _PAST)
        start, end = int(starts[row]), int(ends[row])
        if start >= end:
            return None
        inside = values[start:end]
        if node.name in ("always", "historically"):
            return start + int(np.argmin(inside))
        if is_timeless(node.parts[0]) and (inside > 0).any():
            return start + int(np.argmax(inside > 0))
        return start + int(np.argmax(inside))

    def _decisive_until(self, node: Until, row: int, side: int) -> tuple[Predicate, int] | None:
        first, second = (self.margins(part)[side] for part in node.parts)
        starts, ends = self.windows(node.interval, past=node.name == "since")
        rows = range(int(starts[row]), int(ends[row]))
        if node.name == "since":
            rows = rows[::-1]
        reached = [j for j in rows if second[j] > 0]
        if not reached:
            best = max(rows, key=lambda j: second[j], default=None)
            return None if best is None else self.decisive(node.parts[1], best)
        between = range(row, reached[0]) if node.name == "until" else range(reached[0] + 1, row + 1)
        worst = min(between, key=lambda j: first[j], default=None)
        if worst is not None and first[worst] < 0:
            return self.decisive(node.parts[0], worst)
        return self.decisive(node.parts[1], reached[0])


def _logic(
    node: Logic, parts: list[tuple[FloatArray, FloatArray]]
) -> tuple[FloatArray, FloatArray]:
    if node.name == "not":
        low, high = parts[0]
        negated = -high
        return negated, negated if low is high else -low
    if node.name == "implies":
        parts = [_logic(Logic("not", node.parts[:1]), parts[:1]), parts[1]]
    join = np.minimum if node.name == "and" else np.maximum
    low = join(parts[0][0], parts[1][0])
    if all(of[0] is of[1] for of in parts):
        return low, low
    return low, join(parts[0][1], parts[1][1])
