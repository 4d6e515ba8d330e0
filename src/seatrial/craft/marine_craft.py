"""A surface or submerged craft in six degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from ..component import Input, Parameter
from ..model import Vector
from ..plant import Plant, State
from ..ports import Output
from .inertia import require_positive_definite
from .symbolic import euler_rate_matrix, rotation_matrix, skew

_TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
_EULER = ("phi", "theta", "psi")
_UVW = ("u", "v", "w")
_PQR = ("p", "q", "r")
_NED = ("north", "east", "down")


class MarineCraft(Plant):
    """Rigid craft in water: M nu_r' + C(nu_r) nu_r + D(nu_r) nu_r + g(eta) = tau.

    eta = (position, attitude): the body origin in north-east-down, m, and the Euler angles,
    rad; nu = (u, v, w, p, q, r): velocity of the body origin over ground and angular rate, in
    body axes (x bow, y starboard, z down); eta' = J(eta) nu. Source 004, eqs 10, 11 and 36.
    Singular at theta = +-90 degrees.

    **Current.** nu_r = nu - (R^T current, 0). The water moves steadily and uniformly in {n}, so
    that in body axes its velocity turns: d(R^T current)/dt = -omega x (R^T current).

    **Inertia.** M = M_RB + M_A about the body origin, M_A = [[A, B], [B^T, J]] with positive
    entries for water that adds inertia (A_xx = -X_u', B_zq = -Z_q'). All inertia is in M: the
    water must not give back acceleration forces through an input.

    **Coriolis** from the momentum h = (h1, h2): C nu = (omega x h1, omega x h2 + v x h1).
    ``coriolis`` = "full": h = M nu_r, which conserves momentum. "diagonal": h = diag(M) nu_r,
    the form of source 004, eq. 56, which loses the coupling terms of M.

    **Damping.** D nu = (linear + quadratic |nu_r|) nu_r, axis by axis, coefficients >= 0
    (source 004, eq. 49).

    **Restoring**, with W = mass gravity, k = density gravity waterplane_area, z the sinkage
    from the floating equilibrium, n = R^T (0, 0, 1) the vertical in body axes; right-hand side:

    - "surface-linear": Z = -k z, K = -W GM_T sin(phi), M = -W GM_L sin(theta), in body axes
      (source 004, eqs 26 and 41, with the heave stiffness that eq. 41 omits).
    - "surface-conservative": force -k z n, moment n x (W GM_L n1, W GM_T n2, 0). Its potential
      is k z^2 / 2 + W (GM_L n1^2 + GM_T n2^2) / 2; it agrees with the former to first order
      and has no moment about the vertical.
    - "submerged": weight W n at the CG, buoyancy -B n at the centre of buoyancy (Fossen).

    In both surface forms the moment is a couple and the force acts at the body origin.

    **Inputs.** Forces (N, body axes) act at the body origin and moments (N.m, body axes) about
    it; load, propulsion and tether add up.
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
    mass = Parameter(1.0, "kg", "mass of the craft, without added mass", min=0.0)
    inertia = Parameter(
        (1.0, 1.0, 1.0, 0.0, 0.0, 0.0),
        "kg.m2",
        "inertia about the CG; products as integrals of x y dm (minus signs are in the tensor)",
        axes=_TENSOR,
    )
    center_of_gravity = Parameter(0.0, "m", "CG from the body origin, body axes", axes="xyz")
    added_mass = Parameter(0.0, "kg", "A of M_A, as it stands in the matrix", axes=_TENSOR)
    added_inertia = Parameter(0.0, "kg.m2", "J of M_A, as it stands in the matrix", axes=_TENSOR)
    added_coupling = Parameter(
        0.0,
        "kg.m",
        "B of M_A: force along x, y, z from angular acceleration p, q, r, and the converse",
        axes=[f + m for f in "xyz" for m in _PQR],
    )
    linear_damping_force = Parameter(0.0, "N.s/m", "linear damping", axes=_UVW, min=0.0)
    linear_damping_moment = Parameter(0.0, "N.m.s/rad", "linear damping", axes=_PQR, min=0.0)
    quadratic_damping_force = Parameter(0.0, "N.s2/m2", "quadratic damping", axes=_UVW, min=0.0)
    quadratic_damping_moment = Parameter(
        0.0, "N.m.s2/rad2", "quadratic damping", axes=_PQR, min=0.0
    )
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    density = Parameter(1025.0, "kg/m3", "density of the water", min=0.0)
    waterplane_area = Parameter(0.0, "m2", "area of the water plane (surface)", min=0.0)
    GM_T = Parameter(0.0, "m", "transverse metacentric height (surface)")
    GM_L = Parameter(0.0, "m", "longitudinal metacentric height (surface)")
    buoyancy = Parameter(9.81, "N", "buoyancy force (submerged)", min=0.0)
    center_of_buoyancy = Parameter(
        0.0, "m", "centre of buoyancy from the body origin, body axes (submerged)", axes="xyz"
    )

    load_force = Input("N", "force of a load on the craft, body axes", axes="xyz")
    load_moment = Input("N.m", "moment of a load about the body origin, body axes", axes="xyz")
    propulsion_force = Input("N", "force of the propulsion, body axes", axes="xyz")
    propulsion_moment = Input(
        "N.m", "moment of the propulsion about the body origin, body axes", axes="xyz"
    )
    tether_force = Input("N", "force of a tether on the craft, body axes", axes="xyz")
    tether_moment = Input("N.m", "moment of a tether about the body origin, body axes", axes="xyz")
    current = Input("m/s", "velocity of the water, steady and uniform, {n}", axes=_NED)

    position = State("m", "body origin in north-east-down", axes="xyz")
    attitude = State("rad", "Euler angles, ZYX", axes=_EULER)
    velocity = State("m/s", "velocity of the body origin over ground, body axes", axes=_UVW)
    rates = State("rad/s", "angular velocity, body axes", axes=_PQR)
    acceleration = Output(
        "m/s2",
        "inertial acceleration of the body origin, dv/dt + omega x v, body axes",
        axes="xyz",
    )

    feedthrough: ClassVar = {
        "acceleration": (
            "load_force",
            "load_moment",
            "propulsion_force",
            "propulsion_moment",
            "tether_force",
            "tether_moment",
            "current",
        )
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError if M is not positive definite."""
        require_positive_definite(
            self.name,
            self.mass_matrix(),
            "mass, inertia, added_mass, added_inertia, added_coupling",
        )
        super().start(t)

    def mass_matrix(self) -> Vector:
        """Return M (6, 6) about the body origin, from the parameters as they are now.

        Rows and columns u, v, w, p, q, r; blocks in kg, kg.m and kg.m2.
        """
        numbers = {name: ca.DM(getattr(self, name)) for name in _INERTIAS}
        return np.array(_mass_matrix(SimpleNamespace(**numbers)))

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, and the acceleration (see the class)."""
        R = rotation_matrix(x.attitude)
        relative = x.velocity - R.T @ u.current
        nu_r = ca.vertcat(relative, x.rates)
        M = _mass_matrix(p)
        tau = (
            ca.vertcat(u.load_force, u.load_moment)
            + ca.vertcat(u.propulsion_force, u.propulsion_moment)
            + ca.vertcat(u.tether_force, u.tether_moment)
        )
        h = M @ nu_r if p.coriolis == "full" else ca.diag(M) * nu_r
        vertical = R[2, :].T
        nu_r_dot = ca.ldl_solve(
            tau - coriolis(h, nu_r) - _damping(nu_r, p) + _restoring(x, vertical, p), *ca.ldl(M)
        )
        # d(R^T current)/dt = -omega x (R^T current): what is left of dv/dt + omega x v.
        acceleration = nu_r_dot[:3] + ca.cross(x.rates, relative)
        derivatives = {
            "position": R @ x.velocity,
            "attitude": euler_rate_matrix(x.attitude) @ x.rates,
            "velocity": acceleration - ca.cross(x.rates, x.velocity),
            "rates": nu_r_dot[3:],
        }
        return derivatives, {"acceleration": acceleration}


def coriolis(h: Any, nu: Any) -> Any:
    """Return C(nu) nu (6,) of a CasADi momentum h = (h1, h2) and velocity nu = (v, omega).

    C = [[0, -S(h1)], [-S(h1), -S(h2)]] (source 004, eq. 19), that is omega x h1 (N) and
    omega x h2 + v x h1 (N.m).
    """
    h1, h2, v, omega = h[:3], h[3:], nu[:3], nu[3:]
    return ca.vertcat(ca.cross(omega, h1), ca.cross(omega, h2) + ca.cross(v, h1))


_INERTIAS = (
    "mass",
    "inertia",
    "center_of_gravity",
    "added_mass",
    "added_inertia",
    "added_coupling",
)


def _mass_matrix(p: SimpleNamespace) -> Any:
    """Return M_RB + M_A about the body origin (Fossen), from CasADi numbers or symbols."""
    xx, yy, zz, xy, xz, yz = ca.vertsplit(p.inertia)
    S = skew(p.center_of_gravity)
    about_origin = _tensor(ca.vertcat(xx, yy, zz, -xy, -xz, -yz)) - p.mass * S @ S
    coupling = ca.reshape(p.added_coupling, 3, 3).T - p.mass * S
    force = p.mass * ca.DM.eye(3) + _tensor(p.added_mass)
    moment = about_origin + _tensor(p.added_inertia)
    return ca.vertcat(ca.horzcat(force, coupling), ca.horzcat(coupling.T, moment))


def _tensor(elements: Any) -> Any:
    xx, yy, zz, xy, xz, yz = ca.vertsplit(elements)
    return ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))


def _damping(nu_r: Any, p: SimpleNamespace) -> Any:
    linear = ca.vertcat(p.linear_damping_force, p.linear_damping_moment)
    quadratic = ca.vertcat(p.quadratic_damping_force, p.quadratic_damping_moment)
    return (linear + quadratic * ca.fabs(nu_r)) * nu_r


def _restoring(x: SimpleNamespace, n: Any, p: SimpleNamespace) -> Any:
    """Return the restoring force and moment (right-hand side), ``n`` the vertical in {b}."""
    W = p.mass * p.gravity
    if p.restoring == "submerged":
        weight, buoyancy = W * n, -p.buoyancy * n
        moment = ca.cross(p.center_of_gravity, weight) + ca.cross(p.center_of_buoyancy, buoyancy)
        return ca.vertcat(weight + buoyancy, moment)
    heave = -p.density * p.gravity * p.waterplane_area * x.position[2]
    if p.restoring == "surface-linear":
        phi, theta = x.attitude[0], x.attitude[1]
        moment = ca.vertcat(-W * p.GM_T * ca.sin(phi), -W * p.GM_L * ca.sin(theta), 0)
        return ca.vertcat(0, 0, heave, moment)
    return ca.vertcat(heave * n, ca.cross(n, ca.vertcat(W * p.GM_L * n[0], W * p.GM_T * n[1], 0)))
