"""A remotely operated underwater vehicle on its tether."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ...model.component import Component, Input, Parameter, Terminal
from ...model.plant import State
from ...model.ports import Output
from ...model.terminals import MOTION
from ..thrusters import OfEach, effect
from .six_dof import LOADS, SixDofCraft, six_dof_motion
from .terms.context import Context, smooth_step, wrench
from .terms.hydrodynamics import TERMS, read_terms

COUNT = 8
"""Most propellers that a hull has."""
_AXES = tuple(f"t{number}" for number in range(1, COUNT + 1))
_SMALL = 1e-8
"""Of the squared share of thrust at rest, below which its root is smoothed."""


class Propellers(Component):
    """Mix-in: up to 8 propellers at the hull, which get their thrust at rest as ``thrust``.

    Propeller k is at ``propeller_position_k``, m, and pushes along ``propeller_direction_k``, a
    unit vector, both in body axes; a direction of 0 is no propeller. ``bollard_thrust`` T0 is its
    full thrust at rest, ``advance_loss`` kappa the share of it that is lost per speed of advance,
    ``propeller_radius`` R, and ``ring_drag`` c the drag across of the ring round it.
    """

    propeller_position = OfEach("m", "position from the body origin", COUNT)
    propeller_direction = OfEach(
        "1", "direction of the positive thrust, a unit vector, or 0", COUNT
    )
    bollard_thrust = Parameter(1.0, "N", "full thrust at rest", axes=_AXES, min=1e-9)
    advance_loss = Parameter(0.0, "s/m", "share lost per speed of advance", axes=_AXES, min=0.0)
    propeller_radius = Parameter(0.05, "m", "radius of the propeller", axes=_AXES, min=1e-6)
    ring_drag = Parameter(0.0, "N.s2/m2", "drag across of its ring", axes=_AXES, min=0.0)

    thrust = Input("N", "thrust of each propeller as at rest", axes=_AXES, optional=True)


def propellers(c: Context) -> Any:
    """F = B (T - g kappa T0 sqrt(|T| / T0) u_a) e, and the drag of the rings; g = sgn T.

    u_a is g e . v, the speed of advance, held in -1 m/s to 1 / kappa: the bilinear form
    T_nn n |n| - T_n|n| |n| u_a (Fossen). At T = 0 the root is smoothed within 1e-4 T0. Of a hull
    that floats, B = S((d / R + 1/2) / 1.8) with d the depth of the propeller: all from 1.3 R down,
    nothing from R/2 above the surface (shape after Minsaas, Faltinsen and Persson, 1983).

    A ring at the trailing end drags as the hull goes ahead: f = -s c max(u, 0) (0, v_y, v_z), with
    s = S(1/2 + d / (2.2 R)). Astern the rings lead, and their wake passes over the hull: nothing.
    """
    p, load = c.parameters, ca.DM.zeros(6)
    ahead = ca.fmax(c.nu_r[0], 0)
    places, directions = Propellers.propeller_position.of(p), Propellers.propeller_direction.of(p)
    for k, (place, direction) in enumerate(zip(places, directions, strict=True)):
        v, radius = c.at(place), p.propeller_radius[k]
        pushed = _thrust(c, k, direction.T @ v) * direction
        dragged = p.ring_drag[k] * ahead * ca.vertcat(0, v[1:])
        if c.is_floating:
            depth = c.depth(place) / radius
            pushed *= smooth_step((depth + 0.5) / 1.8)
            dragged *= smooth_step(0.5 + depth / 2.2)
        load += wrench(pushed - dragged, place)
    return load


def _thrust(c: Context, k: int, along: Any) -> Any:
    """Return the thrust of a propeller whose speed through the water is ``along`` its axis, N."""
    p = c.parameters
    T, full, kappa = c.inputs.thrust[k], p.bollard_thrust[k], p.advance_loss[k]
    share = T / full
    root = share / ca.sqrt(ca.sqrt(share**2 + _SMALL))
    advance = ca.fmin(ca.fmax(ca.sign(T) * along, -1), 1 / kappa)
    return T - kappa * full * root * advance


_NED = ("north", "east", "down")
_EULER = ("phi", "theta", "psi")
_UVW = ("u", "v", "w")
_PQR = ("p", "q", "r")


_TERMS = {**TERMS, "propellers": propellers}


class Rov(Propellers, SixDofCraft):
    """Underwater vehicle: `SixDofCraft` with eta that counts turns, and a current that may change.

    [Paulino2015], eqs 3.8 to 3.45, in the corrected form that docs/kits/videoray/videoray.md lists.
    eta = (x, y, z, phi, theta, psi): body origin in {n} (x north, y east, z down), m, and Euler
    angles ZYX, rad; nu = (u, v, w, p, q, r): velocity of the body origin over ground, m/s, and
    angular rate, rad/s, in {b} (x bow, y starboard, z down). eta' = blkdiag(J1, J2) nu.
    Singular at theta = +-90 degrees.

    **Water.** ``current`` and its ``current_acceleration``, uniform in {n}; that the latter
    carries the vehicle as it does the water is so for rho V = m with even density (3.34).

    **Terms** (`hydrodynamics`), and ``propellers``; restoring is "submerged" or "floating", with
    B = density gravity volume. Roll and pitch are stable if the centre of buoyancy is above the
    CG (z_B < z_G). Propulsion acts by the thrusts of ``propellers`` or by terms of force and
    moment, the tether by ``attachment_force``.

    ``attitude`` has phi and psi in (-pi, pi]; in eta they count turns, so that they do not
    jump.

    Not modelled: the bottom, what the tether does beyond its force; of a "submerged" vehicle the
    surface; without ``hull-lift`` and ``point-drag`` the wake, which lets the Munk moment turn the
    vehicle from 0.06 m/s on.

    Raises InputError at the start for a propeller's direction that is neither zero nor of
    length 1 within 1e-6.
    """

    exercised: ClassVar = {
        "terms": " ".join(_TERMS),
        "restoring": "floating",
        "propeller_direction_1": [1, 0, 0],
    }

    terms = Parameter(
        "restoring coriolis damping",
        "1",
        "terms, by the names of seatrial.physics.craft.terms.hydrodynamics, with spaces",
        check=partial(read_terms, known=_TERMS),
    )
    restoring = Parameter(
        "submerged", "1", "form of the restoring forces", choices=("submerged", "floating")
    )
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

    terminals: ClassVar = {
        **SixDofCraft.terminals,
        "motion": MOTION,
        "thrusts": Terminal({axis: f"thrust.{axis}" for axis in Propellers.thrust.axes}),
    }
    feedthrough: ClassVar = {
        **SixDofCraft.feedthrough,
        **dict.fromkeys(("position", "attitude", "velocity", "rates"), ()),
        "acceleration": (*LOADS, "thrust", "current", "current_acceleration"),
    }

    def start(self, t: float) -> None:
        """Start; raises InputError as the class says and as `SixDofCraft` does."""
        directions = zip(self.propeller_position, self.propeller_direction, strict=True)
        for number, (position, direction) in enumerate(directions, 1):
            if any(direction):
                effect(self.name, f"propeller_direction_{number}", position, direction)
        super().start(t)

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion and that of the attachment."""
        euler = x.eta[3:]
        buoyancy = p.density * p.gravity * p.volume
        p = SimpleNamespace(**vars(p), buoyancy=buoyancy)
        changes, outputs = six_dof_motion(
            x.eta[:3], euler, x.nu, u, p, u.current_acceleration, _TERMS
        )
        derivatives = {
            "eta": ca.vertcat(changes.position, changes.attitude),
            "nu": ca.vertcat(changes.velocity, changes.rates),
        }
        return derivatives, {
            **outputs,
            "position": x.eta[:3],
            "attitude": ca.vertcat(_wrapped(euler[0]), euler[1], _wrapped(euler[2])),
            "velocity": x.nu[:3],
            "rates": x.nu[3:],
        }


def _wrapped(angle: Any) -> Any:
    """Return ``angle`` in (-pi, pi]."""
    return angle - math.tau * ca.ceil((angle - math.pi) / math.tau)
