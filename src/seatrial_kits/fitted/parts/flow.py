"""Flow that a part of a body meets where it is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context

STILL = 1e-20
"""m/s: keeps derivatives finite where nothing flows."""


def through_water(c: Context, slot: SimpleNamespace, aft: Any = 0) -> Any:
    """Return the velocity of a part through the water there, {b}, m/s: v_r + omega x r - R^T dv.

    r is the slot's ``position``, ``aft`` m further aft; dv = (shear n . r, 0) + dv_w is by how much
    the water moves otherwise than at the body origin: by the shear of the current over depth, and
    by waves, the slot's ``waves`` (`orbital`), those of its ``position``.
    """
    place = slot.position - ca.vertcat(aft, 0, 0)
    velocity = c.at(place)
    shear = getattr(c.inputs, "water_shear", None)
    if shear is None:
        return velocity
    beyond = ca.vertcat(shear * (c.vertical.T @ place), 0)
    return velocity - c.R.T @ (beyond + slot.waves)


def held(value: Any, low: Any, high: Any) -> Any:
    """Return ``value`` within ``low`` and ``high``."""
    return ca.fmin(ca.fmax(value, low), high)
