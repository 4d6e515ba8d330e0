"""Lift of a foil of finite span."""

from __future__ import annotations

import math


def lift_slope(aspect_ratio: float) -> float:
    """Return the slope of the lift coefficient at no angle of attack, 1/rad.

        dC_L/dalpha = 0.9 (2 pi) A / (sqrt(A^2 + 4) + 1.8)

    A = ``aspect_ratio``, the effective one, without sweep (Whicker and Fehlner 1958, DTMB Report
    933).
    """
    return 1.8 * math.pi * aspect_ratio / (math.sqrt(aspect_ratio**2 + 4.0) + 1.8)
