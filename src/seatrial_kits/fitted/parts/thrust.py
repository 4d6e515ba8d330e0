"""Thrust of a propulsor by a law or by momentum: thrusters, azimuths, outboards, tunnels, jets.

Each kind is a function of a `Context` and a `Drive` that returns a `Push`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context, wrench

from .flow import STILL

_SMALL = 1e-12
"""Share of an order, below which its powers are linear."""


@dataclass(frozen=True)
class Drive:
    """A propulsor at work, as expressions."""

    slot: SimpleNamespace
    """Its parameters, by their short names."""
    order: Any
    """Order that acts, -1 to 1."""
    direction: Any
    """Direction of the thrust ahead, turned by the angle, unit vector, {b}."""
    flow: Any
    """Velocity of its place through the water, {b}, m/s."""

    @property
    def advance(self) -> Any:
        """Speed of advance (1 - w) d . v, m/s."""
        return (1 - self.slot.wake) * ca.dot(self.direction, self.flow)


@dataclass(frozen=True)
class Push:
    """Forces of a propulsor, as expressions."""

    load: Any
    """Force and moment about the body origin (6,), {b}, N and N.m."""
    force: Any
    """Thrust along its direction that acts on the craft, N."""
    rate: Any
    """Shaft speed, rad/s."""
    power: Any
    """Power of the shaft, W."""
    loading: Any
    """Thrust before deduction over the square of the diameter, N/m2: what speeds up the race."""
    advance: Any
    """Speed of advance, m/s."""


def thruster(c: Context, drive: Drive) -> Push:
    """T = sgn(s) |s|^k T_max of the order s, whatever the flow; k is ``exponent``.

    Shaft speed sgn(s) |s|^(k/2) of the largest, as thrust goes with its square. The power is that
    of an actuator disk of the diameter, |T| (u/2 + sqrt(u^2/4 + |T| / (2 rho A))), u the speed of
    advance along the thrust: the least that gives this thrust. No reaction of the shaft.
    """
    return _by_law(c, drive, 1)


def azimuth(c: Context, drive: Drive) -> Push:
    """Thruster that turns; its thrust fades in flow that does not come from ahead of it.

    T = T_0 (1 - min(1, w^2 / u_0^2)), w^2 = v^2 - max(u, 0)^2: v is the speed of the flow at its
    place, u that of advance along the thrust, u_0 the ``fading_speed``, 0 for no loss. So there is
    no loss straight into the flow, and the same at right angles and back against it, in the form
    that tunnels have (`tunnel`). The shaft's power does not fade.
    """
    into = ca.fmax(ca.sign(drive.order) * ca.dot(drive.direction, drive.flow), 0)
    return _by_law(c, drive, _left(drive, ca.fmax(ca.sumsqr(drive.flow) - into**2, 0)))


def tunnel(c: Context, drive: Drive) -> Push:
    """Thruster in a tunnel: T = T_0 (1 - min(1, (u / u_0)^2)), u the speed ahead at its place.

    u_0 is the ``fading_speed``, 0 for no loss (form of the measurements of
    [Chislett1966]). The shaft's power does not fade.
    """
    return _by_law(c, drive, _left(drive, drive.flow[0] ** 2))


def jet(c: Context, drive: Drive) -> Push:
    """Water jet: F = rho Q (V_j d - v), Q = A V_j, by momentum theory.

    v is the velocity of the intake through the water, A the nozzle's area, d the direction of the
    nozzle, V_j = sqrt(|T_0| / (rho A)) the speed of the jet, T_0 = |s|^k T_max at rest. Astern the
    bucket turns the jet round, with ``thrust`` astern of that ahead left: F = -rho Q (b V_j d + v).
    Power rho Q (V_j^2 - v^2) / 2, not below 0, of a pump without losses; shaft speed as `thruster`.
    No reaction of the shaft; wake and deduction are not taken.
    """
    p, s = c.parameters, drive.slot
    area = math.pi / 4 * s.diameter**2
    at_rest = ca.fabs(_power_of(drive.order, s.exponent)) * s.thrust[0]
    speed = ca.sqrt(at_rest / (p.density * area) + STILL**2)
    flux = p.density * area * speed
    kept = ca.if_else(drive.order < 0, -s.thrust[1] / s.thrust[0], 1)
    force = flux * (kept * speed * drive.direction - drive.flow)
    power = flux / 2 * ca.fmax(speed**2 - ca.sumsqr(drive.flow), 0)
    along = ca.dot(drive.direction, force)
    load, loading = wrench(force, s.position), along / s.diameter**2
    return Push(load, along, _law_rate(drive), power, loading, drive.advance)


def _by_law(c: Context, drive: Drive, left: Any) -> Push:
    """Return the push of a thrust law of which the share ``left`` is not lost to the flow."""
    s = drive.slot
    largest = ca.if_else(drive.order > 0, s.thrust[0], s.thrust[1])
    at_rest = _power_of(drive.order, s.exponent) * largest
    thrust = at_rest * left
    force = (1 - s.deduction) * thrust
    area = math.pi / 4 * s.diameter**2
    u = ca.sign(drive.order) * drive.advance / 2
    disk = ca.fabs(at_rest) / (2 * c.parameters.density * area)
    power = ca.fabs(at_rest) * (u + ca.sqrt(u**2 + disk + STILL**2))
    load = wrench(force * drive.direction, s.position)
    return Push(load, force, _law_rate(drive), power, thrust / s.diameter**2, drive.advance)


def _left(drive: Drive, squared: Any) -> Any:
    """Return what the square of a speed leaves of the thrust."""
    u_0 = drive.slot.fading_speed
    fading = ca.fmax(1 - squared / ca.fmax(u_0, STILL) ** 2, 0)
    return ca.if_else(u_0 > 0, fading, 1)


def _law_rate(drive: Drive) -> Any:
    s = drive.slot
    largest = ca.if_else(drive.order > 0, s.speed[0], s.speed[1])
    return _power_of(drive.order, s.exponent / 2) * largest


def _power_of(order: Any, exponent: Any) -> Any:
    """Return sgn(s) |s|^k, in a form with the right slope at 0 for k = 1."""
    return order * ca.fmax(ca.fabs(order), _SMALL) ** (exponent - 1)
