"""Telling parameters apart: which ones a manoeuvre shows, and what becomes of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.model.expressions import Vector

from ..output_error import covariances

CERTAIN = 0.15
"""Largest standard deviation of a parameter that is told, as a share of the file's value."""
ALIKE = 0.95
"""Correlation from which two parameters are hardly told apart."""


@dataclass(frozen=True)
class Pair:
    """Two unknowns that are hardly told apart: ``first`` - ``ratio`` ``second`` can be had."""

    first: str
    second: str
    correlation: float
    ratio: float
    """Of relative changes."""
    deviation: float
    """Of that combination, relative."""


@dataclass(frozen=True)
class Told:
    """Unknowns that the passes show, and those that keep the file's values."""

    told: tuple[str, ...]
    kept: dict[str, float]
    """Relative standard deviation that each would have."""
    pairs: tuple[Pair, ...]


def told_apart(
    jacobian: Vector, residual: Vector, stretches: Sequence[int], names: Sequence[str]
) -> Told:
    """Return which of the first unknowns, ``names``, the passes show.

    Unknowns are relative changes; those behind ``names`` are always looked for. While a standard
    deviation (`covariances`, with the residual's autocorrelation) is above `CERTAIN`, the unknown
    with the largest one is kept at the file's value, paired with the one that it is most
    correlated with. Of those told, pairs with a correlation above `ALIKE` are named, too.
    """
    told, kept, pairs = list(range(len(names))), {}, []
    states = list(range(len(names), jacobian.shape[1]))
    while told:
        _, covariance = covariances(jacobian[:, [*told, *states]], residual, stretches)
        covariance = covariance[: len(told), : len(told)]
        deviations = np.sqrt(np.diag(covariance))
        worst = int(np.argmax(deviations))
        if deviations[worst] <= CERTAIN:
            break
        kept[names[told[worst]]] = float(deviations[worst])
        pairs += _with(covariance, worst, [names[i] for i in told])
        del told[worst]
    if told:
        own = [names[i] for i in told]
        found = [pair for place in range(len(told)) for pair in _with(covariance, place, own)]
        seen: set[frozenset[str]] = set()
        for pair in sorted(found, key=lambda each: -each.correlation):
            if (both := frozenset((pair.first, pair.second))) not in seen:
                seen.add(both)
                pairs.append(pair)
    return Told(tuple(names[i] for i in told), kept, tuple(pairs))


def _with(covariance: Vector, place: int, names: Sequence[str]) -> list[Pair]:
    """Return the pair of an unknown with the one that it is most correlated with."""
    scale = np.sqrt(np.diag(covariance))
    correlation = covariance[place] / scale / scale[place]
    correlation[place] = 0.0
    other = int(np.nanargmax(np.abs(correlation)))
    if abs(correlation[other]) <= ALIKE:
        return []
    ratio = covariance[other, place] / covariance[place, place]
    left = max(covariance[other, other] - ratio * covariance[other, place], 0.0)
    return [Pair(names[other], names[place], float(correlation[other]), float(ratio), left**0.5)]
