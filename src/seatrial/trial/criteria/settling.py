"""Settling: when an expression enters for good the band about its final value."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...model.readable import distinct, from_si, number, quantity_text
from .expressions import BoolArray, Expression, FloatArray, Signal, Units, unit_of
from .predicates import Limit, Record
from .robustness import HALF_NS
from .verdict import Verdict, no_number, share_text, too_short

DEFAULT_BAND = 0.05


@dataclass(frozen=True)
class Settling:
    """``EXPRESSION settles within 5 s``, ``after`` a time from the start (default: at once), s.

    ``band`` is the share that is regarded as settled.
    """

    subject: Expression
    within: float
    after: float = 0.0
    band: float = DEFAULT_BAND


def evaluate_settling(settling: Settling, record: Record, units: Units) -> Verdict:
    """Evaluate when the subject enters for good the band about its final value.

    The instant lies between rows, where the line through them crosses the edge of the band. The
    robustness is (allowed - took) / allowed.
    """
    time, subject, band = record.time, settling.subject, settling.band
    allowed, begin = settling.within, float(time[0]) + settling.after
    flaw = too_short(time, begin + allowed)
    if flaw:
        return Verdict(False, flaw)
    course = np.asarray(subject.evaluate(record.values), dtype=float)
    course = np.broadcast_to(course, time.shape)
    if not np.isfinite(course).all():
        return Verdict(False, no_number(time, course))
    final = float(course[-1])
    distance = course - final
    width = band * float(np.abs(distance).max())
    settled = max(begin, _last_crossing(time, distance, width, time >= begin - HALF_NS))
    took = settled - begin
    passed = took <= allowed + HALF_NS

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
    robustness = (allowed - took) / allowed if allowed else allowed - took
    share = share_text(robustness) if allowed else quantity_text(robustness, "s")
    return Verdict(passed, detail, took, "s", settled, limits, robustness, share)


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
