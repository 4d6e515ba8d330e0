"""Formulas of rectangular boxes deep in the water: added mass, added inertia, drag.

A box has the ``depth`` h along the motion and a face of ``a`` by ``b`` across it, m.
"""

from __future__ import annotations

import math

import numpy as np

_PLATE = (
    (1.0, 0.579), (1.25, 0.642), (1.5, 0.690), (1.59, 0.704), (2.0, 0.757), (2.5, 0.801),
    (3.0, 0.830), (3.17, 0.840), (4.0, 0.872), (5.0, 0.897), (6.25, 0.917), (8.0, 0.934),
    (10.0, 0.947),
)  # fmt: skip
"""Longer / shorter side of a rectangular plate: C_A on rho pi / 4 a^2 b, a the shorter."""
_TURNING = ((1.0, 0.234), (2.0, 0.15), (5.0, 0.15), (10.0, 0.147))
"""Longer / shorter side of a rectangle that turns about its middle: on rho pi c^4, c half of it."""
_RECTANGLE = ((0.1, 2.23), (0.2, 1.98), (0.5, 1.70), (1.0, 1.51), (2.0, 1.36), (5.0, 1.21),
              (10.0, 1.14))  # fmt: skip
"""Side across / side along the motion of a rectangle: C_A on rho pi (half the side across)^2."""
_DRAG = ((0.0, 1.16), (1.0, 1.15), (1.5, 0.97), (2.0, 0.87), (2.5, 0.90), (3.0, 0.93), (4.0, 0.95),
         (5.0, 0.95))  # fmt: skip
"""Depth / side of a square rod along the flow: C_D on the face; 0: a square plate."""
PLATES, DRAGS = (1.0, 10.0), (0.0, 5.0)
"""Ranges of the tables."""


def _table(rows: tuple[tuple[float, float], ...], at: float) -> float:
    x, y = zip(*rows, strict=True)
    return float(np.interp(at, x, y))


def added_mass(depth: float, a: float, b: float, density: float) -> float:
    """Return the added mass of a box along its depth, kg.

        A = (1 + sqrt((1 - s^2) / (2 (1 + s^2)))) A_0,   s = sqrt(a b) / (h + sqrt(a b))

    A_0 = C_A rho pi / 4 a^2 b of the plate of its face, a <= b (DNV-RP-H103, 2011: section 4.6.3
    of bodies with vertical sides, table A-2 of plates, 1 <= b/a <= 10).
    """
    short, long = sorted((a, b))
    plate = _table(_PLATE, long / short) * density * math.pi / 4.0 * short**2 * long
    side = math.sqrt(a * b)
    s = side / (depth + side)
    return plate * (1.0 + math.sqrt((1.0 - s**2) / (2.0 * (1.0 + s**2))))


def section_mass(along: float, across: float, density: float) -> float:
    """Return the added mass per length of a rectangle in an endless fluid, kg/m.

    C_A rho pi (across / 2)^2 (DNV-RP-H103, 2011, table A-1; 0.1 <= across / along <= 10).
    """
    return _table(_RECTANGLE, across / along) * density * math.pi * (across / 2.0) ** 2


def section_inertia(a: float, b: float, density: float) -> float:
    """Return the added inertia per length of a rectangle a x b that turns, kg.m.

    beta rho pi c^4, c half of the longer side (DNV-RP-H103, 2011, table A-1; sides of 1 to 10).
    """
    short, long = sorted((a, b))
    return _table(_TURNING, long / short) * density * math.pi * (long / 2.0) ** 4


def added_inertia(
    length: float, beam: float, height: float, density: float
) -> tuple[float, float, float]:
    """Return the added inertia of a box about x, y, z, kg.m2.

    Strips of `section_inertia`, times one share of three dimensions,

        lambda = sqrt(A_11 / (height a_11))

    with A_11 of `added_mass` and a_11 of `section_mass` in surge, seen from above (Eidsvik,
    Identification of Hydrodynamic Parameters for Remotely Operated Vehicles, NTNU 2015).
    """
    flat = height * section_mass(length, beam, density)
    share = math.sqrt(added_mass(length, beam, height, density) / flat)
    strips = (
        length * section_inertia(beam, height, density),
        beam * section_inertia(length, height, density),
        height * section_inertia(length, beam, density),
    )
    return share * strips[0], share * strips[1], share * strips[2]


def drag(depth: float, a: float, b: float, density: float) -> float:
    """Return the quadratic drag of a box along its depth, kg/m: rho / 2 C_D a b.

    C_D of a square rod along the flow by depth / sqrt(a b), 0 to 5 (DNV-RP-C205, 2010, table E-1).
    """
    return 0.5 * density * drag_coefficient(depth, a, b) * a * b


def drag_coefficient(depth: float, a: float, b: float) -> float:
    """Return C_D of `drag`."""
    return _table(_DRAG, depth / math.sqrt(a * b))


def turning_drag(
    length: float, beam: float, height: float, density: float, covers: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return the quadratic drag of turning about x, y, z, kg.m2, by strips of the four sides.

    About z: rho / 2 height (c_y C_y length^4 + c_x C_x beam^4) / 32, C of `drag_coefficient`, c the
    shares of the faces that are filled.
    """
    x = covers[0] * drag_coefficient(length, beam, height)
    y = covers[1] * drag_coefficient(beam, length, height)
    z = covers[2] * drag_coefficient(height, length, beam)
    a = 0.5 * density / 32.0
    return (
        a * length * (z * beam**4 + y * height**4),
        a * beam * (z * length**4 + x * height**4),
        a * height * (y * length**4 + x * beam**4),
    )


def projected(covers: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the factors of the added mass along x, y, z of a body that fills its box in part.

    ``covers`` c are the shares of the faces across x, y, z that are filled: c_x^2 c_y c_z along x,
    and so on; that of the added inertia is c_x c_y c_z ([Eidsvik2015]).
    """
    product = covers[0] * covers[1] * covers[2]
    return product * covers[0], product * covers[1], product * covers[2]


def inertia(mass: float, length: float, beam: float, height: float) -> tuple[float, float, float]:
    """Return the inertia of an even box about its middle, kg.m2: m (b^2 + h^2) / 12 about x."""
    x, y, z = length**2, beam**2, height**2
    return mass * (y + z) / 12.0, mass * (x + z) / 12.0, mass * (x + y) / 12.0
