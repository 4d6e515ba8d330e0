"""Base of craft in six degrees of freedom: inertia, damping, motion of the water.

Frames: {n} x north, y east, z down; {b} x bow, y starboard, z down. nu = (u, v, w, p, q, r):
velocity of the body origin over ground, m/s, and angular rate, rad/s, in body axes. Loads are
forces (N) and moments about the body origin (N.m), in body axes.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from ..component import Input, Parameter, Terms, terminal
from ..model import Vector
from ..plant import Plant
from ..ports import Output
from ..terminals import ATTACHMENT
from .inertia import require_positive_definite
from .symbolic import skew

_NED = ("north", "east", "down")
_TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
_UVW = ("u", "v", "w")
_PQR = ("p", "q", "r")
_INERTIAS = (
    "mass",
    "inertia",
    "center_of_gravity",
    "added_mass",
    "added_inertia",
    "added_coupling",
)


class SixDofCraft(Plant):
    """Base of craft in six degrees of freedom: M nu_r' + C(nu_r) nu_r + D(nu_r) nu_r = tau.

    nu_r is nu less the velocity of the water in body axes. The subclass declares its states
    and outputs and forms its equations from `mass_matrix`, `external_load`,
    `relative_acceleration` and, if it is submerged, `submerged_restoring`; it publishes
    `attachment_motion` and adds the terminal ``motion`` to ``terminals``.

    **Inertia.** M = M_RB + M_A about the body origin, M_A = [[A, B], [B^T, J]] with positive
    entries for water that adds inertia (A_xx = -X_u', B_zq = -Z_q'). All inertia is in M: the
    water must not give back acceleration forces through an input.

    **Damping.** D nu = (linear + quadratic |nu_r|) nu_r, axis by axis, coefficients >= 0.

    **Loads.** ``force`` and ``moment`` are sums of their terms, in body axes: forces act at the
    body origin, moments about it. A tether or a tow pulls with ``attachment_force`` f, {n}, at
    ``attachment_place`` r, body axes: (R^T f, r x R^T f). ``attachment_point`` and
    ``attachment_velocity`` are the place of that point, x + R r, and its velocity over ground,
    R (v + omega x r), both in {n}.
    """

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
    attachment_place = Parameter(
        0.0, "m", "attachment of a tether or tow from the body origin, body axes", axes="xyz"
    )

    force = Terms(4, "N", "force on the craft, body axes", axes="xyz", frame="b")
    moment = Terms(
        4, "N.m", "moment on the craft about the body origin, body axes", axes="xyz", frame="b"
    )
    attachment_force = Input(
        "N", "force of a tether or tow at its attachment, {n}", axes=_NED, optional=True
    )
    current = Input("m/s", "velocity of the water, uniform, {n}", axes=_NED, optional=True)

    attachment_point = Output("m", "attachment of a tether or tow, {n}", axes=_NED)
    attachment_velocity = Output("m/s", "velocity of the attachment over ground, {n}", axes=_NED)

    terminals: ClassVar = {
        "wrench": terminal("force", "moment", rule="plug"),
        "attachment": ATTACHMENT,
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
        return np.array(mass_matrix(SimpleNamespace(**numbers)))


LOADS = (*SixDofCraft.force.names, *SixDofCraft.moment.names, "attachment_force")
"""Inputs of `external_load`."""


def external_load(R: Any, u: SimpleNamespace, p: SimpleNamespace) -> Any:
    """Return the load (6,) of the terms of force and moment, and of what is attached.

    ``R`` is the rotation body to {n}; N and N.m about the body origin, body axes.
    """
    pull = R.T @ u.attachment_force
    force, moment = SixDofCraft.force.total(u), SixDofCraft.moment.total(u)
    return ca.vertcat(force + pull, moment + ca.cross(p.attachment_place, pull))


def attachment_motion(
    R: Any, position: Any, velocity: Any, rates: Any, p: SimpleNamespace
) -> dict[str, Any]:
    """Return place (m) and velocity (m/s) of the attachment, {n}, by output.

    ``R`` is the rotation body to {n}, ``position`` the body origin in {n}, m, ``velocity``
    (m/s) and ``rates`` (rad/s) in body axes.
    """
    arm = p.attachment_place
    return {
        "attachment_point": position + R @ arm,
        "attachment_velocity": R @ (velocity + ca.cross(rates, arm)),
    }


def mass_matrix(p: SimpleNamespace) -> Any:
    """Return M_RB + M_A (6, 6) about the body origin (Fossen), from CasADi numbers or symbols."""
    xx, yy, zz, xy, xz, yz = ca.vertsplit(p.inertia)
    S = skew(p.center_of_gravity)
    about_origin = _tensor(ca.vertcat(xx, yy, zz, -xy, -xz, -yz)) - p.mass * S @ S
    coupling = ca.reshape(p.added_coupling, 3, 3).T - p.mass * S
    force = p.mass * ca.DM.eye(3) + _tensor(p.added_mass)
    moment = about_origin + _tensor(p.added_inertia)
    return ca.vertcat(ca.horzcat(force, coupling), ca.horzcat(coupling.T, moment))


def relative_acceleration(M: Any, h: Any, nu_r: Any, tau: Any, p: SimpleNamespace) -> Any:
    """Return nu_r' (6,) of a craft with mass matrix M and momentum h under the load tau (6,).

    M nu_r' = tau - C(nu_r) nu_r - D(nu_r) nu_r, with C from ``h``, D from the damping of ``p``.
    """
    linear = ca.vertcat(p.linear_damping_force, p.linear_damping_moment)
    quadratic = ca.vertcat(p.quadratic_damping_force, p.quadratic_damping_moment)
    damping = (linear + quadratic * ca.fabs(nu_r)) * nu_r
    return ca.ldl_solve(tau - coriolis(h, nu_r) - damping, *ca.ldl(M))


def coriolis(h: Any, nu: Any) -> Any:
    """Return C(nu) nu (6,) of a CasADi momentum h = (h1, h2) and velocity nu = (v, omega).

    C = [[0, -S(h1)], [-S(h1), -S(h2)]] (source 004, eq. 19; 000, eq. 3.24), that is omega x h1
    (N) and omega x h2 + v x h1 (N.m).
    """
    h1, h2, v, omega = h[:3], h[3:], nu[:3], nu[3:]
    return ca.vertcat(ca.cross(omega, h1), ca.cross(omega, h2) + ca.cross(v, h1))


def submerged_restoring(W: Any, B: Any, n: Any, p: SimpleNamespace) -> Any:
    """Return the load (6,) of the weight W at the CG and the buoyancy B at its centre, N.

    ``n`` is the vertical, downwards, in body axes: force (W - B) n, moment
    (r_G W - r_B B) x n (Fossen; source 000, eqs 3.25 to 3.28, on the right-hand side).
    """
    weight, buoyancy = W * n, -B * n
    moment = ca.cross(p.center_of_gravity, weight) + ca.cross(p.center_of_buoyancy, buoyancy)
    return ca.vertcat(weight + buoyancy, moment)


def _tensor(elements: Any) -> Any:
    xx, yy, zz, xy, xz, yz = ca.vertsplit(elements)
    return ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))
