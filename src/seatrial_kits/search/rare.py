"""The question of rare events: how likely is it that a criterion fails?"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from seatrial.errors import InputError
from seatrial_kits.campaigns.questions import RareQuestion
from seatrial_kits.campaigns.results.finding import Finding, Shown

from .asking import Asking, Values
from .drawing import drawn
from .searching import needed
from .subset import CHAINS, Rare, subset_simulation


def rare_question(entry: RareQuestion, asking: Asking) -> Callable[[], Finding]:
    """Return what finds the probability that a criterion fails, under the distributions.

    Raises InputError for a criterion that does not exist, and a level that cannot be divided.
    """
    needed("matplotlib")
    if entry.per_level % CHAINS:
        raise InputError(
            f"{asking.origin}: per_level: a multiple of {CHAINS} is needed, found {entry.per_level}"
        )
    return partial(_answer, entry, asking, asking.robustness(entry.criterion))


def _answer(entry: RareQuestion, asking: Asking, robustness: Values) -> Finding:
    from scipy.special import ndtr  # dear to import, and no other command needs it

    space = asking.space
    asking.expect(entry.per_level)

    def value(scores: np.ndarray) -> np.ndarray:
        asking.expect(len(asking.asked) + len(scores))
        return robustness(space.quantiles(ndtr(scores @ space.lower.T)))

    rare = subset_simulation(value, len(space.keys), entry.per_level, entry.least, asking.seed)
    finding = asking.finding()
    low, high = rare.interval
    if rare.is_reached:
        finding.lines.append(
            f"probability of failure {rare.probability:.3g}, between {low:.3g} and {high:.3g} "
            f"(95 %), coefficient of variation {rare.variation:.2f}"
        )
    else:
        finding.lines.append(
            f"failing is rarer than {rare.probability:.3g}: `least` ended the search at a "
            f"robustness of {rare.thresholds[-1]:.4g}"
        )
    finding.values = {
        "reached": rare.is_reached,
        "probability": rare.probability,
        "low": low if rare.is_reached else 0.0,
        "high": high,
        "variation": rare.variation,
        "thresholds": rare.thresholds,
        "probabilities": rare.probabilities,
    }
    pairs = zip(rare.thresholds, rare.probabilities, strict=True)
    rows = [[level, threshold, p] for level, (threshold, p) in enumerate(pairs, 1)]
    finding.tables.append(Shown("Levels", ["level", "robustness below", "probability"], rows))
    _draw(rare, asking)
    finding.figures.append("rare.svg")
    return finding


def _draw(rare: Rare, asking: Asking) -> None:
    with drawn(asking.folder, "rare") as [axes]:
        axes.semilogy(rare.thresholds, rare.probabilities, "o-", color="#0b6ea8", markersize=4)
        if rare.is_reached and math.isfinite(rare.variation):
            (low, high), last = rare.interval, rare.thresholds[-1]
            axes.vlines(last, low, high, color="#d1690e", linewidth=2)
        axes.axvline(0.0, color="#8a94a0", linewidth=0.8)
        axes.invert_xaxis()
        axes.grid(visible=True, color="#e6eaee")
        axes.set_xlabel("robustness below")
        axes.set_ylabel("probability")
