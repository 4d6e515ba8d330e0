"""Probabilities of rare failures by subset simulation, in standard normal space."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seatrial.errors import SimulationError

CHAINS = 10
"""One run in so many of a level is below its threshold, and begins a chain of so many."""
_ACCEPTED = 0.44
"""Share of accepted steps that the width of the steps is adapted to."""
_WITHIN = 1.959963984540054
"""Standard deviations of the mean that 95 % of a normal distribution lie within."""
_Value = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Rare:
    """A probability, with the levels on the way to it."""

    probability: float
    variation: float
    """Coefficient of variation of the estimate."""
    thresholds: list[float]
    """Value below which a level is; of the last one 0, unless that was not reached."""
    probabilities: list[float]
    """To be below each threshold."""

    @property
    def is_reached(self) -> bool:
        """False if failing is rarer than what was asked for: the probability is an upper bound."""
        return self.thresholds[-1] <= 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 %, of a lognormal distribution with the coefficient of variation."""
        factor = math.exp(_WITHIN * math.sqrt(math.log1p(self.variation**2)))
        return self.probability / factor, min(self.probability * factor, 1.0)


def subset_simulation(
    value: _Value, dimensions: int, per_level: int, least: float, seed: int
) -> Rare:
    """Return the probability that value <= 0 under a standard normal distribution.

    Subset simulation ([Au2001], Estimation of small failure probabilities in high
    dimensions by subset simulation): the lowest tenth of the runs of a level set a threshold, and
    begin chains that stay below it; the probability is the product of the shares of the levels.
    Chains go by adaptive conditional sampling ([Papaioannou2015], MCMC algorithms for subset
    simulation, section 3.4). The variance of a level's share is that of the sums over families of
    runs, those whose chains began in one chain of the level before; levels are taken as
    independent. Runs are asked for by a tenth of a level: one step of all chains. ``least`` is a
    probability below which no level is begun.

    Raises SimulationError if values do not fall from one level to the next.
    """
    random, count = np.random.default_rng(seed), per_level // CHAINS
    points = random.standard_normal((per_level, dimensions))
    values = np.concatenate([value(part) for part in np.split(points, CHAINS)])
    families = np.arange(per_level)
    chains = families
    probability, variance, width = 1.0, 0.0, 0.6
    thresholds: list[float] = []
    probabilities: list[float] = []
    while True:
        lowest = np.argsort(values, kind="stable")[:count]
        threshold = max(float(values[lowest[-1]]), 0.0)
        if thresholds and threshold >= thresholds[-1]:
            raise SimulationError(
                "robustness does not fall from one level to the next: it is the same in whole "
                "regions, and nothing says which of their runs are nearer to failing"
            )
        below = values <= threshold
        share = float(below.mean())
        sums = np.bincount(families, below - share)
        variance += float(sums @ sums) / (per_level * share) ** 2
        probability *= share
        thresholds.append(threshold)
        probabilities.append(probability)
        if threshold == 0.0 or probability < least:
            return Rare(probability, math.sqrt(variance), thresholds, probabilities)
        families = np.tile(chains[lowest], CHAINS)
        chains = np.tile(np.arange(count), CHAINS)
        points, values, width = _chains(
            value, points[lowest], values[lowest], threshold, width, random
        )


def _chains(
    value: _Value,
    points: np.ndarray,
    values: np.ndarray,
    threshold: float,
    width: float,
    random: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the points of chains below a threshold, their values, and the width as adapted."""
    spread = points.std(axis=0)
    all_points, all_values = [points], [values]
    for step in range(1, CHAINS):
        sigma = np.minimum(width * spread, 1.0)
        proposed = np.sqrt(1.0 - sigma**2) * points + sigma * random.standard_normal(points.shape)
        found = value(proposed)
        accepted = found <= threshold
        points = np.where(accepted[:, None], proposed, points)
        values = np.where(accepted, found, values)
        width *= math.exp((float(accepted.mean()) - _ACCEPTED) / math.sqrt(step))
        all_points.append(points)
        all_values.append(values)
    return np.vstack(all_points), np.concatenate(all_values), width
