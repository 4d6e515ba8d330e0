"""Lag and rate limit between an order and what has followed it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import casadi as ca

from .coefficients import Part
from .flow import held

_QUICK = 0.02
"""s: lag of what has a rate limit and no time constant, so that it settles without chatter."""
_UNLIMITED = 1e9
_FULL_TURN = math.tau - 1e-3
"""rad: a range from here on is endless; pi is often written with few digits."""


class Lag(NamedTuple):
    """Limits of an order, and the lag that follows it."""

    low: Any
    high: Any
    endless: Any
    """Whether the order is an angle that has no limits and is reached the shortest way."""
    time_constant: Any
    rate: Any


class Followed(NamedTuple):
    """Values that act, and the rates of change of the states behind their orders."""

    values: list[Any]
    changes: list[Any]


def order_lag(part: Part) -> Lag:
    """Return that of a propulsor's order."""
    return Lag(-1, 1, False, part.slot.time_constant, 0)


def angle_lag(part: Part) -> Lag:
    """Return that of a propulsor's angle: endless in a range of a full turn or more."""
    s = part.slot
    low, high = ca.vertsplit(s.angle_limit)
    endless = high - low >= _FULL_TURN
    return Lag(low, high, endless, s.angle_time_constant, s.angle_rate)


def foil_lag(part: Part) -> Lag:
    """Return that of a foil's angle."""
    s = part.slot
    return Lag(-s.angle_limit, s.angle_limit, False, s.time_constant, s.angle_rate)


def ballast_lag(part: Part) -> Lag:
    """Return that of a ballast's share: 0 to 1 of a tank, -1 to 1 of others."""
    return Lag(0 if part.kind == "tank" else -1, 1, False, 0, part.slot.rate)


def follow(lags: Sequence[Lag], orders: Any, states: Any) -> Followed:
    """Return what follows the first of ``orders``, with ``states`` behind them, by their lags.

    state' = (order - state) / T, held within +- the rate; a rate of 0 is no limit. With neither
    time constant nor rate limit the order acts at once, and the state keeps its start value.
    """
    followed = [_followed(lag, orders[k], states[k]) for k, lag in enumerate(lags)]
    return Followed([value for value, _ in followed], [change for _, change in followed])


def _followed(lag: Lag, order: Any, state: Any) -> tuple[Any, Any]:
    way = _way(lag, order, state)
    limit = ca.if_else(lag.rate > 0, lag.rate, _UNLIMITED)
    change = held(way / ca.fmax(lag.time_constant, _QUICK), -limit, limit)
    at_once = ca.logic_and(lag.time_constant <= 0, lag.rate <= 0)
    return state + ca.if_else(at_once, way, 0), ca.if_else(at_once, 0, change)


def _way(lag: Lag, order: Any, state: Any) -> Any:
    """Return the order, limited, less the state."""
    limited = held(order, lag.low, lag.high) - state
    if lag.endless is False:
        return limited
    straight = order - state
    shortest = straight - math.tau * ca.floor((straight + math.pi) / math.tau)
    return ca.if_else(lag.endless, shortest, limited)
