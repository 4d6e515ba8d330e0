"""Propellers by their open-water characteristics: K_T and K_Q over J, or four quadrants.

n = shaft speed / (2 pi), D the diameter, V_a = (1 - w) u the speed of advance, u the speed of the
propeller's place through the water along its axis. Thrust acts on the craft as (1 - t) T, the
shaft's moment Q as -hand share Q about the axis: the hull reacts against a propeller that turns
clockwise seen from astern by rolling to port. The shaft takes 2 pi n Q, less than 0 where the flow
drives it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import casadi as ca

from seatrial.physics.craft.terms.context import Context, wrench

from .flow import STILL, held
from .thrust import Drive, Push
from .wageningen import wageningen_b as series

ADVANCES = ("through-water", "over-ground")
"""Speeds that propellers may advance at: `fitted_craft`."""

_STOPPED = 1e-9
"""1/s: of n, below which J is not formed."""


def propeller(c: Context, drive: Drive) -> Push:
    """T = rho n^2 D^4 K_T(J), Q = rho n^2 D^5 K_Q(J), J = V_a / (n D), by polynomials of degree 2.

    J is held from 0 to ``advance_limit``: with k2 the limit keeps the thrust of a stopping shaft
    from staying at rho D^2 k2 V_a^2. In reverse the advance does not act: T = -rho n^2 D^4 K_T(0),
    Q alike.
    """
    s = drive.slot
    return _over_advance(c, drive, ca.vertsplit(s.K_T), ca.vertsplit(s.K_Q))


def wageningen_b(c: Context, drive: Drive) -> Push:
    """Propeller of the Wageningen B series, as `propeller` with the series' polynomials.

    The series was not measured in reverse, where K(0) is more than a propeller made for motion
    ahead gives.
    """
    s = drive.slot
    return _over_advance(c, drive, *series(s.blades, s.pitch_ratio, s.area_ratio))


def four_quadrant(c: Context, drive: Drive) -> Push:
    """T = rho/2 V^2 A C_T*(beta), Q = rho/2 V^2 A D C_Q*(beta), A = pi D^2 / 4.

    V^2 = V_a^2 + (0.7 pi n D)^2, beta = atan2(V_a, 0.7 pi n D); C* = a0 + sum over k = 1 to 4 of
    a_k cos(k beta) + b_k sin(k beta) (van Lammeren, van Manen and Oosterveld, 1969). All signs of
    shaft speed and advance; a0 alone is a force that depends on V only.
    """
    s, (n, rate) = drive.slot, _shaft(drive)
    advance, curves = _advance(c, drive), [ca.vertsplit(each) for each in (s.C_T, s.C_Q)]
    thrust, moment = all_quadrants(s.diameter, c.parameters.density, n, advance, curves)
    return _screwed(drive, thrust, moment, rate, advance)


def all_quadrants(
    diameter: Any,
    density: Any,
    n: Any,
    advance: Any,
    curves: Sequence[Sequence[Any]],
    turn: Any = 0,
) -> tuple[Any, Any]:
    """Return thrust T, N, and moment Q, N.m, of `four_quadrant` by ``curves`` of C_T* and C_Q*.

    ``n`` is the shaft speed, 1/s, ``advance`` V_a, m/s, of any sign; a curve has a0 ... aN, then
    b1 ... bN, and is read at beta + ``turn``, rad.
    """
    blade = 0.7 * math.pi * n * diameter
    squared = advance**2 + blade**2
    speed = ca.sqrt(squared + STILL**2)
    cos, sin = blade / speed, advance / speed
    cos, sin = cos * ca.cos(turn) - sin * ca.sin(turn), sin * ca.cos(turn) + cos * ca.sin(turn)
    scale = density * math.pi / 8 * diameter**2 * squared
    thrust, moment = (scale * _harmonics(each, cos, sin) for each in curves)
    return thrust, moment * diameter


def _harmonics(coefficients: Sequence[Any], cos: Any, sin: Any) -> Any:
    """Return the series at the angle with ``cos`` and ``sin``, by the addition theorems."""
    c, s = cos, sin
    total, order = coefficients[0], len(coefficients) // 2
    for k in range(1, order + 1):
        total += coefficients[k] * c + coefficients[order + k] * s
        c, s = c * cos - s * sin, s * cos + c * sin
    return total


def _over_advance(c: Context, drive: Drive, K_T: Sequence[Any], K_Q: Sequence[Any]) -> Push:
    """Return the push of curves of K_T and K_Q, coefficients of 1, J, J^2 and on."""
    n, rate = _shaft(drive)
    advance = _advance(c, drive)
    thrust, moment = open_water(drive.slot, c.parameters.density, n, advance, (K_T, K_Q))
    return _screwed(drive, thrust, moment, rate, advance)


def open_water(
    slot: SimpleNamespace,
    density: Any,
    n: Any,
    advance: Any,
    curves: tuple[Sequence[Any], Sequence[Any]],
) -> tuple[Any, Any]:
    """Return thrust T, N, and moment Q, N.m, of `propeller` by its ``curves`` of K_T and K_Q.

    ``n`` is the shaft speed, 1/s, negative in reverse, ``advance`` V_a, m/s; ``slot`` has
    ``diameter``, m, and ``advance_limit``.
    """
    J = held(advance / (ca.fmax(n, _STOPPED) * slot.diameter), 0, slot.advance_limit)
    scale = density * n * ca.fabs(n) * slot.diameter**4
    thrust, moment = (
        scale * ca.if_else(n > 0, _polynomial(curve, J), curve[0]) for curve in curves
    )
    return thrust, moment * slot.diameter


def _polynomial(coefficients: Sequence[Any], x: Any) -> Any:
    total: Any = 0
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


def _shaft(drive: Drive) -> tuple[Any, Any]:
    """Return the shaft speed, 1/s and rad/s."""
    ahead, astern = ca.vertsplit(drive.slot.speed)
    rate = drive.order * ca.if_else(drive.order > 0, ahead, astern)
    return rate / math.tau, rate


def _advance(c: Context, drive: Drive) -> Any:
    if c.parameters.speed_of_advance == "over-ground":
        speed = ca.sqrt(ca.sumsqr(c.nu[:3]) + STILL**2)
        return (1 - drive.slot.wake) * speed
    return drive.advance


def _screwed(drive: Drive, thrust: Any, moment: Any, rate: Any, advance: Any) -> Push:
    s = drive.slot
    force = (1 - s.deduction) * thrust
    reaction = -s.hand * s.moment_share * moment * drive.direction
    load = wrench(force * drive.direction, s.position) + ca.vertcat(0, 0, 0, reaction)
    return Push(load, force, rate, rate * moment, thrust / s.diameter**2, advance)
