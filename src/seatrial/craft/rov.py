"""A remotely operated underwater vehicle on its tether."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ..component import Input, Parameter
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

_NED = ("north", "east", "down")
_EULER = ("phi", "theta", "psi")
_UVW = ("u", "v", "w")
_PQR = ("p", "q", "r")


class Rov(SixDofCraft):
    """Submerged vehicle: M nu_r' + C(nu_r) nu_r + F_D(nu_r) + G(eta) = tau.

    Source 000, eqs 3.8 to 3.45, in the corrected form that docs/vehicles/videoray.md lists.
    eta = (x, y, z, phi, theta, psi): body origin in {n} (x north, y east, z down), m, and Euler
    angles ZYX, rad; nu = (u, v, w, p, q, r): velocity of the body origin over ground, m/s, and
    angular rate, rad/s, in {b} (x bow, y starboard, z down). eta' = blkdiag(J1, J2) nu.
    Singular at theta = +-90 degrees.

    **Water.** nu_r = nu - (J1^T v_c, 0) with v_c the ``current``, uniform. In body axes the
    velocity of the water turns, so that

        nu' = nu_r' + (-nu2 x (J1^T v_c) + J1^T v_c', 0)

    which is exact for a steady current: the vehicle moves in it as in still water, carried
    along. v_c' is ``current_acceleration``; with it the water's pressure gradient is taken to
    carry the vehicle as it does the water, which is so for rho V = m with even density (3.34).

    **Inertia and damping** as in `SixDofCraft`; F_D = D1 nu_r + D2 |nu_r| nu_r, axis by axis
    (3.38).

    **Restoring.** W = mass gravity at the CG, B = density gravity volume at the centre of
    buoyancy; with f = J1^T (0, 0, 1), G = -((W - B) f, r_G x W f - r_B x B f) (3.25 to 3.28).
    Roll and pitch are stable if the centre of buoyancy is above the CG (z_B < z_G).

    **Loads**, tau, as in `SixDofCraft`: propulsion by terms of force and moment, the tether by
    ``attachment_force``.

    ``attitude`` has phi and psi in (-pi, pi]; in eta they count turns, so that they do not
    jump.

    Not modelled: the surface (a vehicle that comes above z = 0 keeps all of its buoyancy),
    waves, bottom, lift, damping that couples axes, what the tether does beyond its force.
    """

    density = Parameter(1000.0, "kg/m3", "density of the water", min=0.0)
    volume = Parameter(0.001, "m3", "volume of the displaced water", min=0.0)
    center_of_buoyancy = Parameter(
        0.0, "m", "centre of buoyancy from the body origin, body axes", axes="xyz"
    )

    current_acceleration = Input(
        "m/s2", "acceleration of the water, uniform, {n}", axes=_NED, optional=True
    )

    eta = State(
        ("m", "m", "m", "rad", "rad", "rad"),
        "body origin in {n}; Euler angles, ZYX, turns counted",
        axes=("x", "y", "z", *_EULER),
    )
    nu = State(
        ("m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"),
        "velocity of the body origin over ground and angular velocity, body axes",
        axes=(*_UVW, *_PQR),
    )
    position = Output("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Output("rad", "Euler angles, ZYX; phi and psi in (-pi, pi]", axes=_EULER)
    velocity = Output("m/s", "velocity of the body origin over ground, body axes", axes=_UVW)
    rates = Output("rad/s", "angular velocity, body axes", axes=_PQR)
    acceleration = Output(
        "m/s2",
        "inertial acceleration of the body origin, dv/dt + omega x v, body axes",
        axes="xyz",
        frame="b",
    )

    terminals: ClassVar = {**SixDofCraft.terminals, "motion": MOTION}
    feedthrough: ClassVar = {"acceleration": (*LOADS, "current", "current_acceleration")}

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion and that of the attachment."""
        euler, velocity, rates = x.eta[3:], x.nu[:3], x.nu[3:]
        R = rotation_matrix(euler)
        relative = velocity - R.T @ u.current
        nu_r_dot = _relative_acceleration(R, ca.vertcat(relative, rates), u, p)
        # dv/dt + omega x v, with d(R^T v_c)/dt = R^T v_c' - omega x (R^T v_c).
        acceleration = nu_r_dot[:3] + ca.cross(rates, relative) + R.T @ u.current_acceleration
        derivatives = {
            "eta": ca.vertcat(R @ velocity, euler_rate_matrix(euler) @ rates),
            "nu": ca.vertcat(acceleration - ca.cross(rates, velocity), nu_r_dot[3:]),
        }
        return derivatives, {
            **attachment_motion(R, x.eta[:3], velocity, rates, p),
            "position": x.eta[:3],
            "attitude": ca.vertcat(_wrapped(euler[0]), euler[1], _wrapped(euler[2])),
            "velocity": velocity,
            "rates": rates,
            "acceleration": acceleration,
        }


def _relative_acceleration(R: Any, nu_r: Any, u: SimpleNamespace, p: SimpleNamespace) -> Any:
    """Return nu_r' (6,) under all loads, weight and buoyancy; R = J1."""
    W, B = p.mass * p.gravity, p.density * p.gravity * p.volume
    M = mass_matrix(p)
    tau = external_load(R, u, p) + submerged_restoring(W, B, R[2, :].T, p)
    return relative_acceleration(M, M @ nu_r, nu_r, tau, p)


def _wrapped(angle: Any) -> Any:
    """Return ``angle`` in (-pi, pi]."""
    return angle - math.tau * ca.ceil((angle - math.pi) / math.tau)
