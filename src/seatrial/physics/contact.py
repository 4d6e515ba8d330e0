"""Contact by penalty: normal force of two laws, friction regularised or with bristles.

``penetration`` is how far a point is inside, m, along the normal out of the surface; ``rate``
is its derivative, m/s, positive inwards. Forces are N, on the point, the normal one along the
normal and so never below 0. All but `Bristle` take numbers or CasADi expressions.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

_LEAST_NORMAL = 1e-9
"""Below this normal force, N, there is no friction: nothing is divided by it."""


def hunt_crossley(penetration: Any, rate: Any, stiffness: float, damping: float) -> Any:
    """Return k delta max(0, 1 + d rate) where delta > 0, else 0.

    ``stiffness`` k in N/m, ``damping`` d in s/m. Without a jump at touch-down, and never pulling.
    K. H. Hunt and F. R. E. Crossley, J. Appl. Mech. 42, 440 (1975), with exponent 1.
    """
    return stiffness * _above(penetration) * _above(1.0 + damping * rate)


def kelvin_voigt(penetration: Any, rate: Any, stiffness: float, damping: float) -> Any:
    """Return max(0, k delta + c rate) where delta > 0, else 0; it jumps by c rate at touch-down.

    ``stiffness`` k in N/m, ``damping`` c in N.s/m.
    """
    return _above(stiffness * penetration + damping * rate) * (penetration > 0.0)


def restitution(damping: float, speed: float) -> float:
    """Return the speed after an impact at ``speed``, m/s, over it, of `hunt_crossley`.

    e solves d (v + e v) = ln((1 + d v) / (1 - d e v)), by bisection.
    """
    x = damping * speed
    if x <= 0.0:
        return 1.0
    low, high = 0.0, min(1.0, 1.0 / x) * (1.0 - 1e-15)
    for _ in range(100):
        e = 0.5 * (low + high)
        # The left side wins below the solution.
        if x * (1.0 + e) > math.log((1.0 + x) / (1.0 - x * e)):
            low = e
        else:
            high = e
    return 0.5 * (low + high)


def friction(normal: Any, velocity: Sequence[Any], coefficient: float, slip_speed: float) -> Any:
    """Return -mu N v / sqrt(|v|^2 + v_s^2) for each component of the tangential velocity v.

    ``coefficient`` mu, ``slip_speed`` v_s in m/s, above 0. Smooth, so that it creeps: on a slope
    of r mu by v_s r / sqrt(1 - r^2), r from 0 to 1.
    """
    squares = sum(v * v for v in velocity) + slip_speed * slip_speed
    share = -coefficient * normal / squares**0.5
    return [share * v for v in velocity]


@dataclass(frozen=True)
class Bristle:
    """Friction whose bristles bend by z, m: dz/dt = v - s0 |v| z / (mu N), F = -(s0 z + s1 v).

    ``stiffness`` s0 in N/m, ``damping`` s1 in N.s/m, ``coefficient`` mu. It holds without creep.
    C. Canudas de Wit et al., IEEE Trans. Automatic Control 40, 419 (1995), without the Stribeck
    effect and viscous friction. The state z, by tangential component, is the caller's.
    """

    coefficient: float
    stiffness: float
    damping: float

    def rate(
        self, bend: Sequence[float], velocity: Sequence[float], normal: float
    ) -> tuple[float, ...]:
        """Return dz/dt, m/s; without contact the bend stays as it is."""
        if normal < _LEAST_NORMAL:
            return tuple(0.0 for _ in bend)
        share = self.stiffness * math.hypot(*velocity) / (self.coefficient * normal)
        return tuple(v - share * z for v, z in zip(velocity, bend, strict=True))

    def force(
        self, bend: Sequence[float], velocity: Sequence[float], normal: float
    ) -> tuple[float, ...]:
        """Return the tangential force on the point, N; none without contact."""
        if normal < _LEAST_NORMAL:
            return tuple(0.0 for _ in bend)
        pairs = zip(bend, velocity, strict=True)
        return tuple(-(self.stiffness * z + self.damping * v) for z, v in pairs)


def _above(value: Any) -> Any:
    """Return max(0, value), exact for numbers."""
    return 0.5 * (value + abs(value))
