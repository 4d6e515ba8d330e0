"""Base of craft in the horizontal plane: kinematics and motion outputs.

Frames: {n} x north, y east, z down; {b} x bow, y starboard, z down. eta = (x, y, psi) and
nu = (u, v, r), or eta = (x, y, phi, psi) and nu = (u, v, p, r) for craft that heel too:
position of the body origin in {n}, m; heel, starboard down, and heading, clockwise from
north, rad; velocity of the body origin over ground, m/s, and angular rates, rad/s, in {b}.
Heave and pitch are left out: z = theta = 0, w = q = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ...model.component import Input, Parameter, Terms, terminal
from ...model.plant import State
from ...model.ports import Output
from ...model.terminals import ATTACHMENT, MOTION
from ..sea.loads import Response
from ..sea.numbers import GRAVITY
from .around import Places
from .seaway import Seaway, WindySeaway
from .symbolic import rotation_matrix
from .through_water import ThroughWater, flow_outputs
from .wave_hull import HullCoefficients, WaveHull

_NED = ("north", "east", "down")


class PlanarCraft(ThroughWater, WaveHull, Seaway):
    """Base of craft in the horizontal plane: publishes their motion as sensors expect it.

    The waves of a trial act by the loads on the hull's sections in the plane, its current on the
    motion through the water (`carried`). Waves do not heave or pitch it.

    The subclass declares its states eta and nu and returns `motion_outputs` and `water_outputs`
    among its outputs.

    A tether or a tow pulls with ``attachment_force`` f, {n}, at ``attachment_place`` r, body axes;
    see `attachment`. What it pulls up or down is lost: there is no heave.
    """

    attachment_place = Parameter(
        0.0, "m", "attachment of a tether or tow from the body origin, body axes", axes="xyz"
    )
    attachment_force = Input(
        "N", "force of a tether or tow at its attachment, {n}", axes=_NED, optional=True
    )

    position = Output("m", "body origin in north-east-down; z = 0", axes="xyz", frame="n")
    attitude = Output("rad", "Euler angles, ZYX; theta = 0", axes=("phi", "theta", "psi"))
    velocity = Output(
        "m/s", "velocity of the body origin over ground, body axes; w = 0", axes=("u", "v", "w")
    )
    rates = Output("rad/s", "angular velocity, body axes; q = 0", axes=("p", "q", "r"))
    acceleration = Output(
        "m/s2",
        "inertial acceleration of the body origin, dv/dt + omega x v, body axes",
        axes="xyz",
        frame="b",
    )
    attachment_point = Output("m", "attachment of a tether or tow, {n}", axes=_NED)
    attachment_velocity = Output("m/s", "velocity of the attachment over ground, {n}", axes=_NED)

    terminals: ClassVar = {
        "motion": MOTION,
        "attachment": ATTACHMENT,
        **ThroughWater.water_terminals,
    }
    feedthrough: ClassVar = dict.fromkeys(
        (
            *("position", "attitude", "velocity", "rates"),
            *("attachment_point", "attachment_velocity", "nu_r", "flow"),
        ),
        (),
    )

    def wave_response(self) -> Response | None:
        """Return the loads of the waves by strips, with the craft's own coefficients."""
        own, density = self.wave_coefficients()
        return self.hull_loads(own, density, GRAVITY, None).forces

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        raise TypeError(f"{type(self).__name__} does not say what waves do to it")


class ThreeDofCraft(WindySeaway, PlanarCraft):
    """Base of craft that stay upright: the states eta = (x, y, psi) and nu = (u, v, r)."""

    places: ClassVar = Places(x=0, y=1, z=None, psi=2, u=3, v=4)

    eta = State(
        ("m", "m", "rad"),
        "body origin in {n}; heading, clockwise from north",
        axes=("x", "y", "psi"),
    )
    nu = State(
        ("m/s", "m/s", "rad/s"),
        "velocity of the body origin over ground and rate of yaw, body axes",
        axes=("u", "v", "r"),
    )


class LoadedCraft(ThreeDofCraft):
    """Base of craft that stay upright, on which others act: thrusters, an environmental load.

    ``force`` and ``moment`` are sums of their terms: (X, Y), N, in body axes at the body origin,
    and N, N.m, positive to starboard.
    """

    force = Terms(4, "N", "force on the craft, body axes", axes="xy", frame="b")
    moment = Terms(4, "N.m", "yaw moment on the craft, positive to starboard")

    terminals: ClassVar = {
        **ThreeDofCraft.terminals,
        "wrench": terminal("force", "moment", rule="plug"),
    }


LOADS = (*LoadedCraft.force.names, *LoadedCraft.moment.names, "attachment_force")
"""Inputs of a `LoadedCraft` that act on its acceleration."""


def carried(eta: Any, nu: Any, u: SimpleNamespace) -> tuple[Any, Any]:
    """Return nu_r, ``nu`` = (u, v, r) through the water of a trial, and d(nu - nu_r)/dt.

    The water moves with V in {n}, uniform over the craft: in {b} it turns with the craft,
    d(R^T V)/dt = R^T V' - omega x R^T V.
    """
    if not hasattr(u, "water_velocity"):
        return nu, ca.DM(3, 1)
    into_body = horizontal_rotation(0, eta[2]).T
    water, rate = into_body @ u.water_velocity[:2], into_body @ u.water_acceleration[:2]
    turning = nu[2] * ca.vertcat(water[1], -water[0])
    return nu - ca.vertcat(water, 0), ca.vertcat(rate + turning, 0)


def sea_load(u: SimpleNamespace, rows: Sequence[int] = (0, 1, 5)) -> Any:
    """Return ``rows`` of the loads X, Y, Z, K, M, N of waves and wind of a trial, N and N.m."""
    if not hasattr(u, "wave_load"):
        return ca.DM(len(rows), 1)
    return (u.wave_load + u.wind_load)[list(rows)]


def motion_outputs(eta: Any, nu: Any, nu_dot: Any) -> dict[str, Any]:
    """Return the outputs of `PlanarCraft` from CasADi columns eta, nu and d(nu)/dt.

    With heel, R (u, v, 0) has a vertical part v sin(phi): that is what leaving out heave costs.
    """
    x, y, phi, psi = _four(eta)
    u, v, p, r = _four(nu)
    u_dot, v_dot, _p_dot, _r_dot = _four(nu_dot)
    velocity, rates = ca.vertcat(u, v, 0), ca.vertcat(p, 0, r)
    return {
        "position": ca.vertcat(x, y, 0),
        "attitude": ca.vertcat(phi, 0, psi),
        "velocity": velocity,
        "rates": rates,
        "acceleration": ca.vertcat(u_dot, v_dot, 0) + ca.cross(rates, velocity),
    }


def water_outputs(eta: Any, nu_r: Any, u: SimpleNamespace, p: SimpleNamespace) -> dict[str, Any]:
    """Return the outputs of `ThroughWater` from CasADi columns eta and nu_r, in the order of nu."""
    _x, _y, phi, psi = _four(eta)
    u_r, v_r, roll, yaw = _four(nu_r)
    R = rotation_matrix(ca.vertcat(phi, 0, psi))
    return flow_outputs(R, ca.vertcat(u_r, v_r, 0, roll, 0, yaw), u, p)


def kinematics(eta: Any, nu: Any) -> Any:
    """Return d(eta)/dt, in the order of eta: (x', y') = J (u, v), phi' = p, psi' = r cos(phi).

    [Silva2018], eq. 2.3; with phi = 0 Fossen's three degrees of freedom.
    """
    _x, _y, phi, psi = _four(eta)
    u, v, p, r = _four(nu)
    place = horizontal_rotation(phi, psi) @ ca.vertcat(u, v)
    heel = [p] if eta.numel() == 4 else []
    return ca.vertcat(place, *heel, r * ca.cos(phi))


def horizontal_rotation(phi: Any, psi: Any) -> Any:
    """Return J (2, 2), with (north, east) = J (u, v): [Silva2018], eq. 2.5.

    J^T takes a horizontal velocity into body axes.
    """
    c, s = ca.cos(psi), ca.sin(psi)
    return ca.vertcat(ca.horzcat(c, -s * ca.cos(phi)), ca.horzcat(s, c * ca.cos(phi)))


def attachment(
    x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
) -> tuple[dict[str, Any], Any]:
    """Return place and velocity of the attachment, by output, and what its force does.

    Point P = (x, y, 0) + R_z(psi) R_x(phi) r, m, and P' = W nu, m/s, in {n}. The load is
    W^T f, in the order of nu, N and N.m: its power is that of f at the point, f . P'.
    """
    north, east, phi, psi = _four(x.eta)
    a, b, c = ca.vertsplit(p.attachment_place)
    across, down = b * ca.cos(phi) - c * ca.sin(phi), b * ca.sin(phi) + c * ca.cos(phi)
    cos, sin = ca.cos(psi), ca.sin(psi)
    point = ca.vertcat(north + a * cos - across * sin, east + a * sin + across * cos, down)
    velocity = ca.jtimes(point, x.eta, kinematics(x.eta, x.nu))
    load = ca.jtimes(velocity, x.nu, u.attachment_force, True)
    return {"attachment_point": point, "attachment_velocity": velocity}, load


def planar_coriolis(h: Any, nu: Any) -> Any:
    """Return C(nu) nu = (-r h_v, r h_u, u h_v - v h_u) of a momentum h and nu = (u, v, r).

    ``h`` is (h_u, h_v), N.s, in body axes; the result force X, Y, N, and moment N, N.m: what
    Kirchhoff's equations have on the left-hand side.
    """
    (h_u, h_v), (u, v, r) = ca.vertsplit(h), ca.vertsplit(nu)
    return ca.vertcat(-r * h_v, r * h_u, u * h_v - v * h_u)


def _four(column: Any) -> list[Any]:
    """Return the elements of eta or nu, with 0 for a heel that is not there."""
    first, second, *heel, last = ca.vertsplit(column)
    return [first, second, heel[0] if heel else 0.0, last]
