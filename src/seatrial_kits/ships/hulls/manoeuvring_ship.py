"""A ship at service speed that a rudder steers: manoeuvring derivatives, linear or cubic."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from seatrial.errors import InputError
from seatrial.model.component import Input, Parameter
from seatrial.model.plant import State
from seatrial.physics.craft.planar import (
    ThreeDofCraft,
    attachment,
    carried,
    kinematics,
    motion_outputs,
    sea_load,
    water_outputs,
)
from seatrial.physics.craft.wave_hull import HullCoefficients

from .polynomials import polynomial

_SURGE_TERMS = ("u", "uu", "uuu", "vv", "rr", "rv", "dd", "udd", "vd", "uvd")
_SWAY_TERMS = (
    *("v", "r", "vvv", "vvr", "vu", "ru", "d", "ddd", "ud", "uud", "vdd", "vvd"),
    *("const", "u", "uu"),
)
_INERTIAS = (
    *("mass", "inertia", "center_of_gravity"),
    *("X_udot", "Y_vdot", "Y_rdot", "N_vdot", "N_rdot"),
)


class ManoeuvringShip(ThreeDofCraft):
    """Ship under way that its rudder steers; all coefficients without dimension.

    eta = (x, y, psi): body origin (midships) in {n} (x north, y east), m, and heading, clockwise
    from north, rad, any number of turns; nu = (u, v, r): velocity over ground, m/s, and rate of
    yaw, rad/s, in {b} (x bow, y starboard, z down). eta' = R(psi) nu.

    ``rudder`` is the angle of its blade, trailing edge to port positive: a positive angle gives
    Y > 0 and N < 0 and turns the ship to port, as [Moro1979] has it.

    Lengths are made dimensionless with ``length`` L, speeds with U, times with L / U:

    - ``model`` = "linear" ([Moro1979], eqs 4 to 7): u' = 0, U = ``speed``, and with A* and B*
      from ``state_matrix`` and ``rudder_vector``

          (v', r')* = A* (v*, r*) + B* delta

      Surge is constant, and the start value of u must be ``speed``.
    - "cubic" ([Chislett1965]): U = sqrt(u^2 + v^2), u* = (u - speed) / U,
      and X, Y, N are the polynomials of u*, v*, r* and delta that their ports list, where the
      inertial terms of a turning ship are part of the coefficients Y.r, N.r, X.rr and X.rv:

          (m - X_udot) u'* = X
          (m - Y_vdot) v'* + (m x_G - Y_rdot) r'* = Y
          (m x_G - N_vdot) v'* + (I_zz - N_rdot) r'* = N

      Y.const, N.const (one propeller) turn the ship even with the rudder amidships.

    ``disturbance`` is added to v' and r', m/s2 and rad/s2: what wind or current do to the ship
    (d1 U^2 / L and d2 (U / L)^2 of dimensionless d1, d2). A tether or tow accelerates it by the
    dimensionless inertia above, times rho L^3 / 2; the linear model keeps its speed.

    In the sea of a trial u, v and r of the polynomials are those through the water; waves and
    wind accelerate the ship as a tow does.

    Not modelled: added resistance in waves, shallow water, roll; the engine (at ``speed`` thrust
    and resistance balance, and the polynomial holds near it); rudder machinery, see
    `RudderMachine`.

    Raises InputError at the start if the linear model starts at another speed, or the mass
    matrix of the cubic one is not of positive determinant.
    """

    max_step = Parameter(0.1, "s", "longest integration sub-step", min=1e-6)
    model = Parameter("linear", "1", "equations of motion", choices=("linear", "cubic"))
    length = Parameter(1.0, "m", "length that makes things dimensionless", min=1e-9)
    water_density = Parameter(
        1025.0, "kg/m3", "rho: the ship's mass is its dimensionless one times rho L^3 / 2", min=1e-9
    )
    speed = Parameter(1.0, "m/s", "service speed", min=1e-9)
    state_matrix = Parameter(
        0.0, "1", "A* of (v*, r*), by rows (linear)", axes=("vv", "vr", "rv", "rr")
    )
    rudder_vector = Parameter(0.0, "1", "B* of (v*, r*) (linear)", axes=("v", "r"))
    mass = Parameter(1.0, "1", "m (cubic)", min=0.0)
    inertia = Parameter(1.0, "1", "I_zz about the body origin (cubic)", min=0.0)
    center_of_gravity = Parameter(0.0, "1", "x_G, ahead of the body origin (cubic)")
    X_udot = Parameter(0.0, "1", "added mass in surge, negative (cubic)")
    Y_vdot = Parameter(0.0, "1", "added mass in sway, negative (cubic)")
    Y_rdot = Parameter(0.0, "1", "added mass, sway from yaw (cubic)")
    N_vdot = Parameter(0.0, "1", "added mass, yaw from sway (cubic)")
    N_rdot = Parameter(0.0, "1", "added inertia in yaw, negative (cubic)")
    X = Parameter(0.0, "1", "surge: coefficients of products of u*, v*, r*, d", axes=_SURGE_TERMS)
    Y = Parameter(0.0, "1", "sway: coefficients of products of u*, v*, r*, d", axes=_SWAY_TERMS)
    N = Parameter(0.0, "1", "yaw: coefficients of products of u*, v*, r*, d", axes=_SWAY_TERMS)

    rudder = Input(
        "rad", "angle of the rudder, trailing edge to port positive: turns to port", role="command"
    )
    disturbance = Input(
        ("m/s2", "rad/s2"), "what a disturbance adds to dv/dt and dr/dt, body axes", axes="vr"
    )

    nu = State(
        ("m/s", "m/s", "rad/s"),
        "velocity of the body origin over ground and rate of yaw, body axes",
        axes=("u", "v", "r"),
        start=(1.0, 0.0, 0.0),
    )

    feedthrough: ClassVar = {
        **ThreeDofCraft.feedthrough,
        "acceleration": ("rudder", "disturbance", "attachment_force"),
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError for what no model can be."""
        _x, _y, _psi, u, _v, _r = self._start_state().tolist()
        if self.model == "linear" and u != self.speed:
            raise InputError(
                f"{self.name}.nu_start.u is {u!r} m/s; the linear model keeps its "
                f"speed, {self.speed!r} m/s"
            )
        numbers = {name: ca.DM(getattr(self, name)) for name in _INERTIAS}
        determinant = float(ca.det(_mass_matrix(SimpleNamespace(**numbers))))
        if self.model == "cubic" and not determinant > 0.0:
            raise InputError(
                f"{self.name}: the determinant of the mass matrix is {determinant:.4g}, more than "
                f"0 is needed; check {', '.join(_INERTIAS)}"
            )
        super().start(t)

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        scale = 0.5 * self.water_density * self.length**3
        return HullCoefficients(sway=(-self.Y_vdot * scale, 0.0)), self.water_density

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion and that of the attachment."""
        attached, pull = attachment(x, u, p)
        nu_r, carrying = carried(x.eta, x.nu, u)
        nu_dot = (_linear if p.model == "linear" else _cubic)(nu_r, u.rudder, p) + carrying
        nu_dot += ca.vertcat(0, u.disturbance) + _pulled(pull + sea_load(u), p)
        motion = {**motion_outputs(x.eta, x.nu, nu_dot), **attached}
        motion |= water_outputs(x.eta, nu_r, u, p)
        return {"eta": kinematics(x.eta, x.nu), "nu": nu_dot}, motion


def _linear(nu: Any, rudder: Any, p: SimpleNamespace) -> Any:
    """Return (u', v', r'), SI: [Moro1979], eqs 6 and 7."""
    per_second = p.speed / p.length
    scale = ca.vertcat(p.speed, per_second)
    A = ca.reshape(p.state_matrix, 2, 2).T
    return ca.vertcat(0, per_second * scale * (A @ (nu[1:] / scale) + p.rudder_vector * rudder))


def _cubic(nu: Any, rudder: Any, p: SimpleNamespace) -> Any:
    """Return (u', v', r'), SI: [Chislett1965]."""
    U = ca.sqrt(nu[0] ** 2 + nu[1] ** 2)
    scale = ca.vertcat(U, U, U / p.length)
    u, v, r = ca.vertsplit((nu - ca.vertcat(p.speed, 0, 0)) / scale)
    factors = {"u": u, "v": v, "r": r, "d": rudder}
    X, Y, N = (
        polynomial(terms, coefficients, factors)
        for terms, coefficients in ((_SURGE_TERMS, p.X), (_SWAY_TERMS, p.Y), (_SWAY_TERMS, p.N))
    )
    return U / p.length * scale * ca.solve(_mass_matrix(p), ca.vertcat(X, Y, N))


def _pulled(load: Any, p: SimpleNamespace) -> Any:
    """Return what a load (X, Y, N), SI, adds to (u', v', r'); the linear model has no u'."""
    scale = ca.vertcat(1, 1, p.length)
    nu_dot = ca.solve(_mass_matrix(p), load / scale) / scale / (0.5 * p.water_density * p.length**3)
    return ca.vertcat(0, nu_dot[1:]) if p.model == "linear" else nu_dot


def _mass_matrix(p: SimpleNamespace) -> Any:
    """Return the dimensionless M, which is not symmetric as Y_rdot and N_vdot are measured."""
    moment = p.mass * p.center_of_gravity
    return ca.vertcat(
        ca.horzcat(p.mass - p.X_udot, 0, 0),
        ca.horzcat(0, p.mass - p.Y_vdot, moment - p.Y_rdot),
        ca.horzcat(0, moment - p.N_vdot, p.inertia - p.N_rdot),
    )
