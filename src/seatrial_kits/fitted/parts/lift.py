"""Lift slope of foils of low aspect ratio."""

from __future__ import annotations

import math
from typing import Any


def lift_slope(aspect_ratio: Any) -> Any:
    """Return dC_L/dalpha at no lift, 1/rad, of an unswept foil: 1.8 pi AR / (1.8 + sqrt(AR^2 + 4)).

    Whicker & Fehlner, DTMB report 933, 1958, with 0.9 of the section's 2 pi; AR is the effective
    aspect ratio, number or expression.
    """
    return 1.8 * math.pi * aspect_ratio / (1.8 + (aspect_ratio**2 + 4.0) ** 0.5)
