"""Formulas of hulls that float: form, hydrostatics, added mass by strips, resistance, cross-flow.

The body origin is amidships in the water line, x ahead, z down; lengths in m, density
in kg/m3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

import numpy as np

from . import sections
from .box import section_inertia

_GAUSS = np.polynomial.legendre.leggauss(20)
_PLACES = np.concatenate([_GAUSS[0] - 1.0, _GAUSS[0] + 1.0]) / 2.0
_WEIGHTS = np.tile(_GAUSS[1], 2) / 2.0
"""Of each half of the length: a water line may have a kink amidships."""
CLARKE_FROM = 5.0
"""L/B from which on `clarke` is taken: KVLCC2 has 5.5."""
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
        half = self.length / 2.0
        both = zip(_PLACES, _WEIGHTS, self.beams(_PLACES.tolist()), strict=True)
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
    """Return 2.7 rho V^(5/3) / L^2, kg, V = m / rho ([Soeding1982], as MSS has it)."""
    return float(2.7 * density * (mass / density) ** (5.0 / 3.0) / length**2)


def clarke(hull: FloatingHull, density: float) -> tuple[float, float]:
    """Return the added mass in sway, kg, and in yaw, kg.m2.

        -Y_v' = pi (T/L)^2 (1 + 0.16 C_B B/T - 5.1 (B/L)^2)                   on rho/2 L^3
        -N_r' = pi (T/L)^2 (1/12 + 0.017 C_B B/T - 0.33 B/L)                  on rho/2 L^5

    Derivatives by acceleration, a regression over models of ships ([Clarke1983]).
    The second is 0 about L/B = 4.
    """
    L, B, T, C_B = hull.length, hull.beam, hull.draught, hull.block
    scale = math.pi * (T / L) ** 2 * 0.5 * density * L**3
    sway = 1.0 + 0.16 * C_B * B / T - 5.1 * (B / L) ** 2
    yaw = 1.0 / 12.0 + 0.017 * C_B * B / T - 0.33 * B / L
    return scale * sway, scale * L**2 * yaw


def added_mass(hull: FloatingHull, density: float, *, box: bool = False) -> AddedMass:
    """Return the added mass of one hull about amidships on the body's centre line.

    Surge by Soeding; heave, roll and pitch by strips of `sections` at high frequency; sway and yaw
    by `clarke`, or by strips at low frequency of a hull with L/B below `CLARKE_FROM`, and of a
    ``box``, whose sections roll as rectangles.
    """
    T, sigma = hull.draught, hull.fullness

    def heave(x: float, b: float) -> float:
        return sections.heave_mass(b, T, sigma, density)

    def across(x: float, b: float) -> float:
        return sections.sway_mass(b, T, sigma, density)

    def roll(x: float, b: float) -> float:
        if box:
            return section_inertia(b, 2.0 * T, density) / 2.0
        return sections.roll_inertia(b, T, density)

    up = hull.over_length(heave)
    if box or hull.length < CLARKE_FROM * hull.beam:
        sway = hull.over_length(across)
        yaw = hull.over_length(lambda x, b: x**2 * across(x, b))
    else:
        sway, yaw = clarke(hull, density)
    return AddedMass(
        surge_mass(density * hull.volume, hull.length, density),
        sway,
        up,
        hull.over_length(roll) + up * hull.across**2,
        hull.over_length(lambda x, b: x**2 * heave(x, b)),
        yaw,
    )


def together(each: Sequence[AddedMass]) -> AddedMass:
    """Return the added mass of hulls without influence on one another."""
    return AddedMass(*map(sum, zip(*(astuple(one) for one in each), strict=True)))


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

    A wing of low aspect ratio, doubled at the water line ([Jones1946]), that leaves the water at
    the stern: the leading terms of the linear derivatives of Clarke, Gedling & Hine [Clarke1983],
    Y_v' = -pi (T/L)^2, N_r' = -pi (T/L)^2 / 4.
    """
    return density * math.pi / 2.0 * draught**2
