"""Errors of a coupling estimated by step halving: Richardson's extrapolation, output by output.

Let y_0, y_1, y_2, ... be an output of the same trial at communication steps h, h/2, h/4, ..., and
d_i = max |y_i - y_(i+1)| over the recorded times. If the error is of order p in the step, the
differences shrink by 2^p: p = log2(d_i / d_(i+1)), and the error of run i is
d_i 2^p / (2^p - 1). The last two differences, those of the smallest steps, give the p used.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from ...system.paths import split_axis, split_path
from ..criteria.expressions import FloatArray

ROUND_OFF = 1e-11
"""Differences are round-off below this share of the greatest value in the same unit."""
LEAST_ORDER = 0.5
"""Below it the differences hardly shrink: half of what the simplest coupling reaches."""

Behaviour = Literal["converges", "exact", "not converging"]


@dataclass(frozen=True)
class Accuracy:
    """How an output depends on the communication step; all values in its unit."""

    signal: str
    unit: str
    behaviour: Behaviour
    range: float
    """Greatest less least value at the smallest step."""
    differences: list[float]
    """Between the runs at each step and at half of it, coarsest first."""
    orders: list[float]
    """Of each two consecutive differences; empty if exact."""
    errors: list[float]
    """Estimated, of the run at each step, coarsest first; empty unless it converges."""

    @property
    def relative(self) -> float:
        """What ranks outputs: error, or difference, of the coarsest run as a share of the range."""
        if self.behaviour == "exact":
            return 0.0
        size = (self.errors or self.differences)[0]
        return size / self.range if self.range else math.inf


def accuracy(signal: str, unit: str, runs: Sequence[FloatArray], size: float) -> Accuracy:
    """Return how an output behaves, from its values at ever smaller steps at the same times.

    ``size`` is the greatest absolute value of any recorded signal in its unit. Needs at least
    three runs.
    """
    floor = ROUND_OFF * size
    differences = [float(np.max(np.abs(a - b))) for a, b in pairwise(runs)]
    span = float(np.ptp(runs[-1]))
    if max(differences) <= floor:
        return Accuracy(signal, unit, "exact", span, differences, [], [])
    # A difference that has sunk into the round-off gives a lower bound of the order.
    raised = [max(d, floor) for d in differences]
    orders = [math.log2(a / b) for a, b in pairwise(raised)]
    if orders[-1] < LEAST_ORDER or min(orders) <= 0:
        return Accuracy(signal, unit, "not converging", span, differences, orders, [])
    shrinking = 2.0 ** orders[-1]
    errors = [d * shrinking / (shrinking - 1.0) for d in differences]
    errors.append(differences[-1] / (shrinking - 1.0))
    return Accuracy(signal, unit, "converges", span, differences, orders, errors)


def order_text(order: float) -> str:
    """Return an order for a person: above 10, it is a bound where differences end in round-off."""
    return f"{order:.2f}" if order < 10 else "> 10"


def spread_text(orders: Sequence[float]) -> str:
    """Return the least and greatest of several orders; empty if there is only one."""
    return f"{order_text(min(orders))} to {order_text(max(orders))}" if len(orders) > 1 else ""


def ranked(outputs: Sequence[Accuracy]) -> list[Accuracy]:
    """Return the outputs worst first: those that do not converge, then by relative error."""
    return sorted(
        outputs, key=lambda o: (o.behaviour == "not converging", o.relative), reverse=True
    )


def by_port(outputs: Sequence[Accuracy], components: Sequence[str]) -> list[Accuracy]:
    """Return the worst scalar of each port, the worst port first; ``components`` by path."""
    worst: dict[tuple[str, str], Accuracy] = {}
    for output in ranked(outputs):
        component, port = split_path(components, output.signal)
        worst.setdefault((component, split_axis(port)[0]), output)
    return list(worst.values())
