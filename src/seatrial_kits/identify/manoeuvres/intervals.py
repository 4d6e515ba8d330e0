"""Uncertainty of identified parameters: by the information matrix, and by bootstrap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from seatrial.model.expressions import Vector

from ..output_error import covariances

FILE = 0.3
"""Standard deviation of the file's values that are kept, as a share of them."""
WITHIN = 1.96
"""Standard deviations on each side of an interval of 95 %."""
_RESAMPLES = 300


def deviations(
    jacobian: Vector,
    residual: Vector,
    stretches: Sequence[int],
    shown: Sequence[int],
    kept: Sequence[int],
) -> Vector:
    """Return the standard deviations of the unknowns ``shown`` (places of columns).

    C + G P G^T: C is the covariance with the others known, the larger one of that of a white
    residual and of that with its autocorrelation, which so few waves underrate, G = -(J^T J)^-1 J^T
    J_kept is what an error of the kept ones does to them, P their variance, `FILE` squared: a
    consider covariance (Bierman, Factorization Methods for Discrete Sequential Estimation, 1977).
    """
    J = jacobian[:, shown]
    variances = np.maximum(*(np.diag(each) for each in covariances(J, residual, stretches)))
    carried = np.linalg.lstsq(J, jacobian[:, kept], rcond=None)[0]
    found: Vector = np.sqrt(variances + FILE**2 * (carried**2).sum(axis=1))
    return found


def bootstrap(
    jacobian: Vector, residual: Vector, stretches: Sequence[int], seed: int = 1
) -> Vector:
    """Return the standard deviations (k,) of unknowns by a block bootstrap of the residual.

    Of each stretch, blocks of sqrt(n) rows are drawn with replacement (moving blocks, Kuensch
    1989), and the estimate follows to first order, -J^+ e. The residual's mean over a stretch is
    taken off, and its loss of k degrees of freedom made up for.
    """
    random = np.random.default_rng(seed)
    influence = np.linalg.pinv(jacobian)
    count, k = jacobian.shape
    edges = list(pairwise(np.cumsum([0, *stretches])))
    centred = np.concatenate([residual[a:b] - residual[a:b].mean() for a, b in edges])
    drawn = np.concatenate([_redrawn(centred[a:b], random) for a, b in edges], axis=1)
    spread = math.sqrt(count / max(count - k, 1))
    found: Vector = spread * (drawn @ influence.T).std(axis=0, ddof=1)
    return found


def _redrawn(residual: Vector, random: np.random.Generator) -> Vector:
    """Return resamples (m, n) of a stretch (n,), of blocks of it."""
    rows = len(residual)
    block = max(math.isqrt(rows), 1)
    starts = random.integers(rows - block + 1, size=(_RESAMPLES, -(-rows // block)))
    places = (starts[..., None] + np.arange(block)).reshape(_RESAMPLES, -1)
    found: Vector = residual[places[:, :rows]]
    return found
