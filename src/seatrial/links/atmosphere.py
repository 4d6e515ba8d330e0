"""Pressure of the International Standard Atmosphere."""

from __future__ import annotations

SEA_LEVEL_PA, SEA_LEVEL_K = 101_325.0, 288.15
"""Pressure and temperature at the altitude 0."""
LAPSE = 0.0065
"""K/m."""
_EXPONENT = 5.25588


def standard_pressure(altitude: float) -> float:
    """Return the pressure at an altitude, m, in Pa: p0 (1 - 0.0065 h / 288.15)^5.25588.

    ISO 2533, up to 11 km; below the surface too, as in air.
    """
    return float(SEA_LEVEL_PA * (1.0 - LAPSE * altitude / SEA_LEVEL_K) ** _EXPONENT)
