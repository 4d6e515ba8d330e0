"""Prolate spheroid: displaced mass, inertia, and Lamb's factors of added mass.

Semi-axes a = length / 2 along x and b = diameter / 2 across, a >= b. All about the centre, in the
principal axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ....errors import InputError

_SLIGHT = 0.3
"""Eccentricity below which the closed forms cancel, and the series is as good as exact."""
_TERMS = 20
"""Of the series: 0.3^40 is beyond double precision."""


@dataclass(frozen=True)
class Lamb:
    """Lamb's factors (Hydrodynamics, 6th ed., art. 114 and 115; [Fossen2021], section 8.4.2)."""

    k1: float
    """Added mass along the axis, of the displaced mass."""
    k2: float
    """Added mass across the axis, of the displaced mass."""
    k_prime: float
    """Added inertia about an axis across, of that of the displaced mass."""


def lamb(length: float, diameter: float) -> Lamb:
    """Return Lamb's factors of the spheroid of ``length`` and ``diameter``, m.

    With e^2 = 1 - (b/a)^2:

        alpha_0 = 2 (1 - e^2) / e^3 (ln((1 + e) / (1 - e)) / 2 - e),   beta_0 = 1 - alpha_0 / 2
        k1 = alpha_0 / (2 - alpha_0),   k2 = beta_0 / (2 - beta_0)
        k' = e^4 (beta_0 - alpha_0) / ((2 - e^2) (2 e^2 - (2 - e^2) (beta_0 - alpha_0)))

    A sphere has 1/2, 1/2 and 0. Raises InputError unless length >= diameter > 0.
    """
    _require_prolate(length, diameter)
    e2 = 1.0 - (diameter / length) ** 2
    s, t = _integrals(math.sqrt(e2))
    alpha, beta = 2.0 * (1.0 - e2) * s, 1.0 - (1.0 - e2) * s
    k_prime = e2**2 * t / ((2.0 - e2) * (2.0 - (2.0 - e2) * t))
    return Lamb(alpha / (2.0 - alpha), beta / (2.0 - beta), k_prime)


def displaced_mass(length: float, diameter: float, density: float) -> float:
    """Return 4/3 pi rho a b^2, kg, of ``density`` rho, kg/m3."""
    return math.pi / 6.0 * density * length * diameter**2


def inertia(mass: float, length: float, diameter: float) -> tuple[float, float]:
    """Return the inertia of an even spheroid about its axis, 2/5 m b^2, and across it.

    The latter is m (a^2 + b^2) / 5; both kg.m2.
    """
    a, b = length / 2.0, diameter / 2.0
    return 0.4 * mass * b**2, 0.2 * mass * (a**2 + b**2)


def _integrals(e: float) -> tuple[float, float]:
    """Return s = (artanh e - e) / e^3 and t = (beta_0 - alpha_0) / e^2."""
    if e >= _SLIGHT:
        s = (math.atanh(e) - e) / e**3
        return s, (1.0 - 3.0 * (1.0 - e**2) * s) / e**2
    powers = [e ** (2 * k) for k in range(_TERMS)]
    s = sum(power / (2 * k + 3) for k, power in enumerate(powers))
    return s, sum(6.0 * power / ((2 * k + 3) * (2 * k + 5)) for k, power in enumerate(powers))


def _require_prolate(length: float, diameter: float) -> None:
    if not length >= diameter > 0.0:
        raise InputError(
            f"spheroid: length {length!r} m and diameter {diameter!r} m; a length of at least the "
            "diameter, and a diameter of more than 0, are allowed"
        )
