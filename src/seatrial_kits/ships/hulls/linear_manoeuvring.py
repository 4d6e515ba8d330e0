"""Linear manoeuvring equations of a ship, from the derivatives of hull and rudder."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seatrial.model.expressions import Vector


@dataclass(frozen=True)
class LinearDerivatives:
    """Dimensionless derivatives in sway and yaw about midships ([Moro1979], eqs 4 and 5).

    x forward, y starboard, r clockwise from above; a positive ``delta`` gives Y > 0. Y_r and N_r
    are the hull's own: some tables, that of Chislett and Stroem-Tejsen for one, list Y_r - m
    and N_r - m x_G under these names.
    """

    mass: float
    center_of_gravity: float
    inertia: float
    Y_vdot: float
    Y_rdot: float
    N_vdot: float
    N_rdot: float
    Y_v: float
    Y_r: float
    N_v: float
    N_r: float
    Y_delta: float
    N_delta: float


def linear_coefficients(d: LinearDerivatives) -> tuple[Vector, Vector]:
    """Return A* (2, 2) and B* (2,), with d(v, r)/dt = A* (v, r) + B* delta, dimensionless.

    [Moro1979], eqs 6 and 7, in closed form; its A2* x1 in eq. 6 must be A1* x1, dots are lost
    in A3*, A4* and D, and B2* is printed with Y_v, N_v in the place of Y_delta, N_delta.
    What a `ManoeuvringShip` takes as ``state_matrix`` and ``rudder_vector``.

    Raises ZeroDivisionError if the mass matrix is singular.
    """
    moment = d.mass * d.center_of_gravity
    a, b = d.mass - d.Y_vdot, moment - d.Y_rdot
    c, e = moment - d.N_vdot, d.inertia - d.N_rdot
    Y_r, N_r = d.Y_r - d.mass, d.N_r - moment
    D = b * c - e * a
    A = [
        [(d.N_v * b - d.Y_v * e) / D, (N_r * b - Y_r * e) / D],
        [(d.Y_v * c - d.N_v * a) / D, (Y_r * c - N_r * a) / D],
    ]
    B = [(d.N_delta * b - d.Y_delta * e) / D, (d.Y_delta * c - d.N_delta * a) / D]
    return np.array(A), np.array(B)
