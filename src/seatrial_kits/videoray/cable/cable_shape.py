"""Static shapes of a cable: where a run begins."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from seatrial.model.expressions import Vector

from .cable import Cable
from .cable_solver import Chain

_ITERATIONS = 60
_STRIDE = 0.2
"""No node moves by more than this share of the cable's length in one iteration."""
_LEAST = 0.1
"""No estimate of a tension falls below this share of the one before."""
_SETTLED = 1e-10
"""The iteration ends when no node moves by more than this share of the cable's length."""
_RESOLVED = 1e-12
"""Tensions below this share of EA drown in the round-off of the segments' lengths."""


def hanging_shape(cable: Cable, surface: Vector, force: Vector, current: Vector) -> Vector:
    """Return the shape at rest, (3, N + 1), m, {n}, of a cable with its far end free.

    ``surface`` (3,), m, holds the near end, ``force`` (3,), N, pulls at the far one, on which half
    a segment's weight and drag act too; ``current`` (3, 1) or (3, N), m/s. Raises ArithmeticError
    if no shape is found.
    """
    pull = math.hypot(*force)
    if not pull:
        raise ArithmeticError("a cable that nothing pulls at may rest anywhere")
    shares = np.linspace(0.0, 1.0, cable.segments + 1)
    x = surface[:, None] + np.outer(force, cable.length / pull * shares)
    found = _settled(cable, x, np.zeros_like(x), current, pull, force)
    if found is None:
        raise ArithmeticError(f"no shape at rest found in {_ITERATIONS} iterations")
    return found


def static_shape(
    cable: Cable, surface: Vector, vehicle: Vector, v: Vector, current: Vector
) -> Vector:
    """Return the shape, (3, N + 1), m, {n}, in which a cable between two ends has no net force.

    ``surface`` and ``vehicle`` (3,), m, are the ends; ``v`` (3, N + 1), m/s, the velocities at
    which the nodes' forces are to vanish: a cable towed at one speed rests in its own frame.

    Where that shape is not found (a loose cable along the flow, or over and under itself), or no
    load decides (a neutral cable in still water), it is the arc of a circle from which
    the search begins: unstretched, and bulging to where most of the load would push it.
    """
    x = np.linspace(surface, vehicle, cable.segments + 1).T
    straight = cable.forces(x, v, current, compression=True)
    load = cable.length * np.mean(straight.drag / straight.length, axis=1)
    load[2] += cable.weight.sum()
    tension = float(straight.tension.mean())
    if tension < 0.0:
        x, radius = _arc(cable, surface, vehicle, load)
        tension = math.hypot(*load) / cable.length * radius
    if tension < _RESOLVED * cable.axial_stiffness:
        return x
    found = _settled(cable, x, v, current, tension, None)
    return x if found is None else found


def _settled(
    cable: Cable, x: Vector, v: Vector, current: Vector, tension: float, force: Vector | None
) -> Vector | None:
    """Return the shape at rest near ``x``, None if there is none; ``force`` is at a free end.

    Newton's method with positions and tensions as unknowns. EA is so large that tensions which
    follow from positions are wrong by far until the very end: so the tension that turns with a
    segment is an unknown of its own, which starts at ``tension`` and ends at EA (Ls - l0) / l0.
    Segments push as they pull: the polygon that best fits an arc is shorter than the cable.
    """
    free = slice(1, None if force is not None else -1)
    chain = Chain(cable.segments - (force is None))
    tensions = np.full(cable.segments, tension)
    for _ in range(_ITERATIONS):
        s = cable.forces(x, v, current, compression=True)
        slopes = cable.slopes(s, tensions)
        unbalanced = cable.node_forces(s)
        if force is not None:
            unbalanced[:, -1] += force
        common = np.zeros_like(slopes.drag)
        common[:, 2] = -slopes.shear
        chain.load(slopes.pull, slopes.drag, common)
        move = np.zeros_like(x)
        try:
            move[:, free] = chain.solve(unbalanced[:, free])
        except ArithmeticError:
            return None
        furthest = float(np.abs(move).max())
        if not math.isfinite(furthest):
            return None
        share = min(1.0, _STRIDE * cable.length / furthest) if furthest else 1.0
        stretch = np.einsum("ij,ij->j", s.tangent, move[:, 1:] - move[:, :-1])
        wanted = s.tension + cable.spring * stretch
        tensions = np.maximum(tensions + share * (wanted - tensions), _LEAST * tensions)
        x = x + share * move
        if furthest < _SETTLED * cable.length:
            return x
    return None


def _arc(cable: Cable, surface: Vector, vehicle: Vector, load: Vector) -> tuple[Vector, float]:
    """Return nodes of unstretched segments on an arc between the ends (3, N + 1), and its radius.

    The arc bulges to the side of ``load``, or down, or north.
    """
    n = cable.segments
    chord = math.hypot(*(vehicle - surface))
    along = (vehicle - surface) / chord if chord else np.array([1.0, 0.0, 0.0])
    side = _across(load, along)
    for direction in ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0)):
        if math.hypot(*side) <= 1e-6 * math.hypot(*load):
            side = _across(np.array(direction), along)
    side = side / math.hypot(*side)

    def missing(half: float) -> float:
        return cable.l0 * math.sin(half) / math.sin(half / n) - chord

    # Half of the angle that the arc spans: all of a circle if the ends are in one place.
    half = brentq(missing, 1e-9, math.pi) if missing(math.pi) < 0.0 else math.pi
    angles = half * (1.0 - (2.0 * np.arange(n) + 1.0) / n)
    cos, sin = ([f(angle) for angle in angles] for f in (math.cos, math.sin))
    turns = np.outer(along, cos) + np.outer(side, sin)
    x = np.cumsum(np.column_stack((surface, cable.l0 * turns)), axis=1)
    x[:, -1] = vehicle
    return x, 0.5 * cable.length / half


def _across(vector: Vector, along: Vector) -> Vector:
    return vector - math.fsum(vector * along) * along
