"""Base of craft in six degrees of freedom: inertia, motion of the water, sum of the terms.

Frames: {n} x north, y east, z down; {b} x bow, y starboard, z down. nu = (u, v, w, p, q, r):
velocity of the body origin over ground, m/s, and angular rate, rad/s, in body axes. Loads are
forces (N) and moments about the body origin (N.m), in body axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from ...model.component import Input, Parameter, Terms, terminal
from ...model.expressions import Vector
from ...model.ports import Output
from ...model.terminals import ATTACHMENT
from ..sea.loads import Response
from .around import Places
from .inertia import require_positive_definite
from .seaway import Seaway
from .symbolic import euler_rate_matrix, rotation_matrix, skew
from .terms.context import Context, wrench
from .terms.coupled_damping import CoupledDamping
from .terms.hull_points import HullPoints, wet
from .terms.hydrodynamics import TERMS, Term, read_terms, symmetric
from .terms.morison import Morison
from .terms.slender import HullLift, Slender
from .terms.winged_body import WingedBody
from .through_water import ThroughWater, flow_outputs

_NED = ("north", "east", "down")
_TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
_UVW = ("u", "v", "w")
_PQR = ("p", "q", "r")
_STILL = ca.DM.zeros(3)
_INERTIAS = (
    "mass",
    "inertia",
    "center_of_gravity",
    "added_mass",
    "added_inertia",
    "added_coupling",
)


class SixDofCraft(
    ThroughWater, CoupledDamping, HullPoints, HullLift, Morison, Slender, WingedBody, Seaway
):
    """Base of craft in six degrees of freedom: M nu_r' = tau + the terms of `hydrodynamics`.

    nu_r is nu less the velocity of the water in body axes. ``terms`` names the terms that act;
    their equations, sources and limits stand with each (`hydrodynamics`), their coefficients
    are parameters here. The subclass declares its states and outputs, forms its equations by
    `six_dof_motion` and adds the terminal ``motion`` to ``terminals``.

    **Inertia.** M = M_RB + M_A about the body origin, M_A = [[A, B], [B^T, J]] with positive
    entries for water that adds inertia (A_xx = -X_u', B_zq = -Z_q'). All inertia is in M: the
    water must not give back acceleration forces through an input.

    **Loads.** ``force`` and ``moment`` are sums of their terms, in body axes: forces act at the
    body origin, moments about it. A tether or a tow pulls with ``attachment_force`` f, {n}, at
    ``attachment_place`` r, body axes: (R^T f, r x R^T f). ``attachment_point`` and
    ``attachment_velocity`` are the place of that point, x + R r, and its velocity over ground,
    R (v + omega x r), both in {n}.

    **Sea.** The waves and the current of a trial (`seaway`). A craft that is submerged or floats
    by "floating" moves in water that moves: with its velocity and acceleration at the body
    origin, the elevation above it, and rho V times the acceleration of the water at the centre
    of buoyancy (Froude and Krylov).
    """

    places: ClassVar = Places(x=0, y=1, z=2, psi=5, u=6, v=7)

    terms = Parameter(
        "restoring coriolis damping",
        "1",
        "terms, by the names of seatrial.physics.craft.terms.hydrodynamics, with spaces",
        check=read_terms,
    )
    coriolis = Parameter(
        "full",
        "1",
        "momentum in the Coriolis terms",
        choices=("full", "diagonal", "without-munk", "without-cross-pairs"),
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
    crossflow_length = Parameter(
        0.0, "m", "length of the hull in crossflow-drag, station-drag", min=0.0
    )
    crossflow_draught = Parameter(
        0.0, "m", "draught of the hull in crossflow-drag, station-drag", min=0.0
    )
    crossflow_coefficient = Parameter(
        0.0, "1", "drag coefficient in crossflow-drag, station-drag", min=0.0
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
        **ThroughWater.water_terminals,
    }
    feedthrough: ClassVar = {
        **dict.fromkeys(("attachment_point", "attachment_velocity"), ()),
        **dict.fromkeys(("nu_r", "flow"), ("current",)),
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError if M is not positive definite."""
        require_positive_definite(
            self.name,
            self.mass_matrix(),
            "mass, inertia, added_mass, added_inertia, added_coupling",
        )
        super().start(t)

    def wave_response(self) -> Response | None:
        """Return None: the water that moves is what such a craft meets of waves."""
        return None

    def mass_matrix(self) -> Vector:
        """Return M (6, 6) about the body origin, from the parameters as they are now.

        Rows and columns u, v, w, p, q, r; blocks in kg, kg.m and kg.m2.
        """
        numbers = {name: ca.DM(getattr(self, name)) for name in _INERTIAS}
        return np.array(mass_matrix(SimpleNamespace(**numbers)))


LOADS = (*SixDofCraft.force.names, *SixDofCraft.moment.names, "attachment_force")
"""Inputs of the loads from outside."""


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


def velocity_through_water(R: Any, nu: Any, u: SimpleNamespace) -> Any:
    """Return nu_r (6,): ``nu`` less the velocity of current and waves; ``R`` body to {n}."""
    water = u.current + getattr(u, "water_velocity", _STILL)
    return ca.vertcat(nu[:3] - R.T @ water, nu[3:])


def mass_matrix(p: SimpleNamespace) -> Any:
    """Return M_RB + M_A (6, 6) about the body origin (Fossen), from CasADi numbers or symbols."""
    xx, yy, zz, xy, xz, yz = ca.vertsplit(p.inertia)
    S = skew(p.center_of_gravity)
    about_origin = symmetric(ca.vertcat(xx, yy, zz, -xy, -xz, -yz)) - p.mass * S @ S
    coupling = ca.reshape(p.added_coupling, 3, 3).T - p.mass * S
    force = p.mass * ca.DM.eye(3) + symmetric(p.added_mass)
    moment = about_origin + symmetric(p.added_inertia)
    return ca.vertcat(ca.horzcat(force, coupling), ca.horzcat(coupling.T, moment))


def craft_context(
    position: Any, attitude: Any, nu: Any, u: SimpleNamespace, p: SimpleNamespace
) -> Context:
    """Return what terms and parts are functions of; arguments as of `six_dof_motion`."""
    R = rotation_matrix(attitude)
    nu_r = velocity_through_water(R, nu, u)
    return Context(position, attitude, R, nu, nu_r, mass_matrix(p), u, p)


def six_dof_motion(
    position: Any,
    attitude: Any,
    nu: Any,
    u: SimpleNamespace,
    p: SimpleNamespace,
    water_acceleration: Any = _STILL,
    known: Mapping[str, Term] = TERMS,
    parts: Any = None,
) -> tuple[SimpleNamespace, dict[str, Any]]:
    """Return the rates of change of the states, and the outputs that follow from the motion.

    ``position`` is the body origin in {n}, m, ``attitude`` the Euler angles, rad, ``nu`` as
    above; ``water_acceleration`` is that of the current v_c in {n}, m/s2; ``known`` are the terms
    that the craft may name, ``parts`` the load (6,) of parts of its own. The rates are named
    ``position``, ``attitude``, ``velocity`` and ``rates``.

    With nu_r = nu - (R^T v_c, 0), uniform, d(R^T v_c)/dt = R^T v_c' - omega x (R^T v_c), so
    that dv/dt + omega x v = dv_r/dt + omega x v_r + R^T v_c'. With v_c' the water's pressure
    gradient is taken to carry the craft as it does the water.

    At sea v_c has the velocity of waves and current too. As the craft meets it, that of the
    current changes with the craft's depth, v_c' = a + dv_c/dz z'; the pressure gradient is of
    rho V a alone, a the acceleration of the water where it is (see `_pressure_gradient`).
    """
    context = craft_context(position, attitude, nu, u, p)
    R, velocity, rates = context.R, nu[:3], nu[3:]
    at_sea = hasattr(u, "water_velocity")
    met = _STILL
    if at_sea:
        met = u.water_acceleration + ca.vertcat(u.water_shear * (R @ velocity)[2], 0)
        water_acceleration = water_acceleration + met
    tau = external_load(R, u, p)
    for term in read_terms(p.terms, known):
        tau = tau + term(context)
    if parts is not None:
        tau = tau + parts
    if at_sea and not p.restoring.startswith("surface"):
        tau = tau + _pressure_gradient(context, R.T @ met, R.T @ u.water_acceleration)
    nu_r_dot = ca.ldl_solve(tau, *ca.ldl(context.M))
    acceleration = nu_r_dot[:3] + ca.cross(rates, context.nu_r[:3]) + R.T @ water_acceleration
    changes = SimpleNamespace(
        position=R @ velocity,
        attitude=euler_rate_matrix(attitude) @ rates,
        velocity=acceleration - ca.cross(rates, velocity),
        rates=nu_r_dot[3:],
    )
    attached = attachment_motion(R, position, velocity, rates, p)
    return changes, {
        **attached,
        **flow_outputs(R, context.nu_r, u, p),
        "acceleration": acceleration,
    }


def _pressure_gradient(c: Context, met: Any, acceleration: Any) -> Any:
    """Return rho V a at the centre of buoyancy, less m v_c' at the CG, which `M nu_r'` lacks.

    ``met`` is v_c', ``acceleration`` a, both in {b}. They cancel for an even body that displaces
    its mass and is in no shear.
    """
    p = c.parameters
    displaced = p.buoyancy / p.gravity * (wet(c) if c.is_floating else 1)
    return wrench(displaced * acceleration, p.center_of_buoyancy) - wrench(
        p.mass * met, p.center_of_gravity
    )
