"""Identifiability of parameters: which ones a manoeuvre shows, and what becomes of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.model.expressions import Vector

from ..output_error import covariances

CERTAIN = 0.15
"""Largest standard deviation of what is identifiable, as a share of the file's value."""
ALIKE = 0.95
"""Correlation from which two parameters are hardly separable."""


@dataclass(frozen=True)
class Pair:
    """Two unknowns of which ``first`` - ``ratio`` ``second`` is identifiable, each one hardly."""

    first: str
    second: str
    correlation: float
    ratio: float
    """Of relative changes."""
    deviation: float
    """Of that combination, relative."""


@dataclass(frozen=True)
class Identifiability:
    """Unknowns that the passes show, and those that keep the file's values."""

    shown: tuple[str, ...]
    kept: dict[str, float]
    """Relative standard deviation that each would have."""
    pairs: tuple[Pair, ...]


def identifiability(
    jacobian: Vector, residual: Vector, stretches: Sequence[int], names: Sequence[str]
) -> Identifiability:
    """Return which of the first unknowns, ``names``, the passes show.

    Unknowns are relative changes; those behind ``names`` are always looked for. While a standard
    deviation (`covariances`, with the residual's autocorrelation) is above `CERTAIN`, the unknown
    with the largest one is kept at the file's value, paired with the one that it is most
    correlated with. Of those shown, pairs with a correlation above `ALIKE` are named, too.
    """
    shown, kept, pairs = list(range(len(names))), {}, []
    problem = _Linear(jacobian, residual, stretches, names)
    while shown:
        deviations = np.sqrt(np.diag(problem.covariance(shown)))
        worst = int(np.argmax(deviations))
        if deviations[worst] <= CERTAIN:
            break
        kept[names[shown[worst]]] = float(deviations[worst])
        pairs += problem.pair(shown, worst)
        del shown[worst]
    found = [pair for place in range(len(shown)) for pair in problem.pair(shown, place)]
    alike = {frozenset((pair.first, pair.second)): pair for pair in reversed(found)}
    return Identifiability(
        tuple(names[i] for i in shown), kept, (*pairs, *reversed(alike.values()))
    )


@dataclass(frozen=True)
class _Linear:
    """A problem at its solution: unknowns behind ``names`` are always looked for."""

    jacobian: Vector
    residual: Vector
    stretches: Sequence[int]
    names: Sequence[str]

    def covariance(self, looked_for: Sequence[int]) -> Vector:
        """Return the covariance of the unknowns of ``names`` that are looked for."""
        columns = [*looked_for, *range(len(self.names), self.jacobian.shape[1])]
        _, found = covariances(self.jacobian[:, columns], self.residual, self.stretches)
        count = len(looked_for)
        return found[:count, :count]

    def pair(self, looked_for: Sequence[int], place: int) -> list[Pair]:
        """Return the pair of an unknown with the one that it is most correlated with."""
        if len(looked_for) < 2:
            return []
        covariance = self.covariance(looked_for)
        scale = np.sqrt(np.diag(covariance))
        correlation = covariance[place] / scale / scale[place]
        correlation[place] = 0.0
        other = int(np.argmax(np.abs(correlation)))
        if abs(correlation[other]) <= ALIKE:
            return []
        # The combination is as certain as the first would be if the second were known.
        known = [each for each in looked_for if each != looked_for[place]]
        certain = self.covariance(known)[known.index(looked_for[other])]
        return [
            Pair(
                self.names[looked_for[other]],
                self.names[looked_for[place]],
                float(correlation[other]),
                float(covariance[other, place] / covariance[place, place]),
                float(np.sqrt(certain[known.index(looked_for[other])])),
            )
        ]
