"""Extended thrust: rectangular components of propulsors that turn, within circles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .bounded import Array, weighted_least_squares

EFFORT = 1e-8
"""Weight of the sum of squares of shares: of all that give the demand, the least are taken."""
_STEPS, _SETTLED = 25, 1e-6
"""Most steps of the sequence, and the turn in rad with which it ends."""


class Demand(NamedTuple):
    """A wrench that is asked for, rows of N or N.m, and the weight of each."""

    wanted: Array
    weights: Array


class Shares(NamedTuple):
    """Parts with a direction: what each gives at share 1, by columns, and the shares it has."""

    columns: Array
    low: Array
    high: Array


def shares_of(demand: Demand, parts: Shares) -> Array:
    """Return the shares of parts with a direction that give a demand, as they can."""
    effort = np.full(len(parts.low), EFFORT)
    return weighted_least_squares(
        parts.columns, demand.wanted, demand.weights, effort, parts.low, parts.high
    )


def components(demand: Demand, others: Shares, along: Array, abeam: Array, start: Array) -> Array:
    """Return the rectangular components of k propulsors that turn, k by 2, as shares.

    Column i of ``along`` and ``abeam`` is the wrench of propulsor i at share 1 in its axis and
    90 deg from it. The components (a, b) of all of them, and the shares of the ``others``, have
    the least

        |W (B x - tau)|^2 + eps |x|^2,    a^2 + b^2 <= 1 of each

    (Sørdalen 1997; [Fossen2021], ch. 11): B is constant, so that no direction is singular.
    The circles are met by sequential quadratic programming: axes that are turned by the
    direction of the last solution, from ``start`` (rad), bound the part ahead by 1, and the
    multiplier of that bound, which is the curvature of the circle, weighs the part abeam. The
    sequence converges quadratically. Components that it leaves outside their circle are cut off.
    """
    angles, curvatures, count = start.copy(), np.zeros(len(start)), len(start)
    unit = np.ones(count)
    low = np.concatenate([others.low, -unit, -unit])
    high = np.concatenate([others.high, unit, unit])
    ahead, aside = np.zeros(count), np.zeros(count)
    for _ in range(_STEPS):
        c, s = np.cos(angles), np.sin(angles)
        columns = np.hstack([others.columns, along * c + abeam * s, abeam * c - along * s])
        effort = np.full(len(low), EFFORT)
        effort[-count:] += curvatures
        x = weighted_least_squares(columns, demand.wanted, demand.weights, effort, low, high)
        ahead, aside = x[-2 * count : -count], x[-count:]
        rest = demand.weights**2 * (demand.wanted - columns @ x)
        pull = (columns.T @ rest)[-2 * count : -count] - EFFORT * ahead
        curvatures = np.where(ahead == 1.0, np.maximum(pull, 0.0), 0.0)
        turns = np.arctan2(aside, ahead)
        angles = angles + turns
        if not (np.abs(turns[np.hypot(ahead, aside) > 1.0]) > _SETTLED).any():
            break
    sizes = np.minimum(np.hypot(ahead, aside), 1.0)
    return np.stack([sizes * np.cos(angles), sizes * np.sin(angles)], axis=1)
