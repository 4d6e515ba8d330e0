"""A hull by eight points and eight cells: drag, buoyancy and waves it makes, at the surface too."""

from __future__ import annotations

import itertools
from typing import Any

import casadi as ca

from ....model.component import Component, Parameter
from .context import Context, smooth_step, wrench

_SIGNS = [ca.DM(signs) for signs in itertools.product((1, -1), repeat=3)]


class HullPoints(Component):
    """Mix-in: a box of water that the hull displaces, in eight cells, and eight points of drag.

    Cell i is at r_i = center_of_buoyancy + (+-L, +-B, +-H) / 4, with ``hull_size`` (L, B, H), and
    d_i below the surface. Its share under water is

        s_i = S(1/2 + 2 d_i / H),   S(x) = x^2 (3 - 2 x), x held in 0 to 1

    which is exactly 1 from H/4 below the surface on. The drag point with the same signs has the
    same share. Loads of the whole hull are multiplied by the mean of the shares.
    """

    hull_size = Parameter((1.0, 1.0, 1.0), "m", "length, beam, height", axes="xyz", min=1e-6)
    entrained_volume = Parameter(
        0.0, "m3", "water in the open hull: without weight submerged, lifted above", min=0.0
    )
    point_drag = Parameter(0.0, "N.s2/m2", "quadratic drag by points", axes="uvw", min=0.0)
    drag_center = Parameter(0.0, "m", "middle of the drag points, body axes", axes="xyz")
    drag_spread = Parameter(
        0.0, "m", "drag points from their middle: root of the mean square", axes="xyz", min=0.0
    )
    wave_damping = Parameter(0.0, "N.s/m", "damping of heave at the surface", min=0.0)
    wave_depth = Parameter(0.1, "m", "depth within which that damping falls to 1/e", min=1e-6)


def floating(c: Context) -> Any:
    """Weight at the CG, and the buoyancy of the cells: f_i = -((B + B_e) s_i - B_e) n / 8.

    B is the buoyancy of the hull deep in the water, B_e = density gravity entrained_volume. Deep,
    this is B at the centre of buoyancy. A hull that floats has sum (B + B_e) (1 - s_i) / 8 = B - W.
    """
    p, n = c.parameters, c.vertical
    load = wrench(p.mass * p.gravity * n, p.center_of_gravity)
    entrained = p.density * p.gravity * p.entrained_volume
    for place, share in zip(_cells(c), shares(c), strict=True):
        load += wrench(-((p.buoyancy + entrained) * share - entrained) / 8 * n, place)
    return load


def point_drag(c: Context) -> Any:
    """Drag of strips: f_i = -s_i (d / 8) |v_i| v_i, axis by axis, at eight points.

    v_i is the velocity through the water of the point at ``drag_center`` +- ``drag_spread``, d
    the ``point_drag``. With the spread as root of int y^2 dA / A of the outline,
    force, centre and second moment are those of strips: yaw damping that grows with the speed,
    trim moments, coupling of sway and roll, heave and pitch. Translation alone has -d |v| v.
    """
    p, load = c.parameters, ca.DM.zeros(6)
    for signs, share in zip(_SIGNS, shares(c), strict=True):
        place = p.drag_center + signs * p.drag_spread
        v = c.at(place)
        load += wrench(-share / 8 * p.point_drag * ca.fabs(v) * v, place)
    return load


def wave_making(c: Context) -> Any:
    """Waves made by heave: f_i = -(b / 8) s_i exp(-max(d_i - H/4, 0) / l) (n . v_i) n.

    b = ``wave_damping``, l = ``wave_depth``, n the vertical, v_i the velocity of cell i.
    """
    p, n, load = c.parameters, c.vertical, ca.DM.zeros(6)
    for place, share in zip(_cells(c), shares(c), strict=True):
        below = ca.fmax(c.depth(place) - p.hull_size[2] / 4, 0)
        b = p.wave_damping / 8 * share * ca.exp(-below / p.wave_depth)
        load += wrench(-b * (n.T @ c.at(place)) * n, place)
    return load


def shares(c: Context) -> list[Any]:
    """Return what share of each cell is under water; all of it if the hull does not float."""
    if not c.is_floating:
        return [1] * len(_SIGNS)
    half = c.parameters.hull_size[2] / 2
    return [smooth_step(0.5 + c.depth(place) / half) for place in _cells(c)]


def wet(c: Context) -> Any:
    """Return the share of the hull that is under water."""
    return sum(shares(c)) / len(_SIGNS)


def _cells(c: Context) -> list[Any]:
    return [
        c.parameters.center_of_buoyancy + signs * c.parameters.hull_size / 4 for signs in _SIGNS
    ]
