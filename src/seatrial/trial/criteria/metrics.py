"""Metrics: what a whole record, or a window of it, comes to; functions of expressions and time.

Between rows an expression is a straight line. A window without a row gives no number.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...model.readable import number
from .expressions import (
    Exponents,
    Expression,
    FloatArray,
    Literal,
    Operation,
    Rule,
    Units,
    Value,
    Values,
    check_same,
    combined,
    same_kind,
)

TIME = ""
"""Key of the time, s, among the values that an expression is evaluated on: no signal has it."""
_HALF_NS = 0.5e-9
_SECOND: Exponents = {"s": 1}


@dataclass(frozen=True)
class Metric(Operation):
    """A function of the rows from ``first`` to ``last``, s from the start; None: the end."""

    first: float = 0.0
    last: float | None = None

    @property
    def is_series(self) -> bool:
        """Whether it has a value of its own at every row."""
        return self.name in SERIES

    @property
    def when(self) -> str:
        """The window as it is written; nothing of the whole record."""
        if self.last is not None:
            return f" from {number(self.first, 9)} s to {number(self.last, 9)} s"
        return f" after {number(self.first, 9)} s" if self.first else ""

    def exponents(self, units: Units) -> Exponents:
        """Return the exponents of the base units. Raises InputError as `Operation` does."""
        rule = ALL[self.name].rule
        return rule(self, [a.exponents(units) for a in self.arguments], units)

    def evaluate(self, values: Values) -> Value:
        """Return the SI value of the window, or of every row of a series."""
        time = values[TIME]
        given = [
            np.broadcast_to(np.asarray(a.evaluate(values), float), time.shape)
            for a in self.arguments
        ]
        if self.is_series:
            return np.asarray(SERIES[self.name].function(time, *given))
        last = math.inf if self.last is None else self.last
        since = time - time[0] if len(time) else time
        rows = (since >= self.first - _HALF_NS) & (since <= last + _HALF_NS)
        # A window that the record does not reach the end of is not decided.
        if not rows.any() or (self.last is not None and since[-1] < self.last - _HALF_NS):
            return math.nan
        return float(METRICS[self.name].function(time[rows], *(each[rows] for each in given)))


def is_of_record(node: Expression) -> bool:
    """Return whether an expression needs more than one row."""
    if isinstance(node, Metric):
        return True
    return isinstance(node, Operation) and any(map(is_of_record, node.arguments))


def is_constant(node: Expression) -> bool:
    """Return whether an expression has one value for the whole record."""
    if isinstance(node, Metric):
        return not node.is_series
    return isinstance(node, Literal) or (
        isinstance(node, Operation) and all(map(is_constant, node.arguments))
    )


def integral(time: FloatArray, x: FloatArray) -> float:
    """Return the integral of x over time, by trapezia."""
    return float(np.trapezoid(x, time))


def mean(time: FloatArray, x: FloatArray) -> float:
    """Return the mean over time: the integral over the length; of one row its value."""
    return integral(time, x) / float(time[-1] - time[0]) if len(time) > 1 else float(x[0])


def rms(time: FloatArray, x: FloatArray) -> float:
    """Return the root of the mean of the square, of the line between rows."""
    if len(time) == 1:
        return abs(float(x[0]))
    # The square of a line from a to b has the mean (a^2 + a b + b^2) / 3.
    a, b = x[:-1], x[1:]
    return math.sqrt(
        float(np.sum((a * a + a * b + b * b) / 3.0 * np.diff(time))) / (time[-1] - time[0])
    )


def deviation(time: FloatArray, x: FloatArray) -> float:
    """Return the standard deviation over time."""
    return rms(time, x - mean(time, x))


def percentile(time: FloatArray, x: FloatArray, share: FloatArray) -> float:
    """Return the value that x is below for that share of the rows, linear between them."""
    return float(np.quantile(x, share[0]))


def time_above(time: FloatArray, x: FloatArray, level: FloatArray) -> float:
    """Return how long x is above a level, s; instants of crossing by the line between rows."""
    d = x - level
    a, b = d[:-1], d[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = np.maximum(a, b) / (np.abs(a) + np.abs(b))
    share = np.where((a > 0) & (b > 0), 1.0, np.where((a > 0) | (b > 0), crossing, 0.0))
    return float(np.sum(share * np.diff(time)))


def time_below(time: FloatArray, x: FloatArray, level: FloatArray) -> float:
    """Return how long x is below a level, s."""
    return time_above(time, -x, -level)


def crossings(time: FloatArray, x: FloatArray, level: FloatArray) -> float:
    """Return how often x goes through a level, up and down."""
    side = np.sign(x - level)
    side = side[side != 0]
    return float(np.count_nonzero(np.diff(side)))


def overshoot(time: FloatArray, x: FloatArray, target: FloatArray) -> float:
    """Return how far x goes beyond a target, as a share of the way from its first value there."""
    way = float(target[-1] - x[0])
    beyond = float(np.max((x - target) * np.sign(way)))
    return max(beyond, 0.0) / abs(way) if way else math.nan


def rise_time(time: FloatArray, x: FloatArray, target: FloatArray) -> float:
    """Return the time from 10 to 90 % of the way from the first value to a target, s."""
    way = float(target[-1] - x[0])
    share = (x - x[0]) / way if way else np.full_like(x, math.nan)
    return _first_at(time, share, 0.9) - _first_at(time, share, 0.1)


def settling_time(time: FloatArray, x: FloatArray, target: FloatArray, band: FloatArray) -> float:
    """Return the time from which on x is within a band about a target, s; inf: never."""
    outside = np.abs(x - target) - band
    late = np.flatnonzero(outside > 0)
    if not len(late):
        return 0.0
    row = int(late[-1])
    if row == len(time) - 1:
        return math.inf
    share = outside[row] / (outside[row] - outside[row + 1])
    return float(time[row] + share * (time[row + 1] - time[row]) - time[0])


def _first_at(time: FloatArray, x: FloatArray, level: float) -> float:
    """Return when x first reaches a level from below, by the line between rows; inf: never."""
    reached = np.flatnonzero(x >= level)
    if not len(reached):
        return math.inf
    row = int(reached[0])
    if row == 0:
        return float(time[0])
    share = (level - x[row - 1]) / (x[row] - x[row - 1])
    return float(time[row - 1] + share * (time[row] - time[row - 1]))


def derivative(time: FloatArray, x: FloatArray) -> FloatArray:
    """Return the rate of change by central differences, of one row no number."""
    if len(time) < 2:
        return np.full_like(x, math.nan)
    return np.asarray(np.gradient(x, time))


# ---------------------------------------------------------------------- units


def _by_time(sign: int) -> Callable[[Operation, list[Exponents], Units], Exponents]:
    def rule(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
        return combined(exponents[0], _SECOND, sign)

    return rule


def _of_level(found: Exponents) -> Callable[[Operation, list[Exponents], Units], Exponents]:
    def rule(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
        same_kind(node, exponents, units)
        return found

    return rule


def _of_share(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    share = node.arguments[1]
    if not isinstance(share, Literal) or exponents[1] or not 0.0 <= share.value <= 1.0:
        raise InputError(f"{node.name} needs a share from 0 to 100 % as its second value")
    return exponents[0]


def _of_band(node: Operation, exponents: list[Exponents], units: Units) -> Exponents:
    for argument, own in zip(node.arguments[1:], exponents[1:], strict=True):
        check_same(f"{node.name!r}", (node.arguments[0], exponents[0]), (argument, own), units)
    return _SECOND


METRICS: dict[str, Rule] = {
    "crossings": Rule(crossings, _of_level({}), 2),
    "integral": Rule(integral, _by_time(1), 1),
    "mean": Rule(mean, same_kind, 1),
    "overshoot": Rule(overshoot, _of_level({}), 2),
    "percentile": Rule(percentile, _of_share, 2),
    "rise_time": Rule(rise_time, _of_level(_SECOND), 2),
    "rms": Rule(rms, same_kind, 1),
    "settling_time": Rule(settling_time, _of_band, 3),
    "std": Rule(deviation, same_kind, 1),
    "time_above": Rule(time_above, _of_level(_SECOND), 2),
    "time_below": Rule(time_below, _of_level(_SECOND), 2),
}
"""Functions of time (n,), s, and of values (n,) that return one number."""
SERIES: dict[str, Rule] = {"derivative": Rule(derivative, _by_time(-1), 1)}
"""Functions of the same that return a number for every row."""
ALL: dict[str, Rule] = {**METRICS, **SERIES}


def metric(name: str, arguments: tuple[Expression, ...], window: Any) -> Metric:
    """Return a metric over a window, None: the whole record. Raises InputError for a series."""
    if window is None:
        return Metric(name, arguments)
    if name in SERIES:
        raise InputError(f"{name} has a value at every point: it takes no 'after' and no 'from'")
    return Metric(name, arguments, window.first, window.last)
