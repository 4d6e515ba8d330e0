"""Flow that a part of a body meets where it is."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ..craft.context import Context

STILL = 1e-20
"""m/s: keeps derivatives finite where nothing flows."""


def through_water(c: Context, place: Any) -> Any:
    """Return the velocity of ``place`` through the water there, {b}, m/s: v_r + omega x r - dv.

    dv = R^T (shear n . r, 0) is the difference of the current over the depth between body origin
    and place. Waves move the water as at the body origin.
    """
    velocity = c.at(place)
    shear = getattr(c.inputs, "water_shear", None)
    if shear is None:
        return velocity
    return velocity - c.R.T @ ca.vertcat(shear * (c.vertical.T @ place), 0)


def held(value: Any, low: Any, high: Any) -> Any:
    """Return ``value`` within ``low`` and ``high``."""
    return ca.fmin(ca.fmax(value, low), high)
