"""A ship that thrusters move in the horizontal plane."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from seatrial.model.component import Parameter
from seatrial.model.expressions import Vector
from seatrial.physics.craft.inertia import require_positive_definite
from seatrial.physics.craft.planar import (
    LOADS,
    LoadedCraft,
    attachment,
    carried,
    kinematics,
    motion_outputs,
    planar_coriolis,
    sea_load,
    water_outputs,
)
from seatrial.physics.craft.wave_hull import HullCoefficients
from seatrial.physics.sea.numbers import WATER_DENSITY

_INERTIAS = ("mass", "inertia", "center_of_gravity", "X_udot", "Y_vdot", "Y_rdot", "N_rdot")


class ThrusterShip(LoadedCraft):
    """Ship in surge, sway and yaw under thrusters: M nu' + C(nu) nu = tau, eta' = R(psi) nu.

    [ShipScript]. eta = (x, y, psi): body origin in {n} (x north, y east), m, and heading,
    clockwise from north, rad; nu = (u, v, r): velocity of the origin over ground, m/s, and rate
    of yaw, rad/s, in {b} (x bow, y starboard, z down). With A1 = m - X_udot, A2 = m - Y_vdot,
    A6 = I_zz - N_rdot and c = m x_G - Y_rdot:

        A1 u' - A2 v r - c r^2                        = X
        A2 v' + c r' + A1 u r                         = Y
        A6 r' + c (v' + u r) + (A2 - A1) u v          = N

    M is symmetric and C comes from the momentum (A1 u, A2 v + c r), so that the work of tau is
    the kinetic energy. ``center_of_gravity`` is a constant of the ship; the source writes it
    with the letter of the position, which would make the inertia depend on where the ship is.

    ``model`` = "linear" is the exact linearisation of all this about rest at the origin with
    psi = 0, from the same expressions: eta' = nu, M nu' = tau.

    ``drag`` (X_uu, Y_vv, N_rr) is that of the hull, axis by axis, on the right-hand side; the
    source has none, and of the linear model it is 0:

        -(X_uu |u| u, Y_vv |v| v, N_rr |r| r)

    tau = (X, Y, N): sums of the terms of ``force`` and ``moment``, N and N.m about the body
    origin, in body axes: thrusters, an environmental load; and what a tether or tow does.

    In the sea of a trial nu in M nu' + C(nu) nu and the drag is that through the water, and the
    loads of waves and wind are added to tau.

    Not modelled: damping at low speed, drag that axes share, thrusters that interact. Without drag
    nothing ever comes to rest by itself.
    """

    max_step = Parameter(0.1, "s", "longest integration sub-step", min=1e-6)
    model = Parameter("nonlinear", "1", "equations of motion", choices=("nonlinear", "linear"))
    mass = Parameter(1.0, "kg", "mass without added mass", min=0.0)
    inertia = Parameter(1.0, "kg.m2", "inertia in yaw about the body origin", min=0.0)
    center_of_gravity = Parameter(0.0, "m", "CG ahead of the body origin")
    X_udot = Parameter(0.0, "kg", "added mass in surge, negative")
    Y_vdot = Parameter(0.0, "kg", "added mass in sway, negative")
    Y_rdot = Parameter(0.0, "kg.m", "added mass, sway from yaw and yaw from sway")
    N_rdot = Parameter(0.0, "kg.m2", "added inertia in yaw, negative")
    drag = Parameter(
        0.0, ("N.s2/m2", "N.s2/m2", "N.m.s2/rad2"), "quadratic drag of the hull, X_uu, Y_vv, N_rr",
        axes="uvr", min=0.0,
    )  # fmt: skip

    feedthrough: ClassVar = {**LoadedCraft.feedthrough, "acceleration": LOADS}

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError if M is not positive definite."""
        require_positive_definite(self.name, self.mass_matrix(), ", ".join(_INERTIAS))
        super().start(t)

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        return HullCoefficients(sway=(-self.Y_vdot, 0.0)), WATER_DENSITY

    def mass_matrix(self) -> Vector:
        """Return M (3, 3) about the body origin, from the parameters as they are now.

        Rows and columns u, v, r; kg, kg.m and kg.m2.
        """
        numbers = SimpleNamespace(**{name: ca.DM(getattr(self, name)) for name in _INERTIAS})
        return np.array(ca.DM(_mass_matrix(numbers)))

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion and that of the attachment."""
        M = _mass_matrix(p)
        attached, pull = attachment(x, u, p)
        tau = ca.vertcat(LoadedCraft.force.total(u), LoadedCraft.moment.total(u)) + pull
        tau = tau + sea_load(u)
        nu_r, carrying = carried(x.eta, x.nu, u)
        tau = tau - p.drag * ca.fabs(nu_r) * nu_r
        nu_dot = ca.ldl_solve(tau - planar_coriolis((M @ nu_r)[:2], nu_r), *ca.ldl(M)) + carrying
        derivatives = {"eta": kinematics(x.eta, x.nu), "nu": nu_dot}
        motion = {**motion_outputs(x.eta, x.nu, nu_dot), **attached}
        motion |= water_outputs(x.eta, nu_r, u, p)
        if p.model == "nonlinear":
            return derivatives, motion
        loads = [getattr(u, name) for name in LOADS]
        point = ca.vertcat(x.eta, x.nu, *loads)
        return _about_rest(derivatives, point), _about_rest(motion, point)


def _mass_matrix(p: SimpleNamespace) -> Any:
    """Return M from CasADi numbers or symbols: [ShipScript], left-hand sides."""
    c = p.mass * p.center_of_gravity - p.Y_rdot
    return ca.vertcat(
        ca.horzcat(p.mass - p.X_udot, 0, 0),
        ca.horzcat(0, p.mass - p.Y_vdot, c),
        ca.horzcat(0, c, p.inertia - p.N_rdot),
    )


def _about_rest(expressions: Mapping[str, Any], point: Any) -> dict[str, Any]:
    """Return the expressions to first order about ``point`` = 0."""
    return {
        name: ca.linearize(expression, point, ca.DM.zeros(point.shape))
        for name, expression in expressions.items()
    }
