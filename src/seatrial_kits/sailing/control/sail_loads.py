"""Loads of sail and keel as a controller predicts them: plain numbers, from the foil tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

from seatrial.physics.foils import FoilTable


def foil_load(
    table: FoilTable,
    place: Sequence[float],
    flow: tuple[float, float],
    angle: float,
    half_density_area: float,
    flap: float = 0.0,
) -> tuple[float, float, float, float]:
    """Return the load (X, Y, K, N) of a foil whose axis is vertical in body axes, N and N.m.

    [Silva2018], eqs 2.15 to 2.29 for sail and keel alike: with the flow (a, b), m/s, beta =
    atan2(b, a) and alpha = beta - angle + pi,

        (X, Y) = 0.5 density area V^2 (C_D (cos beta, sin beta) + C_L (-sin beta, cos beta))
        K = -z Y,  N = x Y - y X

    ``place`` (x, y, z) is the centre of effort, body axes, m; ``angle`` turns the trailing edge
    from aft to port and ``flap`` is the size of the flap's angle, rad.
    """
    a, b = flow
    x, y, z = place
    c_l, c_d = table.coefficients(math.atan2(b, a) - angle + math.pi, flap)
    scale = half_density_area * math.hypot(a, b)
    X, Y = scale * (c_d * a - c_l * b), scale * (c_d * b + c_l * a)
    return X, Y, -z * Y, x * Y - y * X


def sail_place(axis: Sequence[float], arm: float, angle: float) -> tuple[float, float, float]:
    """Return the centre of effort (x, y, z) of the sail at ``angle``, body axes, m.

    ``axis`` is (x, z) of the sail's axis, ``arm`` the distance of the centre of effort behind
    it: [Silva2018], eq. 2.18.
    """
    x, z = axis
    return x - arm * math.cos(angle), -arm * math.sin(angle), z
