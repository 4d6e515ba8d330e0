"""Objectives of tuning: a column of each run, and one number of all cases of a candidate."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import quantity
from seatrial.trial.running.measuring import Measured
from seatrial_kits.campaigns.questions import Objective

from .asking import Asking, robustness_of
from .outputs import Output, outputs_of

LOST = 1e12
"""Cost of a candidate of which a case has no number."""
_QUANTILE = re.compile(r"quantile\s+([\d.]+\s*%?)")


@dataclass(frozen=True)
class Goal:
    """An objective that has been read."""

    name: str
    output: Output
    is_greater_better: bool
    share: float | None
    """As good in this share of the cases; None: the mean."""

    def cost(self, runs: Sequence[Measured]) -> float:
        """Return one number for the runs of a candidate, the less the better."""
        values = np.array([self.output(each) for each in runs])
        if not np.isfinite(values).all():
            return LOST
        costs = -values if self.is_greater_better else values
        if self.share is None:
            return float(costs.mean())
        return float(np.quantile(costs, self.share, method="higher"))

    def shown(self, cost: float) -> float | None:
        """Return a cost as the column has it; None of a lost candidate."""
        if cost >= LOST:
            return None
        return -cost if self.is_greater_better else cost


def goals_of(objectives: Sequence[Objective], asking: Asking) -> list[Goal]:
    """Return the objectives of a question; without any, the least robustness of all criteria.

    Raises InputError for a column that a run does not have, and for another ``over``.
    """
    trial = asking.asked.base
    if not objectives:
        least = partial(robustness_of, names=asking.criteria(""))
        return [Goal("least robustness, worst case", least, True, 1.0)]
    known = outputs_of(trial)
    goals = []
    for entry in objectives:
        column = entry.maximise or entry.minimise or ""
        origin = f"{asking.origin}: objectives"
        if column not in known:
            raise InputError(f"{origin}: {unknown('column', column, known)}")
        share = _share(entry.over, origin)
        name = f"{entry.over} {column}"
        goals.append(Goal(name, known[column], entry.maximise is not None, share))
    return goals


def _share(over: str, origin: str) -> float | None:
    if over in ("worst", "mean"):
        return 1.0 if over == "worst" else None
    found = _QUANTILE.fullmatch(over)
    share = quantity(found[1], "1") if found else 0.0
    if not 0.0 < share < 1.0:
        raise InputError(
            f"{origin}: over: 'worst', 'mean' or a quantile such as 'quantile 90 %' is needed, "
            f"found {over!r}"
        )
    return share


def front(costs: np.ndarray) -> list[int]:
    """Return the rows that no other row dominates, by their first column; of equal rows one."""
    order = np.lexsort(costs.T[::-1])
    kept: list[int] = []
    for row in order:
        others = costs[kept]
        if not kept or not (others <= costs[row]).all(axis=1).any():
            kept.append(int(row))
    return kept


def compromise(costs: np.ndarray) -> int:
    """Return the row nearest to the best of each column, distances as shares of the ranges."""
    least, span = costs.min(axis=0), np.ptp(costs, axis=0)
    shares = (costs - least) / np.where(span > 0.0, span, 1.0)
    return int(np.argmin(np.linalg.norm(shares, axis=1)))
