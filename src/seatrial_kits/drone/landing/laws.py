"""Laws of a landing: accelerations wanted of a multirotor, m/s2, {n}, and the thrust for them."""

from __future__ import annotations

import math
from collections.abc import Sequence

GRAVITY = 9.81
TILT = 0.40
"""The thrust is tilted by this at most, rad."""
_POSITION, _VELOCITY, _INTEGRAL = 3.0, 3.4, 1.5
_MOST_INTEGRAL = 5.0
"""What the integral gives at most, m/s2: it carries the wind."""
_VERTICAL = 4.0
_FORWARD = 0.7
"""Share of the deck's acceleration that is fed forward."""
_LOW = 0.6
"""Below this height, m, the tilt stays near that of integral and deck."""

Pair = tuple[float, float]


def integrated(total: Sequence[float], error: Sequence[float], h: float) -> Pair:
    """Return the integral of the error, m.s, after ``h`` s, limited in its length."""
    north, east = (i + e * h for i, e in zip(total, error, strict=True))
    length, most = math.hypot(north, east), _MOST_INTEGRAL / _INTEGRAL
    share = min(1.0, most / length) if length else 1.0
    return north * share, east * share


def below(
    error: Sequence[float],
    slower: Sequence[float],
    total: Sequence[float],
    deck: Sequence[float],
    height: float,
) -> Pair:
    """Return 3.0 e + 3.4 (v_deck - v) + 1.5 int e + a_deck, and near the deck less.

    ``slower`` is v_deck - v, ``total`` the integral, ``deck`` its acceleration. Below 0.6 m the
    thrust's tilt stays within 0.06 rad + 0.7 rad/m (height - 0.1 m) of that of the last two.
    """
    base = [_INTEGRAL * i + a for i, a in zip(total, deck, strict=True)]
    more = [_POSITION * e + _VELOCITY * v for e, v in zip(error, slower, strict=True)]
    if height < _LOW:
        most = GRAVITY * max(0.0, 0.06 + 0.7 * (height - 0.1))
        length = math.hypot(*more)
        share = min(1.0, most / length) if length else 1.0
        more = [share * m for m in more]
    return base[0] + more[0], base[1] + more[1]


def sinking(height: float) -> float:
    """Return the speed towards the deck of `relative`, m/s, at a height of the feet, m."""
    return min(0.4 + 0.3 * max(height - 0.5, 0.0), 0.8)


def braking(closing: float) -> float:
    """Return the height, m, in which `down` brakes from a speed towards the deck, m/s, to 0.4 m/s.

    Twice (closing - 0.4 m/s) / 4 s^-1, the way of the lag that the law is on a deck at rest.
    """
    return 2.0 * max(closing - 0.4, 0.0) / _VERTICAL


def down(wanted: float, velocity: float, deck_acceleration: float) -> float:
    """Return the acceleration downwards for a velocity ``wanted``, m/s."""
    return _VERTICAL * (wanted - velocity) + _FORWARD * deck_acceleration


def rendezvous(way: float, velocity: float, meeting: float, left: float) -> float:
    """Return 6 (way - v T) / T^2 - 2 (v_T - v) / T: least energy to a place and a velocity.

    ``way`` to go in ``left`` T, s; ``velocity`` v now and ``meeting`` v_T then, m/s.
    """
    return 6.0 * (way - velocity * left) / left**2 - 2.0 * (meeting - velocity) / left


def rising(to_go: float, velocity: float) -> float:
    """Return the acceleration downwards to a height that is ``to_go`` m farther down."""
    return 2.5 * (max(-1.5, min(1.0 * to_go, 1.0)) - velocity)


def thrust_for(
    acceleration: Sequence[float], mass: float, psi: float
) -> tuple[float, tuple[float, float, float]]:
    """Return thrust, N, and attitude (phi, theta, psi) for an acceleration in {n}.

    The force is m (a - g e3), 0.3 m g upwards at least, and tilted by `TILT` at most.
    """
    north, east, vertical = acceleration
    up = max(GRAVITY - vertical, 0.3 * GRAVITY)
    aside, most = math.hypot(north, east), up * math.tan(TILT)
    share = min(1.0, most / aside) if aside else 1.0
    north, east = share * north, share * east
    # Body z points against the force; by ZYX with psi given.
    ahead = math.cos(psi) * north + math.sin(psi) * east
    starboard = math.cos(psi) * east - math.sin(psi) * north
    theta = math.atan2(-ahead, up)
    phi = math.atan2(starboard, math.hypot(ahead, up))
    return mass * math.sqrt(north**2 + east**2 + up**2), (phi, theta, psi)
