"""Formulas of hulls that float: form, hydrostatics, added mass by strips, resistance, cross-flow.

The body origin is amidships in the water line, x ahead, z down; lengths in m.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.model.expressions import Vector

from . import sections

_GAUSS = np.polynomial.legendre.leggauss(40)
GRAVITY = 9.81
_HOERNER = (
    (0.0108623, 1.96608), (0.176606, 1.96573), (0.353025, 1.89756), (0.451863, 1.78718),
    (0.472838, 1.58374), (0.492877, 1.27862), (0.493252, 1.21082), (0.558473, 1.08356),
    (0.646401, 0.998631), (0.833589, 0.87959), (0.988002, 0.828415), (1.30807, 0.759941),
    (1.63918, 0.691442), (1.85998, 0.657076), (2.31288, 0.630693), (2.59998, 0.596186),
    (3.00877, 0.586846), (3.45075, 0.585909), (3.7379, 0.559877), (4.00309, 0.559315),
)  # fmt: skip
"""B / (2 T), C_d."""
HOERNER_RANGE = (_HOERNER[0][0], _HOERNER[-1][0])


@dataclass(frozen=True)
class FloatingHull:
    """One hull, alike fore and aft, of one draught and section fullness.

    Its water line is b(x) = B (1 - |2 x / L|^n), n = C_W / (1 - C_W), a box where C_W = 1; each
    section has the area C_B / C_W b T.
    """

    length: float
    beam: float
    draught: float
    block: float
    """C_B"""
    waterplane: float
    """C_W"""
    across: float = 0.0
    """y of its centre line."""

    @property
    def volume(self) -> float:
        """Displacement, m3."""
        return self.block * self.length * self.beam * self.draught

    @property
    def area(self) -> float:
        """Waterplane, m2."""
        return self.waterplane * self.length * self.beam

    @property
    def fullness(self) -> float:
        """Area of a section over b T."""
        return self.block / self.waterplane

    def beams(self, places: Sequence[float]) -> list[float]:
        """Return b at ``places`` 2 x / L, -1 to 1."""
        if self.waterplane >= 1.0:
            return [self.beam for _ in places]
        n = self.waterplane / (1.0 - self.waterplane)
        return [self.beam * max(1.0 - abs(place) ** n, 0.0) for place in places]

    def over_length(self, of: Callable[[float, float], float]) -> float:
        """Return the integral of ``of(x, b)`` over the length."""
        nodes, weights = _GAUSS
        half = self.length / 2.0
        both = zip(nodes, weights, self.beams(nodes.tolist()), strict=True)
        return half * sum(float(w) * of(float(s) * half, b) for s, w, b in both)


def waterplane_coefficient(block: float) -> float:
    """Return C_W = (1 + 2 C_B) / 3 (Schneekluth & Bertram, Ship Design, 1998)."""
    return (1.0 + 2.0 * block) / 3.0


@dataclass(frozen=True)
class Hydrostatics:
    """Of hulls together, upright."""

    volume: float
    waterplane_area: float
    z_B: float
    """Centre of buoyancy below the water line, m."""
    BM_T: float
    BM_L: float


def hydrostatics(hulls: Sequence[FloatingHull]) -> Hydrostatics:
    """Return BM = I / V of the waterplane, and the centre of buoyancy.

    z_B = T / 6 + V / (3 A) of each hull, from Morrish's KB = (5 T / 2 - V / A) / 3.
    """
    volume = sum(hull.volume for hull in hulls)
    z = sum(hull.volume * (hull.draught / 6.0 + hull.volume / hull.area / 3.0) for hull in hulls)
    across = sum(
        hull.over_length(lambda x, b: b**3 / 12.0) + hull.area * hull.across**2 for hull in hulls
    )
    along = sum(hull.over_length(lambda x, b: b * x**2) for hull in hulls)
    area = sum(hull.area for hull in hulls)
    return Hydrostatics(volume, area, z / volume, across / volume, along / volume)


@dataclass(frozen=True)
class AddedMass:
    """Diagonal of the added mass about the body origin, kg and kg.m2."""

    surge: float
    sway: float
    heave: float
    roll: float
    pitch: float
    yaw: float


def surge_mass(mass: float, length: float, density: float) -> float:
    """Return 2.7 rho V^(5/3) / L^2, kg, V = m / rho (Soeding 1982, as MSS has it)."""
    return float(2.7 * density * (mass / density) ** (5.0 / 3.0) / length**2)


def added_mass(
    hulls: Sequence[FloatingHull],
    density: float,
    roll_section: Callable[[float, float, float], float] = sections.roll_inertia,
) -> AddedMass:
    """Return the added mass by strips of `sections`, hulls without influence on one another.

    Surge by Soeding; sway at low, heave, roll and pitch at high frequency. ``roll_section`` gives
    the added inertia of a section by beam, draught and density.
    """
    total = np.zeros(6)
    for hull in hulls:
        total += _of(hull, density, roll_section)
    return AddedMass(*total.tolist())


def _of(
    hull: FloatingHull, density: float, roll_section: Callable[[float, float, float], float]
) -> Vector:
    T, sigma = hull.draught, hull.fullness

    def heave(x: float, b: float) -> float:
        return sections.heave_mass(b, T, sigma, density)

    def sway(x: float, b: float) -> float:
        return sections.sway_mass(b, T, sigma, density)

    up = hull.over_length(heave)
    roll = hull.over_length(lambda x, b: roll_section(b, T, density))
    return np.array(
        [
            surge_mass(density * hull.volume, hull.length, density),
            hull.over_length(sway),
            up,
            roll + up * hull.across**2,
            hull.over_length(lambda x, b: x**2 * heave(x, b)),
            hull.over_length(lambda x, b: x**2 * sway(x, b)),
        ]
    )


def wetted_surface(hull: FloatingHull) -> float:
    """Return S = 1.025 (V / T + 1.7 L T), m2 (Denny and Mumford)."""
    return 1.025 * (hull.volume / hull.draught + 1.7 * hull.length * hull.draught)


def form_factor(hull: FloatingHull) -> float:
    """Return k = 25.6 C_B / ((L/B)^2 sqrt(B/T)) - 0.095, not below 0 (Watanabe)."""
    slender = (hull.length / hull.beam) ** 2 * math.sqrt(hull.beam / hull.draught)
    return max(25.6 * hull.block / slender - 0.095, 0.0)


def crossflow_coefficient(beam: float, draught: float) -> float:
    """Return the 2-D drag coefficient of a section by B / (2 T) (Hoerner's curve, as MSS has it).

    Held at its ends outside `HOERNER_RANGE`.
    """
    x, y = zip(*_HOERNER, strict=True)
    return float(np.interp(beam / (2.0 * draught), x, y))


def hull_lift(draught: float, density: float) -> float:
    """Return the lift of a hull by speed ahead and across, kg/m: rho pi T^2 / 2.

    A wing of low aspect ratio, doubled at the water line (Jones 1946), that leaves the water at the
    stern: the leading terms of the linear derivatives of Clarke, Gedling & Hine (1983),
    Y_v' = -pi (T/L)^2, N_r' = -pi (T/L)^2 / 4.
    """
    return density * math.pi / 2.0 * draught**2
