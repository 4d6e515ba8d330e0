"""Weighted least squares with bounds, by an active-set method."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_SLACK = 1e-12
"""Share of the largest gradient that rounding may leave."""


def weighted_least_squares(
    matrix: Array, wanted: Array, weights: Array, effort: Array, low: Array, high: Array
) -> Array:
    """Return the x that minimises |W (B x - tau)|^2 + sum eps_i x_i^2 within low <= x <= high.

    B = ``matrix`` (m by n), tau = ``wanted`` (m), W = diag(``weights``) (m), eps = ``effort``
    (n, positive, so that x is unique). ``low`` is not above ``high``; alike, they fix an x.

    The active-set method of Härkegård (2002) for control allocation ([Fossen2021], ch. 11):
    x moves to the least squares of the variables that are free, up to the first bound in its way,
    which becomes active; there, of the active bounds from which the gradient leads inwards, the
    one with the steepest is released. Each step takes no chance: the same numbers give the same x.
    """
    stacked = np.vstack([weights[:, None] * matrix, np.diag(np.sqrt(effort))])
    goal = np.concatenate([weights * wanted, np.zeros(len(effort))])
    x: Array = np.clip(np.zeros_like(low), low, high)
    free = low < high
    steps = 10 * (len(x) + 1)  # each bound comes and goes a few times at most
    for _ in range(steps):
        move = _to_the_least(stacked, goal, x, free)
        share, blocking = _share_within(x, move, low, high)
        x = np.clip(x + share * move, low, high)
        if blocking is not None:
            # Exactly on its bound, whatever rounding left.
            x[blocking] = high[blocking] if move[blocking] > 0.0 else low[blocking]
            free[blocking] = False
            continue
        released = _inwards(stacked.T @ (goal - stacked @ x), x, free, low, high)
        if released is None:
            break
        free[released] = True
    return x


def _to_the_least(stacked: Array, goal: Array, x: Array, free: npt.NDArray[np.bool_]) -> Array:
    """Return the move of the free variables to their least squares; the others stay."""
    move = np.zeros_like(x)
    if free.any():
        rest = goal - stacked @ x
        move[free] = np.linalg.lstsq(stacked[:, free], rest, rcond=None)[0]
    return move


def _share_within(x: Array, move: Array, low: Array, high: Array) -> tuple[float, Any]:
    """Return the largest share of a move, up to 1, within the bounds, and the bound it meets."""
    ends = np.where(move > 0.0, high, low) - x
    with np.errstate(over="ignore"):  # next to no move meets no bound
        shares = np.divide(ends, move, out=np.full_like(x, np.inf), where=move != 0.0)
    first = int(np.argmin(shares)) if len(x) else 0
    if not len(x) or shares[first] >= 1.0:
        return 1.0, None
    return float(max(shares[first], 0.0)), first


def _inwards(descent: Array, x: Array, free: npt.NDArray[np.bool_], low: Array, high: Array) -> Any:
    """Return the active bound from which the descent leads inwards the steepest, or None."""
    inward = np.where(x == high, -descent, descent)
    inward[free | (low == high)] = 0.0
    if not len(x) or inward.max() <= _SLACK * np.abs(descent).max():
        return None
    return int(np.argmax(inward))
