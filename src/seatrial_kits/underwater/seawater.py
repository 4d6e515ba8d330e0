"""Properties of sea water: salinity scale of 1978 and speed of sound.

Temperatures are in K here and in degrees Celsius, ITS-90, in the formulae, but for the salinity
scale, which is of IPTS-68: t68 = 1.00024 t90.
"""

from __future__ import annotations

import math

CELSIUS = 273.15
STANDARD = 4.2914
"""Conductivity of sea water of salinity 35 at 15 degrees (IPTS-68) and no pressure, S/m."""

_A = (0.0080, -0.1692, 25.3851, 14.0941, -7.0261, 2.7081)
_B = (0.0005, -0.0056, -0.0066, -0.0375, 0.0636, -0.0144)
_C = (0.6766097, 2.00564e-2, 1.104259e-4, -6.9698e-7, 1.0031e-9)
_MOST_RATIO = 4.0
"""Conductivity over the standard one, beyond any sea water's."""


def sound_speed(temperature: float, salinity: float, depth: float) -> float:
    """Return the speed of sound, m/s: K. V. Mackenzie, J. Acoust. Soc. Am. 70, 807 (1981).

    ``temperature`` K, ``salinity`` on the practical scale, ``depth`` m. Made for 2 to 30 degrees
    Celsius, 25 to 40, and down to 8000 m, with a standard error of 0.07 m/s.
    """
    t, s, d = temperature - CELSIUS, salinity - 35.0, depth
    return (
        1448.96
        + (4.591 + (-5.304e-2 + 2.374e-4 * t) * t) * t
        + (1.340 - 1.025e-2 * t) * s
        + (1.630e-2 + 1.675e-7 * d) * d
        - 7.139e-13 * t * d**3
    )


def salinity(conductivity: float, temperature: float, pressure: float) -> float:
    """Return the practical salinity, PSS-78: UNESCO Technical Papers in Marine Science 44 (1983).

    ``conductivity`` S/m, ``temperature`` K, ``pressure`` Pa above that of the air. Made for 2 to
    42; below what the scale begins at it is 0.
    """
    t, p = 1.00024 * (temperature - CELSIUS), pressure * 1e-4
    ratio = conductivity / STANDARD
    standard = sum(c * t**k for k, c in enumerate(_C))
    pressed = p * (2.070e-5 + (-6.370e-10 + 3.989e-15 * p) * p)
    pressed /= 1.0 + (3.426e-2 + 4.464e-4 * t) * t + (4.215e-1 - 3.107e-3 * t) * ratio
    root = math.sqrt(max(0.0, ratio / ((1.0 + pressed) * standard)))
    away = (t - 15.0) / (1.0 + 0.0162 * (t - 15.0))
    powers = [root**k for k in range(6)]
    found = sum((a + away * b) * x for a, b, x in zip(_A, _B, powers, strict=True))
    return max(0.0, found)


def conductivity(practical_salinity: float, temperature: float, pressure: float) -> float:
    """Return the conductivity, S/m, of which `salinity` is ``practical_salinity``, by bisection.

    ``temperature`` K, ``pressure`` Pa above that of the air.
    """
    low, high = 0.0, _MOST_RATIO * STANDARD
    for _ in range(60):
        middle = 0.5 * (low + high)
        if salinity(middle, temperature, pressure) < practical_salinity:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
