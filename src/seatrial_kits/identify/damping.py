"""Damping of a hull estimated from its dimensions: skin friction, form drag, cross-flow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from seatrial.errors import InputError
from seatrial.model.expressions import Vector

_LEAST_REYNOLDS = 1e3
"""Below, log10 Re - 2 of the friction line goes towards 0."""
_GAUSS = np.polynomial.legendre.leggauss(3)
"""Exact to the fifth power of x: the sections are linear between stations, times x^3."""
_ROUND_OFF = 1e-12
"""Share of its parts below which an integral of a hull alike fore and aft is 0."""


@dataclass(frozen=True)
class HullForm:
    """What is known of a hull at rest, of one of ``hulls`` alike; lengths in m, areas in m2.

    ``draught`` and ``beam`` are at stations evenly spaced from stern to bow, linear between
    them; ``middle`` is that of their length ahead of the body origin. ``wetted_area`` and
    ``frontal_area`` are of all hulls.
    """

    length: float
    draught: tuple[float, ...]
    beam: tuple[float, ...]
    wetted_area: float
    frontal_area: float
    middle: float = 0.0
    hulls: int = 1
    hulls_across: int = 1
    """Hulls that a flow from the side meets: 1 if one shields the other."""
    form_factor: float = 0.15
    """k of 1 + k."""
    drag_ahead: float = 0.45
    drag_across: float = 1.2
    drag_down: float = 1.2


@dataclass(frozen=True)
class Derivative:
    """A hydrodynamic derivative: ``symbol`` as X_u, ``value`` with its sign, SI ``unit``."""

    symbol: str
    value: float
    unit: str
    equation: str


def friction_line(reynolds: float) -> float:
    """Return C_f = 0.075 / (log10 Re - 2)^2, ITTC 1957. Raises InputError for Re below 1000."""
    if reynolds < _LEAST_REYNOLDS:
        raise InputError(
            f"the Reynolds number is {reynolds:.3g}; the friction line holds from "
            f"{_LEAST_REYNOLDS:.0f} on: a greater length or speed is needed"
        )
    return float(0.075 / (math.log10(reynolds) - 2.0) ** 2)


@dataclass(frozen=True)
class CrossFlow:
    """1/2 rho C_d times the integrals of a width T(x) over the hull: kg/m, kg, kg.m."""

    force: float
    """int T dx"""
    lever: float
    """int T x dx"""
    by_turning: float
    """int T x |x| dx"""
    moment: float
    """int T |x|^3 dx"""


def cross_flow(hull: HullForm, width: tuple[float, ...], drag: float, density: float) -> CrossFlow:
    """Return what a flow across the hull makes of drag by strips.

    A strip at x, in a turn, meets |v + x r| (v + x r): forces and moments of v alone and of r alone
    are those of the four integrals. ``width``, m, is what the flow meets, by station.
    """
    stations = hull.middle + np.linspace(-0.5, 0.5, len(width)) * hull.length
    inside = (stations[0] < 0.0) & (stations[-1] > 0.0)
    edges = np.unique(np.append(stations, 0.0)) if inside else stations
    half = 0.5 * np.diff(edges)
    x = (0.5 * (edges[1:] + edges[:-1]))[:, None] + np.outer(half, _GAUSS[0])
    dragged: Vector = 0.5 * density * drag * np.interp(x, stations, width) * _GAUSS[1]

    def over_hull(power: Vector) -> float:
        parts = half[:, None] * dragged * power
        whole = float(parts.sum())
        return whole if abs(whole) > _ROUND_OFF * float(np.abs(parts).sum()) else 0.0

    one = np.ones_like(x)
    return CrossFlow(*(over_hull(power) for power in (one, x, x * np.abs(x), np.abs(x) ** 3)))


def damping(hull: HullForm, speed: float, density: float, viscosity: float) -> list[Derivative]:
    """Return the derivatives of eq. 25 of [Timm2026] that dimensions give.

    ``speed`` U, m/s, is that at which the friction is taken for linear; ``density``, kg/m3;
    ``viscosity``, kinematic, m2/s. T is the draught and B the beam, x ahead of the body origin:

        X_u    = -1/2 rho S (1 + k) C_f U                                      [Timm2026], eq. 21
        X_u|u| = -1/2 rho A C_d                                                [Timm2026], eq. 22
        Y_v|v| = -1/2 rho int T C_d dx                                         [Timm2026], eq. 23
        N_v|v| = -1/2 rho int T C_d x dx
        Y_r|r| = -1/2 rho int T C_d x|x| dx         [Timm2026], eq. 24, printed for N_r|r|
        N_r|r| = -1/2 rho int T C_d |x|^3 dx                         [Timm2026], eq. 24, corrected
        Z_w|w|, M_q|q| as Y_v|v|, N_r|r| with B,  M_w|w| = -N_v|v|,  Z_q|q| = -Y_r|r| with B

    A strip of the hull moves with x r in a turn: its drag goes with (x r)^2, and the moment of that
    with |x|^3; the printed integral of x|x| is 0 for a hull alike fore and aft, and the force's.
    Damping by radiated waves, of roll, and linear damping in sway and yaw are not of this kind.
    Raises InputError for a Reynolds number that the friction line does not hold for.
    """
    friction = friction_line(speed * hull.length / viscosity)
    ahead = 0.5 * density * hull.wetted_area * (1.0 + hull.form_factor) * friction * speed
    form = 0.5 * density * hull.frontal_area * hull.drag_ahead
    y = cross_flow(hull, hull.draught, hull.drag_across * hull.hulls_across, density)
    z = cross_flow(hull, hull.beam, hull.drag_down * hull.hulls, density)
    return [
        Derivative("X_u", -ahead, "N.s/m", "[Timm2026], eq. 21"),
        Derivative("X_u|u|", -form, "N.s2/m2", "[Timm2026], eq. 22"),
        Derivative("Y_v|v|", -y.force, "N.s2/m2", "[Timm2026], eq. 23"),
        Derivative("N_v|v|", -y.lever, "N.s2/m", "cross-flow"),
        Derivative("Y_r|r|", -y.by_turning, "N.s2/rad2", "cross-flow; [Timm2026], eq. 24, printed"),
        Derivative("N_r|r|", -y.moment, "N.m.s2/rad2", "[Timm2026], eq. 24, corrected"),
        Derivative("Z_w|w|", -z.force, "N.s2/m2", "cross-flow"),
        Derivative("M_w|w|", z.lever, "N.s2/m", "cross-flow"),
        Derivative("Z_q|q|", z.by_turning, "N.s2/rad2", "cross-flow"),
        Derivative("M_q|q|", -z.moment, "N.m.s2/rad2", "cross-flow"),
    ]
