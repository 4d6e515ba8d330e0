"""Formulas of torpedo-shaped bodies: drag ahead, lift of the body, roll damping.

Lengths in m, the body's axis along x; forces in N. Displaced mass, inertia and Lamb's factors of
added mass are those of `seatrial.physics.craft.terms.spheroid`.
"""

from __future__ import annotations

import math

SLENDER = (6.7, 10.0)
"""Length / diameter of the bodies of `body_lift`."""


def wetted_area(length: float, diameter: float) -> float:
    """Return the surface of a prolate spheroid, m2: 2 pi b^2 (1 + a / (b e) asin e).

    a = length / 2, b = diameter / 2, e^2 = 1 - (b / a)^2; a sphere has 4 pi b^2.
    """
    a, b = length / 2.0, diameter / 2.0
    e = math.sqrt(1.0 - (b / a) ** 2)
    stretch = math.asin(e) / e if e > 0.0 else 1.0
    return 2.0 * math.pi * b**2 * (1.0 + a / b * stretch)


def bare_hull_drag(friction: float, length: float, diameter: float, density: float) -> float:
    """Return X_u|u| of a streamlined body without fins or sensors, kg/m, positive.

        rho / 2 S C_f (1 + 1.5 (d/l)^1.5 + 7 (d/l)^3)

    S of `wetted_area` (Hoerner, Fluid-Dynamic Drag, 1965, ch. VI; turbulent boundary layer).
    ``friction`` is C_f.
    """
    slim = diameter / length
    form = 1.0 + 1.5 * slim * math.sqrt(slim) + 7.0 * slim**3
    return 0.5 * density * wetted_area(length, diameter) * friction * form


def frontal_drag(coefficient: float, diameter: float, density: float) -> float:
    """Return X_u|u| by the frontal area, kg/m, positive: rho / 2 C_D pi d^2 / 4."""
    return 0.5 * density * coefficient * math.pi / 4.0 * diameter**2


def body_lift(length: float, diameter: float, density: float) -> float:
    """Return the lift of the body by speed ahead and across, kg/m: rho / 2 d^2 c.

    c = 0.003 (l/d) 180 / pi, 1/rad, for l/d of 6.7 to 10, held at the ends of that range (Hoerner
    & Borst, Fluid-Dynamic Lift, 1985, as Prestero, MIT 2001, takes it). It acts at 0.65 l from the
    nose: 0.15 l abaft the middle.
    """
    ratio = min(max(length / diameter, SLENDER[0]), SLENDER[1])
    return 0.5 * density * diameter**2 * math.degrees(0.003 * ratio)


def cylinder_drag(
    length: float, diameter: float, density: float, coefficient: float
) -> tuple[float, float]:
    """Return the quadratic drag of a flow across, and that of turning about the middle.

    rho / 2 C d l, kg/m, and rho / 2 C d l^4 / 32, kg.m2: strips of one width, each with |x r| x r.
    """
    a = 0.5 * density * coefficient * diameter
    return a * length, a * length**4 / 32.0


def ratio_damping(ratio: float, stiffness: float, inertia: float) -> float:
    """Return the linear damping of a damping ratio: 2 zeta sqrt(k M)."""
    return 2.0 * ratio * math.sqrt(stiffness * inertia)
