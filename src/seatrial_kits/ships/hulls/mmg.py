"""Forces of the MMG standard method on a ship's hull, propeller and rudder.

Equations, signs and what goes beyond the method: `MmgShip`, whose parameters ``p`` has.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, NamedTuple

import casadi as ca

from seatrial_kits.fitted.parts.flow import STILL, held
from seatrial_kits.fitted.parts.rudder import blade, in_race, straightened
from seatrial_kits.fitted.parts.screws import all_quadrants, open_water
from seatrial_kits.fitted.parts.wageningen import wageningen_b4_70

from .polynomials import polynomial

SURGE_TERMS = ("vv", "vr", "rr", "vvvv")
SWAY_TERMS = ("v", "r", "vvv", "vvr", "vrr", "rrr")
_LARGEST_TURN = 2.0
"""|r'| from which on the hull's forces are those of that r': ships turn at up to about 1."""
_ABEAM = 0.1
"""|u| / U below which the resistance goes over to its value astern."""


class Flow(NamedTuple):
    """Motion through the water, as hull, propeller and rudder see it."""

    u: Any
    v: Any
    r: Any
    speed: Any
    """U, m/s."""
    hull_speed: Any
    """U of the hull's forces, m/s, more than 0."""
    drift: Any
    """beta, rad, positive as the ship goes to port; of |u|."""


class Screw(NamedTuple):
    """Rate, thrust, torque and advance ratio of the propeller."""

    rate: Any
    thrust: Any
    torque: Any
    advance: Any


def flow_of(nu_r: Any, p: SimpleNamespace) -> Flow:
    """Return the motion of a velocity (u, v, r) through the water, m/s and rad/s."""
    u, v, r = ca.vertsplit(nu_r)
    speed = ca.sqrt(u**2 + v**2 + STILL**2)
    hull_speed = ca.fmax(speed, ca.fabs(r) * p.length / _LARGEST_TURN)
    return Flow(u, v, r, speed, hull_speed, ca.atan2(-v, ca.fabs(u) + STILL))


def hull_load(flow: Flow, p: SimpleNamespace) -> Any:
    """Return X_H, Y_H and N_H, N and N.m."""
    U = flow.hull_speed
    factors = {"v": flow.v / U, "r": flow.r * p.length / U}
    ahead = held(flow.u / (_ABEAM * U), -1, 1)
    X = polynomial(SURGE_TERMS, p.X, factors) - ahead * p.resistance
    Y = polynomial(SWAY_TERMS, p.Y, factors)
    N = polynomial(SWAY_TERMS, p.N, factors)
    pressure = p.water_density / 2 * p.length * p.draught * U**2
    return pressure * ca.vertcat(X, Y, p.length * N)


def propeller_load(flow: Flow, order: Any, p: SimpleNamespace) -> tuple[Screw, Any]:
    """Return what the propeller does, and its load X, Y, N on the ship."""
    share = held(order, -1, 1)
    ahead, astern = ca.vertsplit(p.propeller_speed)
    rate = share * ca.if_else(share > 0, ahead, astern)
    beta = flow.drift - p.propeller_position * flow.r * p.length / flow.hull_speed
    most = ca.if_else(beta > 0, p.wake_change[0], p.wake_change[1])
    changed = 1 + (1 - ca.exp(-p.wake_change_rate * ca.fabs(beta))) * (most - 1)
    advance = (1 - p.propeller_wake) * changed * flow.u
    thrust, torque = _characteristics(rate / math.tau, advance, p)
    across = p.propeller_side_force * ca.if_else(rate < 0, ca.fmin(thrust, 0), 0)
    along = (1 - p.propeller_deduction) * thrust
    load = ca.vertcat(along, across, p.propeller_position * p.length * across)
    return Screw(rate, thrust, torque, advance), load


def _characteristics(n: Any, advance: Any, p: SimpleNamespace) -> tuple[Any, Any]:
    """Return thrust, N, and moment, N.m, at ``n``, 1/s, and the ``advance``, m/s."""
    D, density = p.propeller_diameter, p.water_density
    if p.propeller_curves == "four-quadrant":
        thrust, torque = all_quadrants(
            D, density, n, advance, wageningen_b4_70(), p.propeller_series_turn
        )
        return p.propeller_series_share[0] * thrust, p.propeller_series_share[1] * torque
    slot = SimpleNamespace(diameter=D, advance_limit=p.propeller_advance_limit)
    curves = ca.vertsplit(p.propeller_K_T), ca.vertsplit(p.propeller_K_Q)
    return open_water(slot, density, n, advance, curves)


def rudder_load(
    flow: Flow, screw: Screw, delta: Any, p: SimpleNamespace
) -> tuple[Any, dict[str, Any]]:
    """Return X_R, Y_R and N_R, and the outputs of the rudder at ``delta``, to starboard."""
    slot = SimpleNamespace(
        area=p.rudder_area,
        covered=p.propeller_diameter / p.rudder_height,
        race_gain=p.rudder_race_gain,
        straightening=p.rudder_straightening,
        deduction=p.rudder_deduction,
    )
    loading = screw.thrust / p.propeller_diameter**2
    u = p.rudder_wake_ratio * in_race(slot, p.water_density, screw.advance, loading)
    to_port = flow.speed * flow.drift - p.rudder_flow_position * p.length * flow.r
    v = straightened(slot, to_port)
    force = blade(slot, p.water_density, p.rudder_lift_slope, delta, (u, v))
    at = p.rudder_position + p.rudder_hull_share * p.rudder_hull_position
    load = -ca.vertcat(
        force.aft, (1 + p.rudder_hull_share) * force.across, at * p.length * force.across
    )
    return load, {"rudder_inflow": ca.vertcat(u, v), "rudder_force": force.normal}
