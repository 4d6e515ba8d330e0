"""Boundary of the region that passes, found by runs where it is least certain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .searching import one_thread
from .surrogate import Surrogate

_BATCH = 8
"""Runs asked for at a time; a constant, so that no result depends on who runs them."""
_CANDIDATES = 4096
_NEAR = 400
"""Of them those near what is least certain, which come on top."""
_JOINT = 300
"""Of the candidates those among which a batch is chosen."""
SURE = 1.96
"""Standard deviations of the mean that 95 % of a normal distribution lie within."""


@dataclass
class Boundary:
    """The runs, shares of the ranges and robustness, and what they say of all other points."""

    points: np.ndarray
    values: np.ndarray
    surrogate: Surrogate

    @property
    def has_both(self) -> bool:
        """True if some runs pass and others do not."""
        return bool((self.values > 0).any() and (self.values <= 0).any())

    def mistaken(self) -> float:
        """Return the share of the runs that all others would have put on the other side."""
        return float(((self.surrogate.left_out() > 0) != (self.values > 0)).mean())


def find_boundary(
    value: Callable[[np.ndarray], np.ndarray], dimensions: int, runs: int, seed: int = 0
) -> Boundary:
    """Return the boundary value = 0 within the unit cube, after so many runs.

    A third of the runs are the corners and points of Sobol's sequence; each further batch is where
    1.96 sigma - |mu| is greatest, mu and sigma being mean and standard deviation of a Gaussian
    process of the runs so far (the straddle heuristic of [Bryan2005], Active learning for
    identifying function threshold boundaries); within a batch sigma is as if the runs before had
    found mu. ``value`` gets points, a row each, and returns a number for each: positive where the
    trial passes.
    """
    from scipy.stats import qmc  # half a second, of every command if it stood above

    corners = np.array(list(np.ndindex(*[2] * dimensions)), float)
    count = min(max(runs // 3, 8 * dimensions), runs)
    sequence = qmc.Sobol(dimensions, seed=np.random.default_rng([seed, 0]))
    first = sequence.random(1 << (count - len(corners) - 1).bit_length())
    points = np.vstack([corners, first[: count - len(corners)]])
    values = value(points)
    surrogate = Surrogate(dimensions, float(np.median(np.abs(values))) or 1.0)
    turn = 0
    while True:
        with one_thread():
            surrogate.fit(points, values)
        if len(points) >= runs:
            return Boundary(points, values, surrogate)
        turn += 1
        with one_thread():
            chosen = _chosen(surrogate, dimensions, min(_BATCH, runs - len(points)), [seed, turn])
        points = np.vstack([points, chosen])
        values = np.append(values, value(chosen))


def _chosen(surrogate: Surrogate, dimensions: int, count: int, seed: list[int]) -> np.ndarray:
    """Return the points of a batch."""
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    spread = qmc.Sobol(dimensions, seed=random).random(_CANDIDATES)
    best = spread[np.argsort(-_straddle(*surrogate.at(spread)), kind="stable")[:_NEAR]]
    near = np.clip(best + random.normal(0.0, 0.02, best.shape), 0.0, 1.0)
    points = np.vstack([spread, near])
    mean, sigma = surrogate.at(points)
    order = np.argsort(-_straddle(mean, sigma), kind="stable")[:_JOINT]
    points, mean = points[order], mean[order]
    covariance = surrogate.covariance(points)
    chosen = []
    for _ in range(count):
        variance = np.maximum(np.diag(covariance), 0.0)
        place = int(np.argmax(_straddle(mean, np.sqrt(variance))))
        chosen.append(place)
        column = covariance[:, place]
        covariance = covariance - np.outer(column, column) / max(variance[place], 1e-12)
    return points[chosen]


def _straddle(mean: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    result: np.ndarray = SURE * sigma - np.abs(mean)
    return result
