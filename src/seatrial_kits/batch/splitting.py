"""Probabilities of rare events in time, by splitting copies where they come closer to them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from seatrial.errors import InputError, SimulationError

_MOST_SEED = 2**31


@dataclass(frozen=True)
class Split:
    """How likely a signal rises to a level, by the levels on the way there."""

    levels: tuple[float, ...]
    shares: tuple[float, ...]
    """Of the copies that began at a level, those that reached the next, up to the first 0."""

    @property
    def probability(self) -> float:
        """Of reaching the last level: the product of the shares."""
        return math.prod(self.shares)

    @property
    def is_reached(self) -> bool:
        """False if no copy reached the last level: the probability is then 0 for want of copies."""
        return self.shares[-1] > 0.0

    def variation(self, count: int) -> float:
        """Return the coefficient of variation with ``count`` copies, levels taken as independent.

        sqrt(sum (1 - p)/(count p)) over the shares p; infinite if the last level is not reached.
        """
        if not self.is_reached:
            return math.inf
        return math.sqrt(sum((1.0 - p) / (count * p) for p in self.shares))


class Copies(Protocol):
    """Copies that are split, as `Batch` is."""

    count: int
    step_size: float

    @property
    def time(self) -> NDArray[np.float64]:
        """Simulated time of each, s."""

    @property
    def failures(self) -> dict[int, str]:
        """By number of each that cannot go on: why."""

    def get(self, name: str) -> NDArray[np.float64]:
        """Return values of all copies."""

    def step(self, count: int, mask: NDArray[np.bool_]) -> None:
        """Let the copies of the mask take steps."""

    def save(self) -> Any:
        """Return the states of all copies."""

    def restore(self, state: Any, *, source: NDArray[np.int64], seed: list[int]) -> None:
        """Let copies go on from states of others, with other noise."""


def split(batch: Copies, name: str, levels: Sequence[float], until: float, seed: int) -> Split:
    """Return what `Batch.split` says."""
    if not levels or any(b <= a for a, b in pairwise(levels)):
        raise InputError(f"split: levels must rise, found {list(levels)}")
    if np.ndim(batch.get(name)) != 1:
        raise InputError(f"split: {name} is no scalar")
    random, shares = np.random.default_rng(seed), list[float]()
    for level in levels:
        reached = _reached(batch, name, level, until)
        shares.append(float(reached.mean()))
        if not reached.any():
            break
        # Each state is gone on from as often as the others, or once more.
        sources = np.resize(random.permutation(np.flatnonzero(reached)), batch.count)
        fresh = random.integers(1, _MOST_SEED, batch.count)
        batch.restore(batch.save(), source=sources, seed=fresh.tolist())
    return Split(tuple(levels), tuple(shares))


def _reached(batch: Copies, name: str, level: float, until: float) -> NDArray[np.bool_]:
    """Step copies up to a level, where each stays, or to the time; return which are there."""
    last = until - 0.5 * batch.step_size
    while True:
        reached = batch.get(name) >= level
        for number, why in batch.failures.items():
            raise SimulationError(f"split: copy {number} cannot go on: {why}")
        going = ~reached & (batch.time < last)
        if not going.any():
            return reached
        batch.step(1, going)
