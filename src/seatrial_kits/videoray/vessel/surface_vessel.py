"""An underwater vehicle at constant depth, reduced to a vessel in the horizontal plane."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from seatrial.errors import InputError
from seatrial.model.component import Input, Parameter
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

_MASSES = ("kg", "kg", "kg.m2")
_DAMPINGS = ("N.s/m", "N.s/m", "N.m.s/rad")


class SurfaceVessel(LoadedCraft):
    """Vessel in surge, sway and yaw that two thrusters ahead move: no force in sway.

    [Paulino2015], eqs 5.17 to 5.19 and 6.5. eta = (x, y, psi): body origin in {n} (x north,
    y east), m, and heading, clockwise from north, rad; nu = (u, v, r): velocity of the origin
    over ground, m/s, and rate of yaw, rad/s, in {b} (x bow, y starboard, z down). With
    ``mass`` (m11, m22, m33), added mass included, and ``damping`` (d11, d22, d33):

        m11 u' = X - d11 u + m22 v r                     X = E1 t1 + E2 t2
        m22 v' = Y - d22 v - m11 u r
        m33 r' = N - d33 r + s (m11 - m22) u v           N = l (E1 t1 - E2 t2)

    ``command`` (t1, t2) is each thruster's share of its full thrust E1, E2 (``thrust``), -1 to
    1; thruster 1 ahead turns to starboard. The terms of ``force`` and ``moment``, body axes, and
    what a tether or tow does add to X, Y and N. ``lever_arm`` l is the thrusters' distance from
    the centre line; the source has none (l = 1 m).

    s is ``yaw_coupling_sign``, 1: the yaw moment of the added masses as momentum demands it
    (5.18). The source's control law has s = -1 (6.2, 6.3, 8.1), and its table 8.1 comes from a
    model that has it too; -1 is for that reproduction alone.

    In the sea of a trial u, v and r of the right-hand sides are those through the water, and the
    loads of waves and wind are added to X, Y and N.

    Not modelled: quadratic damping, coupling of sway and yaw by a centre of gravity off the
    origin, lag and limits of the thrusters: a command beyond 1 gives more than E.

    Raises InputError at the start if ``yaw_coupling_sign`` is neither -1 nor 1.
    """

    mass = Parameter(1.0, _MASSES, "mass and inertia with added mass", axes="uvr", min=1e-9)
    damping = Parameter(0.0, _DAMPINGS, "linear damping", axes="uvr", min=0.0)
    thrust = Parameter(1.0, "N", "thrust of each thruster at command 1", axes=("t1", "t2"))
    lever_arm = Parameter(1.0, "m", "thrusters from the centre line", min=1e-9)
    yaw_coupling_sign = Parameter(
        1.0, "1", "s: 1, or -1 to reproduce table 8.1 of the source", min=-1.0, max=1.0
    )

    command = Input(
        "1", "share of each thruster's full thrust, -1 to 1", axes=("t1", "t2"), role="command"
    )
    feedthrough: ClassVar = {**LoadedCraft.feedthrough, "acceleration": ("command", *LOADS)}

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError for a sign between -1 and 1."""
        if abs(self.yaw_coupling_sign) != 1.0:
            raise InputError(
                f"{self.name}.yaw_coupling_sign is {self.yaw_coupling_sign!r}, allowed -1.0 or 1.0"
            )
        super().start(t)

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        return HullCoefficients(sway=(0.0, self.damping[1])), WATER_DENSITY

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion and that of the attachment."""
        first, second = ca.vertsplit(p.thrust * u.command)
        tau = ca.vertcat(first + second, 0, p.lever_arm * (first - second))
        attached, pull = attachment(x, u, p)
        load = ca.vertcat(LoadedCraft.force.total(u), LoadedCraft.moment.total(u)) + pull
        load = load + sea_load(u)
        nu_r, carrying = carried(x.eta, x.nu, u)
        signs = ca.vertcat(1, 1, p.yaw_coupling_sign)
        coriolis = signs * planar_coriolis((p.mass * nu_r)[:2], nu_r)
        nu_dot = (tau + load - p.damping * nu_r - coriolis) / p.mass + carrying
        motion = {**motion_outputs(x.eta, x.nu, nu_dot), **attached}
        motion |= water_outputs(x.eta, nu_r, u, p)
        return {"eta": kinematics(x.eta, x.nu), "nu": nu_dot}, motion
