"""Differences between two campaigns on the same cases: statistics of pairs.

- Mean difference: Student's t of the differences.
- Difference of two rates: Newcombe's square-and-add interval (R. G. Newcombe, *Improved confidence
  intervals for the difference between binomial proportions based on paired data*, Statistics in
  Medicine 17, 1998, method 10), which keeps its confidence for few pairs too.
- Change of verdicts: McNemar's test (1947), exact: of the pairs whose verdicts differ, either
  direction is as likely if the rates are the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..stopping_rule import failure_interval

CONFIDENCE = 0.95
"""Of the intervals of a comparison, each by itself."""


def mean_difference(
    a: Sequence[float], b: Sequence[float], confidence: float = CONFIDENCE
) -> tuple[float, float, float]:
    """Return the mean of b - a and its two-sided interval; infinite of a single pair."""
    from scipy.stats import t  # half a second, of every command if it stood above

    gaps = np.asarray(b, float) - np.asarray(a, float)
    mean = float(gaps.mean())
    if len(gaps) < 2:
        return mean, -math.inf, math.inf
    half = float(t.ppf(0.5 + confidence / 2.0, len(gaps) - 1)) * float(gaps.std(ddof=1))
    half /= math.sqrt(len(gaps))
    return mean, mean - half, mean + half


def rate_difference(
    both: int, only_a: int, only_b: int, neither: int, confidence: float = CONFIDENCE
) -> tuple[float, float, float]:
    """Return the rate of b less that of a and its two-sided interval, of counts of pairs.

    ``both`` pairs pass in a and in b, ``only_a`` in a alone. Wilson's intervals of the two rates
    are added as squares, less the correlation phi of the verdicts, whose numerator has a
    correction of half the count where it is positive.
    """
    count = both + only_a + only_b + neither
    in_a, in_b = both + only_a, both + only_b
    rate_a, rate_b = in_a / count, in_b / count
    low_a, high_a = failure_interval(in_a, count, confidence)
    low_b, high_b = failure_interval(in_b, count, confidence)
    product = math.prod((in_a, count - in_a, in_b, count - in_b))
    excess = float(both * neither - only_a * only_b)
    if excess > 0.0:
        excess = max(excess - count / 2.0, 0.0)
    phi = excess / math.sqrt(product) if product else 0.0

    def distance(of_b: float, of_a: float) -> float:
        return math.sqrt(max(of_b**2 - 2.0 * phi * of_b * of_a + of_a**2, 0.0))

    gap = rate_b - rate_a
    below = distance(rate_b - low_b, high_a - rate_a)
    above = distance(high_b - rate_b, rate_a - low_a)
    return gap, gap - below, gap + above


def mcnemar(only_a: int, only_b: int) -> float:
    """Return the two-sided probability of verdicts that change as unevenly, if rates are equal."""
    from scipy.stats import binomtest

    changed = only_a + only_b
    return float(binomtest(only_b, changed, 0.5).pvalue) if changed else 1.0
