"""Verdicts: a record held against a condition, or evaluated for when it settles."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .expressions import (
    BoolArray,
    Comparison,
    Condition,
    Expression,
    FloatArray,
    Limit,
    Signal,
    Units,
    Values,
    unit_of,
)
from .readable import distinct, from_si, number, quantity_text

_HALF_NS = 0.5e-9
"""Times are whole nanoseconds; less than half of one is rounding."""

ConditionForm = Literal["always", "finally", "within"]


@dataclass(frozen=True)
class Span:
    """The part of a record that counts: from ``start`` (default: the first row) to ``end``.

    ``within`` is the time allowed from its start. All in s.
    """

    start: float | None = None
    end: float | None = None
    within: float | None = None

    def begin(self, time: FloatArray) -> float:
        """Return the time from which the span counts."""
        return float(time[0]) if self.start is None else self.start

    def rows(self, time: FloatArray) -> BoolArray:
        """Return which rows lie in the span."""
        rows: BoolArray = time >= self.begin(time) - _HALF_NS
        for last in (self.end, self.deadline(time)):
            if last is not None:
                rows &= time <= last + _HALF_NS
        return rows

    def deadline(self, time: FloatArray) -> float | None:
        """Return the time until which something may take."""
        return None if self.within is None else self.begin(time) + self.within


WHOLE = Span()
"""The whole record."""


@dataclass(frozen=True)
class Verdict:
    """What became of a criterion in a run."""

    passed: bool
    detail: str
    """For a person: the worst value, when, and what was allowed; or why there is none."""
    worst: float | None = None
    """The value nearest to the limit or furthest beyond it; the settling time of ``settles``."""
    unit: str = "1"
    """Unit of ``worst``."""
    time: float | None = None
    """When that was, s."""
    limits: tuple[Limit, ...] = ()
    """Bounds on single signals, for plots."""


def evaluate_condition(
    form: ConditionForm,
    condition: Condition,
    span: Span,
    time: FloatArray,
    values: Values,
    units: Units,
) -> Verdict:
    """Judge a condition that must hold always, finally or within a time."""
    flaw = _flaw(time, values) or (form == "always" and _too_short(time, span.end))
    if flaw:
        return Verdict(False, flaw)
    rows = span.rows(time)
    if form == "finally":
        rows = np.arange(len(time)) == len(time) - 1
    if not rows.any():
        return Verdict(False, f"no row to judge: the record runs {_range(time)}")
    inside = {name: column[rows] for name, column in values.items()}
    time = time[rows]
    flaw = _undefined(condition, time, inside)
    if flaw:
        return Verdict(False, flaw)
    holds = np.broadcast_to(condition.holds(inside), time.shape)
    margin = np.broadcast_to(condition.margin(inside), time.shape)
    passed = bool(holds.any() if form == "within" else holds.all())
    row = _telling_row(form, holds, margin)
    at_row = {name: column[row : row + 1] for name, column in inside.items()}
    measured, bound, unit = _sides(condition.decisive(at_row), at_row, units)
    detail = _detail(form, span, time, holds, row, distinct(measured, bound, unit))
    return Verdict(passed, detail, measured, unit, float(time[row]))


def evaluate_settling(
    subject: Expression,
    band: float,
    span: Span,
    time: FloatArray,
    values: Values,
    units: Units,
) -> Verdict:
    """Judge when ``subject`` enters for good the band about its final value.

    The instant lies between rows, where the line through them crosses the edge of the band.
    """
    flaw = _flaw(time, values) or _too_short(time, span.deadline(time))
    if flaw:
        return Verdict(False, flaw)
    course = np.broadcast_to(np.asarray(subject.evaluate(values), dtype=float), time.shape)
    if not np.isfinite(course).all():
        return Verdict(False, _no_number(time, course))
    allowed, begin = span.within or 0.0, span.begin(time)
    final = float(course[-1])
    distance = course - final
    width = band * float(np.abs(distance).max())
    settled = max(begin, _last_crossing(time, distance, width, time >= begin - _HALF_NS))
    took = settled - begin
    passed = took <= allowed + _HALF_NS

    exponents = subject.exponents(units)
    unit = unit_of(subject, units, exponents)
    shown_width = from_si(width, unit) - from_si(0.0, unit)
    final_text = quantity_text(_rounded(from_si(final, unit), shown_width), unit)
    width_text = quantity_text(shown_width, unit, 3)
    took_text, allowed_text = distinct(took, allowed, "s")
    detail = (
        f"settles in {took_text} (at {number(settled)} s), limit {allowed_text}; "
        f"final value {final_text}, band ±{width_text}"
    )
    limits: tuple[Limit, ...] = ()
    if isinstance(subject, Signal):
        limits = tuple(Limit(subject.name, final + side * width, "band") for side in (1, -1))
    return Verdict(passed, detail, took, "s", settled, limits)


# ---------------------------------------------------------------------- what a record lacks


def _flaw(time: FloatArray, values: Values) -> str:
    """Return why a record cannot be evaluated, or nothing."""
    if not len(time):
        return "the record is empty"
    for name, column in sorted(values.items()):
        if not np.isfinite(column).all():
            row = int(np.argmin(np.isfinite(column)))
            return f"{name} is {column[row]} at {number(time[row], 9)} s"
    return ""


def _too_short(time: FloatArray, needed: float | None) -> str:
    if needed is None or time[-1] >= needed - _HALF_NS:
        return ""
    return f"the record ends at {number(time[-1], 9)} s, before {number(needed, 9)} s"


def _undefined(condition: Condition, time: FloatArray, values: Values) -> str:
    for comparison in condition.comparisons():
        for side in (comparison.left, comparison.right):
            course = np.broadcast_to(np.asarray(side.evaluate(values), dtype=float), time.shape)
            if not np.isfinite(course).all():
                return _no_number(time, course)
    return ""


def _no_number(time: FloatArray, course: FloatArray) -> str:
    row = int(np.argmin(np.isfinite(course)))
    return f"the expression is {course[row]} at {number(time[row], 9)} s"


# ---------------------------------------------------------------------- what tells the story


def _telling_row(form: ConditionForm, holds: BoolArray, margin: FloatArray) -> int:
    """Return the row to report: the worst one, or for 'within' the first one that holds."""
    if form == "within":
        return int(np.argmax(holds)) if holds.any() else int(np.argmax(margin))
    if holds.all():
        return int(np.argmin(margin))
    return int(np.argmin(np.where(holds, np.inf, margin)))


def _sides(comparison: Comparison, values: Values, units: Units) -> tuple[float, float, str]:
    """Return the measured and the bounding value of a single row, and their unit."""
    unit = comparison.unit(units)
    measured, bound = (
        from_si(float(np.max(side.evaluate(values))), unit)
        for side in (comparison.measured, comparison.bound)
    )
    return measured, bound, unit


def _detail(
    form: ConditionForm,
    span: Span,
    time: FloatArray,
    holds: BoolArray,
    row: int,
    texts: tuple[str, str],
) -> str:
    measured, bound = texts
    at = f"{measured} at {number(time[row], 9)} s"
    if form == "finally":
        return f"ends with {at}, limit {bound}"
    if form == "within":
        allowed = f"allowed until {number(span.deadline(time) or 0.0, 9)} s"
        if holds.any():
            return f"reaches {at}, limit {bound}, {allowed}"
        return f"never in time: closest {at}, limit {bound}, {allowed}"
    if holds.all():
        return f"worst {at}, limit {bound}"
    return f"worst {at}, limit {bound}, first broken at {number(time[np.argmin(holds)], 9)} s"


def _last_crossing(time: FloatArray, distance: FloatArray, width: float, rows: BoolArray) -> float:
    """Return when ``distance`` is last outside ±``width`` in ``rows``, or minus infinity."""
    outside = np.flatnonzero((np.abs(distance) > width) & rows)
    if not len(outside):
        return -np.inf
    row = int(outside[-1])
    # The last row is never outside: its distance is zero.
    edge = np.copysign(width, distance[row])
    share = (distance[row] - edge) / (distance[row] - distance[row + 1])
    return float(time[row] + share * (time[row + 1] - time[row]))


def _rounded(value: float, width: float) -> float:
    """Return ``value`` without digits that are small against ``width``."""
    return round(value, 2 - math.floor(math.log10(width))) if width > 0 else value


def _range(time: FloatArray) -> str:
    return f"from {number(time[0], 9)} s to {number(time[-1], 9)} s"
