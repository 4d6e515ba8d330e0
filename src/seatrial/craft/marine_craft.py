"""A surface or submerged craft in six degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ..component import Parameter
from ..plant import State
from ..ports import Output
from ..terminals import MOTION
from .six_dof import (
    LOADS,
    SixDofCraft,
    attachment_motion,
    external_load,
    mass_matrix,
    relative_acceleration,
    submerged_restoring,
)
from .symbolic import euler_rate_matrix, rotation_matrix


class MarineCraft(SixDofCraft):
    """Rigid craft in water: M nu_r' + C(nu_r) nu_r + D(nu_r) nu_r + g(eta) = tau.

    eta = (position, attitude): the body origin in north-east-down, m, and the Euler angles,
    rad; nu = (u, v, w, p, q, r): velocity of the body origin over ground and angular rate, in
    body axes (x bow, y starboard, z down); eta' = J(eta) nu. Source 004, eqs 10, 11 and 36.
    Singular at theta = +-90 degrees.

    **Current.** nu_r = nu - (R^T current, 0). The water moves steadily and uniformly in {n}, so
    that in body axes its velocity turns: d(R^T current)/dt = -omega x (R^T current).

    **Inertia and damping** as in `SixDofCraft`: D nu = (linear + quadratic |nu_r|) nu_r, axis by
    axis (source 004, eq. 49).

    **Coriolis** from the momentum h = (h1, h2): C nu = (omega x h1, omega x h2 + v x h1).
    ``coriolis`` = "full": h = M nu_r, which conserves momentum. "diagonal": h = diag(M) nu_r,
    the form of source 004, eq. 56, which loses the coupling terms of M.

    **Restoring**, with W = mass gravity, k = density gravity waterplane_area, z the sinkage
    from the floating equilibrium, n = R^T (0, 0, 1) the vertical in body axes; right-hand side:

    - "surface-linear": Z = -k z, K = -W GM_T sin(phi), M = -W GM_L sin(theta), in body axes
      (source 004, eqs 26 and 41, with the heave stiffness that eq. 41 omits).
    - "surface-conservative": force -k z n, moment n x (W GM_L n1, W GM_T n2, 0). Its potential
      is k z^2 / 2 + W (GM_L n1^2 + GM_T n2^2) / 2; it agrees with the former to first order
      and has no moment about the vertical.
    - "submerged": weight W n at the CG, buoyancy -B n at the centre of buoyancy (Fossen).

    In both surface forms the moment is a couple and the force acts at the body origin.

    **Loads**, tau, as in `SixDofCraft`: terms of force and moment, and a tether or tow.
    """

    max_step = Parameter(
        0.01,
        "s",
        "longest integration sub-step; from 0.02 on a small craft's pitch damping diverges",
        min=1e-6,
        max=0.01,
    )
    coriolis = Parameter(
        "full", "1", "momentum in the Coriolis terms", choices=("full", "diagonal")
    )
    restoring = Parameter(
        "surface-conservative",
        "1",
        "form of the restoring forces",
        choices=("surface-linear", "surface-conservative", "submerged"),
    )
    density = Parameter(1025.0, "kg/m3", "density of the water", min=0.0)
    waterplane_area = Parameter(0.0, "m2", "waterplane area (surface)", min=0.0)
    GM_T = Parameter(0.0, "m", "transverse metacentric height (surface)")
    GM_L = Parameter(0.0, "m", "longitudinal metacentric height (surface)")
    buoyancy = Parameter(9.81, "N", "buoyancy force (submerged)", min=0.0)
    center_of_buoyancy = Parameter(
        0.0, "m", "centre of buoyancy from the body origin, body axes (submerged)", axes="xyz"
    )

    position = State("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = State("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    velocity = State(
        "m/s", "velocity of the body origin over ground, body axes", axes=("u", "v", "w")
    )
    rates = State("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    acceleration = Output(
        "m/s2",
        "inertial acceleration of the body origin, dv/dt + omega x v, body axes",
        axes="xyz",
        frame="b",
    )

    terminals: ClassVar = {**SixDofCraft.terminals, "motion": MOTION}
    feedthrough: ClassVar = {"acceleration": (*LOADS, "current")}

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the acceleration and the attachment's motion."""
        R = rotation_matrix(x.attitude)
        relative = x.velocity - R.T @ u.current
        nu_r = ca.vertcat(relative, x.rates)
        M = mass_matrix(p)
        tau = external_load(R, u, p)
        h = M @ nu_r if p.coriolis == "full" else ca.diag(M) * nu_r
        vertical = R[2, :].T
        nu_r_dot = relative_acceleration(M, h, nu_r, tau + _restoring(x, vertical, p), p)
        # d(R^T current)/dt = -omega x (R^T current): what is left of dv/dt + omega x v.
        acceleration = nu_r_dot[:3] + ca.cross(x.rates, relative)
        derivatives = {
            "position": R @ x.velocity,
            "attitude": euler_rate_matrix(x.attitude) @ x.rates,
            "velocity": acceleration - ca.cross(x.rates, x.velocity),
            "rates": nu_r_dot[3:],
        }
        attached = attachment_motion(R, x.position, x.velocity, x.rates, p)
        return derivatives, {**attached, "acceleration": acceleration}


def _restoring(x: SimpleNamespace, n: Any, p: SimpleNamespace) -> Any:
    """Return the restoring force and moment (right-hand side), ``n`` the vertical in {b}."""
    W = p.mass * p.gravity
    if p.restoring == "submerged":
        return submerged_restoring(W, p.buoyancy, n, p)
    heave = -p.density * p.gravity * p.waterplane_area * x.position[2]
    if p.restoring == "surface-linear":
        phi, theta = x.attitude[0], x.attitude[1]
        moment = ca.vertcat(-W * p.GM_T * ca.sin(phi), -W * p.GM_L * ca.sin(theta), 0)
        return ca.vertcat(0, 0, heave, moment)
    return ca.vertcat(heave * n, ca.cross(n, ca.vertcat(W * p.GM_L * n[0], W * p.GM_T * n[1], 0)))
