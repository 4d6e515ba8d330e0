"""Rigid sail on an upright axis, in the air at its centre of effort."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.foils import foil_load
from seatrial.physics.craft.terms.context import Context, wrench
from seatrial.physics.foils import sail_naca0015


def sail(c: Context, slot: SimpleNamespace, angle: Any) -> Any:
    """Return the load (6,) of a sail of NACA 0015: law and table of the `Sailboat`, without flap.

    The air's velocity at the centre of effort, ``arm`` along the boom from the axis at its
    ``position``, is R^T wind less that of the place over ground; of it the components along x and
    y act. A positive angle turns the trailing edge to starboard; the roll is not taken.
    """
    p = c.parameters
    boom = ca.vertcat(-ca.cos(angle), ca.sin(angle), 0)
    place = slot.position + slot.arm * boom
    over_ground = c.nu[:3] + ca.cross(c.nu[3:], place)
    air = c.R.T @ ca.vertcat(c.inputs.wind, 0) - over_ground
    table = sail_naca0015("patched", "physical")
    scale = p.air_density / 2 * slot.area
    X, Y, _K, _N = ca.vertsplit(foil_load(table, place, air[:2], -angle, scale))
    return wrench(ca.vertcat(X, Y, 0), place)
