"""Verdicts: what became of a formula on a record, for a person and for programs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...model.readable import from_si, number, quantity_text
from . import formulas
from .expressions import FloatArray, Units
from .formulas import PREDICATES, Formula, Temporal
from .predicates import TINY, Comparison, Limit, Predicate, Record, Telling
from .robustness import HALF_NS, Evaluation

Expectation = Literal["pass", "fail"]


@dataclass(frozen=True)
class Verdict:
    """Result of a criterion in a run."""

    passed: bool
    """Whether it holds."""
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
    robustness: float | None = None
    """Distance from the other verdict, see `robustness`; None if there is none."""
    margin: str = ""
    """The same for a person: ``44 %`` of a limit, ``0.3 m``; nothing if there is none."""
    expected: Expectation = "pass"
    why: str = ""
    """Why it is expected to fail."""

    @property
    def as_expected(self) -> bool:
        """Whether it is what the trial says it will be."""
        return self.passed == (self.expected == "pass")


def evaluate_formula(node: Formula, record: Record, units: Units) -> Verdict:
    """Evaluate a formula at the start of a record of at least one row."""
    evaluation = Evaluation(record)
    low, high = (float(margin[0]) for margin in evaluation.margins(node))
    if low < 0 < high:
        return Verdict(False, _undecided(node, evaluation))
    passed = low > 0
    robustness = low if passed else high
    finite = math.isfinite(robustness)
    robustness = 0.0 if abs(robustness) <= TINY else robustness
    found = evaluation.decisive(node, 0)
    if found is None:  # the window of a part is empty: no value decides
        return Verdict(passed, "holds" if passed else "does not hold")
    predicate, row = found
    telling = predicate.telling(record, row, units)
    time = None if predicate.is_constant else float(record.time[row])
    if time is None:
        detail = f"{telling.text}, limit {telling.limit}"
    else:
        detail = _detail(node, evaluation, passed, telling, time)
    return Verdict(
        passed,
        detail,
        telling.value,
        telling.unit,
        time,
        robustness=robustness if finite else None,
        margin=_margin_text(predicate, robustness, telling.unit) if finite else "",
    )


def share_text(share: float) -> str:
    """Return a share of a limit as a person reads it."""
    return quantity_text(100.0 * share, "%", 3)


# ---------------------------------------------------------------------- what a record lacks


def flaw(record: Record) -> str:
    """Return why a record cannot be evaluated, or nothing."""
    if not len(record.time):
        return "the record is empty"
    for name, column in sorted(record.numbers.items()):
        if not np.isfinite(column).all():
            row = int(np.argmin(np.isfinite(column)))
            return f"{name} is {column[row]} at {number(record.time[row], 9)} s"
    return ""


def too_short(time: FloatArray, needed: float) -> str:
    """Return that a record ends before it should, or nothing."""
    if time[-1] >= needed - HALF_NS:
        return ""
    return f"the record ends at {number(time[-1], 9)} s, before {number(needed, 9)} s"


def no_number(time: FloatArray, course: FloatArray) -> str:
    """Return where an expression is no finite number."""
    row = int(np.argmin(np.isfinite(course)))
    return f"the expression is {course[row]} at {number(time[row], 9)} s"


def _undecided(node: Formula, evaluation: Evaluation) -> str:
    """Return why a record does not decide a formula."""
    record = evaluation.record
    short = too_short(record.time, float(record.time[0]) + formulas.horizon(node))
    if short:
        return short
    start = 0
    if isinstance(node, Temporal) and node.name != "finally":
        start = int(evaluation.windows(node.interval, past=False)[0][0])
    for predicate in formulas.predicates(node):
        course = predicate.undefined(record)
        if course is not None and not np.isfinite(course[start:]).all():
            return no_number(record.time[start:], course[start:])
    return f"the record ends at {number(record.time[-1], 9)} s, too early to decide"


# ---------------------------------------------------------------------- what is reported


def _margin_text(predicate: Predicate, robustness: float, unit: str) -> str:
    if isinstance(predicate, Comparison) and predicate.scale is None:
        return quantity_text(from_si(robustness, unit) - from_si(0.0, unit), unit, 3)
    return share_text(robustness)


def _detail(
    node: Formula, evaluation: Evaluation, passed: bool, telling: Telling, time: float
) -> str:
    limit = f", limit {telling.limit}" if telling.limit else ""
    at = f"{telling.text} at {number(time, 9)} s{limit}"
    name = "" if isinstance(node, PREDICATES) else node.name
    if isinstance(node, Temporal):
        if name == "finally":
            return f"ends with {at}"
        if name == "always":
            return _detail_of_always(node, evaluation, passed, bool(limit), at)
        if formulas.is_timeless(node.parts[0]):
            return _detail_of_eventually(node, evaluation.record, passed, at)
    return f"holds: {at}" if passed else f"does not hold: {at}"


def _detail_of_always(
    node: Temporal, evaluation: Evaluation, passed: bool, has_limit: bool, at: str
) -> str:
    if passed:
        return f"worst {at}" if has_limit else "holds at every point"
    start = int(evaluation.windows(node.interval, past=False)[0][0])
    broken = evaluation.margins(node.parts[0])[1][start:] < 0
    first = number(evaluation.record.time[start + int(np.argmax(broken))], 9)
    if not formulas.is_timeless(node.parts[0]):
        return f"first broken at {first} s: {at}"
    return f"worst {at}, first broken at {first} s" if has_limit else at


def _detail_of_eventually(node: Temporal, record: Record, passed: bool, at: str) -> str:
    last = node.interval.last
    allowed = ""
    if last is not None:
        allowed = f", allowed until {number(float(record.time[0]) + last, 9)} s"
    if passed:
        return f"reaches {at}{allowed}"
    return f"never in time: closest {at}{allowed}" if allowed else f"never: closest {at}"
