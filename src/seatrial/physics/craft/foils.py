"""Forces of a foil in a flow, as CasADi expressions."""

from __future__ import annotations

from typing import Any

import casadi as ca

from ..foils import STEP, FoilTable

_STILL = 1e-20  # m/s: keeps the derivatives finite where there is no flow


def foil_load(
    table: FoilTable, place: Any, flow: Any, angle: Any, half_density_area: Any, flap: Any = 0.0
) -> Any:
    """Return the load (X, Y, K, N) of a foil whose axis is vertical in body axes, N and N.m.

    One law for sail, keel and rudder: [Silva2018], eqs 2.15, 2.16, 2.20, 2.21, 2.25, 2.28 and
    2.29, and 2.24 with the sign that 3.5 gives it. With flow (a, b) in body axes, beta =
    atan2(b, a) the direction it goes to and the angle delta:

        alpha = beta - delta + pi, in (-pi, pi]
        (X, Y) = 0.5 density area V^2 (C_D (cos beta, sin beta) + C_L (-sin beta, cos beta))
        K = -z Y,  N = x Y - y X

    ``place`` (x, y, z) is the centre of effort, m; ``angle`` turns the trailing edge from aft
    to port, rad. For keel and rudder the source measures alpha the other way round and lift to
    the other side, which is the same as C_L is odd.
    """
    a, b = ca.vertsplit(flow)
    c, s = ca.cos(angle), ca.sin(angle)
    alpha = ca.atan2(a * s - b * c, _STILL - (a * c + b * s))
    c_l, c_d = coefficients(table, alpha, flap)
    scale = half_density_area * ca.sqrt(a * a + b * b + _STILL**2)
    X, Y = scale * (c_d * a - c_l * b), scale * (c_d * b + c_l * a)
    x, y, z = ca.vertsplit(place)
    return ca.vertcat(X, Y, -z * Y, x * Y - y * X)


def flow_at(place: Any, fluid: Any, nu: Any) -> Any:
    """Return the flow (a, b) at ``place`` of the boat, body axes, m/s: [Silva2018], eq. 2.17.

    ``fluid`` is the velocity of air or water over ground in body axes, nu = (u, v, p, r).
    """
    x, y, z = ca.vertsplit(place)
    u, v, p, r = ca.vertsplit(nu)
    return fluid - ca.vertcat(u - r * y, v + r * x - p * z)


def coefficients(table: FoilTable, alpha: Any, flap: Any) -> tuple[Any, Any]:
    """Return (C_L, C_D) as `FoilTable.coefficients` does, ``alpha`` in [-pi, pi], rad.

    Derivatives at a row of the table are the mean of those on its sides: at alpha = 0, where a
    foil of a boat on a straight course is, the slope of the lift and no slope of the drag.
    """
    flaps = _flap_shares(flap, len(table.lift))
    lift, drag = (ca.vertsplit((flaps.T @ ca.DM(rows)).T) for rows in (table.lift, table.drag))
    rows = alpha / STEP
    first = ca.fmin(ca.fmax(rows, -1.0), 1.0)
    others = [_ramp(ca.fabs(rows) - row) for row in range(1, len(lift) - 1)]
    port = alpha < 0.0
    even, odd = (
        c[0] + sum((c[k + 2] - c[k + 1]) * ramp for k, ramp in enumerate(others))
        for c in (drag, lift)
    )
    return (
        ca.if_else(port, -odd, odd) + (lift[1] - lift[0]) * first,
        even + (drag[1] - drag[0]) * ca.fabs(first),
    )


def _flap_shares(flap: Any, count: int) -> Any:
    """Return the share of each of ``count`` rows of flap: at most two are not 0."""
    rows = ca.if_else(flap < 0.0, 0.0, flap / STEP)
    ramps = [1.0, *(_ramp(rows - row) for row in range(count - 1)), 0.0]
    return ca.vertcat(*(ramps[row] - ramps[row + 1] for row in range(count)))


def _ramp(x: Any) -> Any:
    """Return ``x`` between 0 and 1."""
    return ca.fmin(ca.fmax(x, 0.0), 1.0)
