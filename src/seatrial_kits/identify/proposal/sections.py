"""Added mass of sections of a floating hull, by Lewis forms and closed forms.

A section has the beam b and the draught T, m, and sigma, its area over b T. All per length.
"""

from __future__ import annotations

import math


def lewis(beam: float, draught: float, fullness: float) -> tuple[float, float]:
    """Return a1, a3 of the Lewis form of a section, H = b / (2 T) ([Lewis1929]).

        C = 3 + 4 sigma / pi + (1 - 4 sigma / pi) ((H - 1) / (H + 1))^2
        a3 = (3 - C + sqrt(9 - 2 C)) / C,   a1 = (1 + a3) (H - 1) / (H + 1)

    sigma is held within `fullness_range`.
    """
    half = beam / (2.0 * draught)
    low, high = fullness_range(half)
    area = 4.0 / math.pi * min(max(fullness, low), high)
    slant = (half - 1.0) / (half + 1.0)
    c = 3.0 + area + (1.0 - area) * slant**2
    a3 = (3.0 - c + math.sqrt(9.0 - 2.0 * c)) / c
    return (1.0 + a3) * slant, a3


def fullness_range(half: float) -> tuple[float, float]:
    """Return the sigma of Lewis forms that are neither re-entrant nor crossed, at H = ``half``.

    3 pi / 32 (2 - h) to pi / 32 (10 + h), h the lesser of H and 1 / H.
    """
    h = min(half, 1.0 / half) if half > 0.0 else 0.0
    return 3.0 * math.pi / 32.0 * (2.0 - h), math.pi / 32.0 * (10.0 + h)


def heave_mass(beam: float, draught: float, fullness: float, density: float) -> float:
    """Return the added mass in heave at high frequency, kg/m.

    rho pi / 8 b^2 ((1 + a1)^2 + 3 a3^2) / (1 + a1 + a3)^2: half of the doubled section's
    (map of [Lewis1929]).
    """
    a1, a3 = lewis(beam, draught, fullness)
    shape = ((1.0 + a1) ** 2 + 3.0 * a3**2) / (1.0 + a1 + a3) ** 2
    return density * math.pi / 8.0 * beam**2 * shape


def sway_mass(beam: float, draught: float, fullness: float, density: float) -> float:
    """Return the added mass in sway at low frequency, kg/m.

    rho pi / 2 T^2 ((1 - a1)^2 + 3 a3^2) / (1 - a1 + a3)^2: half of the doubled section's.
    """
    a1, a3 = lewis(beam, draught, fullness)
    shape = ((1.0 - a1) ** 2 + 3.0 * a3**2) / (1.0 - a1 + a3) ** 2
    return density * math.pi / 2.0 * draught**2 * shape


def roll_inertia(beam: float, draught: float, density: float) -> float:
    """Return the added inertia in roll about the water line at high frequency, kg.m.

    rho pi / 16 ((b/2)^2 - T^2)^2: half of an ellipse's ([Lamb1932], art. 71); 0 of a half circle.
    """
    return density * math.pi / 16.0 * ((beam / 2.0) ** 2 - draught**2) ** 2
