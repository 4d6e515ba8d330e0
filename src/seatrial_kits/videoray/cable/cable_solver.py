"""Linear systems of a chain of nodes, and the step in time that needs one."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from seatrial.model.expressions import Vector, bind

from .cable import Cable, Segments, Slopes

_SIZE = 3
_DIRECTIONS = range(_SIZE)


class Elimination:
    """Solver of block-tridiagonal systems of n nodes and three directions, without pivoting.

    The matrix is in ``diagonal`` (3, 3, n), ``upper`` and ``lower`` (3, 3, n - 1): row, column,
    node; upper[..., i] couples node i to i + 1, lower[..., i] node i + 1 to i.

    It is plain arithmetic in a fixed order. Libraries of linear algebra choose their kernels by
    the processor, and a run would differ in the last bit from machine to machine: enough to
    become another run where sensors round.

    Without pivoting it is accurate for matrices whose symmetric part is positive definite, as
    masses with damping and stiffness make.
    """

    def __init__(self, nodes: int) -> None:
        self.diagonal = np.zeros((_SIZE, _SIZE, nodes))
        self.upper = np.zeros((_SIZE, _SIZE, nodes - 1))
        self.lower = np.zeros((_SIZE, _SIZE, nodes - 1))
        self._right, self._solution = np.zeros((_SIZE, nodes)), np.zeros((_SIZE, nodes))
        arrays = (self.diagonal, self.upper, self.lower, self._right)
        flat = [array.reshape(-1) for array in arrays]
        self._buffer, self._evaluate = bind(_elimination(nodes), flat, self._solution.reshape(-1))

    def solve(self, right: Vector) -> Vector:
        """Return the solution (3, n) for ``right`` (3, n); a view, valid until the next.

        Raises ArithmeticError if the matrix is singular.
        """
        self._right[:] = right
        self._evaluate()
        if not np.isfinite(self._solution).all():
            raise ArithmeticError("singular: a pivot is zero")
        return self._solution


@lru_cache(maxsize=16)
def _elimination(nodes: int) -> ca.Function:
    """Return the function from the four flat arrays to the flat solution."""
    sizes = (_SIZE**2 * nodes, _SIZE**2 * (nodes - 1), _SIZE**2 * (nodes - 1), _SIZE * nodes)
    given = [ca.SX.sym(name, size) for name, size in zip("dulr", sizes, strict=True)]
    diagonal, upper, lower = (_blocks(symbols) for symbols in given[:3])
    right = _vectors(given[3], nodes)
    after: list[list[list[Any]]] = []  # rows of D^-1 [U, r] of the nodes so far
    for node in range(nodes):
        block, load = diagonal[node], right[node]
        if node:
            coupling, before = lower[node - 1], after[-1]
            block = [
                [block[i][j] - _sum(coupling[i], [row[j] for row in before]) for j in _DIRECTIONS]
                for i in _DIRECTIONS
            ]
            load = [load[i] - _sum(coupling[i], [row[-1] for row in before]) for i in _DIRECTIONS]
        beyond = upper[node] if node < nodes - 1 else [[], [], []]
        after.append(_reduced([[*block[i], *beyond[i], load[i]] for i in _DIRECTIONS]))
    solution = [[row[-1] for row in after[-1]]]
    for rows in reversed(after[:-1]):
        solution.append([row[-1] - _sum(row[:_SIZE], solution[-1]) for row in rows])
    solution.reverse()
    flat = [solution[node][i] for i in _DIRECTIONS for node in range(nodes)]
    return ca.Function("elimination", given, [ca.vertcat(*flat)])


def _reduced(rows: list[list[Any]]) -> list[list[Any]]:
    """Return A^-1 B from the rows of [A, B] with A square, by elimination."""
    rows = [list(row) for row in rows]
    for pivot in _DIRECTIONS:
        scale = 1.0 / rows[pivot][pivot]
        rows[pivot][pivot + 1 :] = [scale * entry for entry in rows[pivot][pivot + 1 :]]
        for other in _DIRECTIONS:
            if other != pivot:
                factor = rows[other][pivot]
                for column in range(pivot + 1, len(rows[pivot])):
                    rows[other][column] = rows[other][column] - factor * rows[pivot][column]
    return [row[_SIZE:] for row in rows]


def _sum(a: list[Any], b: list[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _blocks(symbols: ca.SX) -> list[list[list[Any]]]:
    """Return the 3 x 3 matrices of an array (3, 3, n) that is given flat."""
    nodes, entries = symbols.numel() // _SIZE**2, symbols.elements()
    return [
        [[entries[(_SIZE * i + j) * nodes + node] for j in _DIRECTIONS] for i in _DIRECTIONS]
        for node in range(nodes)
    ]


def _vectors(symbols: ca.SX, nodes: int) -> list[list[Any]]:
    entries = symbols.elements()
    return [[entries[i * nodes + node] for i in _DIRECTIONS] for node in range(nodes)]


_SWITCHES = 8
"""Repetitions of a step at most, until the segments that it takes for slack are."""


class Chain(Elimination):
    """The block-tridiagonal matrix of N segments between nodes; see `Elimination`."""

    def load(self, apart: Vector, drag: Vector, common: Vector) -> None:
        """Write the matrix that gives minus the forces of N segments on the nodes 1 to n.

        (3, 3, N) each: ``apart`` is what the segment pulls with, ``drag`` what the water presses
        it with, per motion of its far node less its near one; ``common`` what the water resists
        with, per mean motion of the two. n is N - 1, or N with the end at the vehicle free.
        """
        count = self.diagonal.shape[2]
        half, quarter = 0.5 * drag, 0.25 * common
        even, odd = apart + quarter, quarter - apart
        self.diagonal[:] = (even - half)[..., :count]
        rest = apart.shape[2] - 1  # segments that have a near node which is free
        self.diagonal[..., :rest] += (even + half)[..., 1:]
        self.upper[:] = (odd - half)[..., 1:count]
        self.lower[:] = (odd + half)[..., 1:count]

    def dense(self) -> Vector:
        """Return the matrix, (3 n, 3 n): all directions of a node, then those of the next."""
        nodes = self.diagonal.shape[2]
        matrix = np.zeros((nodes, 3, nodes, 3))
        here = np.arange(nodes)
        matrix[here, :, here, :] = self.diagonal.transpose(2, 0, 1)
        matrix[here[:-1], :, here[1:], :] = self.upper.transpose(2, 0, 1)
        matrix[here[1:], :, here[:-1], :] = self.lower.transpose(2, 0, 1)
        return matrix.reshape(3 * nodes, 3 * nodes)


class Moved(NamedTuple):
    """Where a step leads: positions (m) and velocities (m/s), (3, N + 1), and ``pull`` (3, 2), N.

    ``pull`` is the force of the cable on its end at the surface and on that at the vehicle.
    """

    x: Vector
    v: Vector
    pull: Vector


def implicit_step(
    cable: Cable, chain: Chain, x: Vector, v: Vector, current: Vector, h: float
) -> Moved:
    """Advance node positions and velocities (3, N + 1) by ``h`` s in one linearly implicit step.

    Euler's method, with F the nodes' forces, K = dF/dx and D = dF/dv at the beginning:

        (M - h D - h^2 K) (v_new - v) = h (F + h K v),    x_new = x + h v_new

    for the nodes between the ends; the ends move on with their velocities in ``v``. What the end
    segments pull with is F linearised in the same way, F + h K v_new + D (v_new - v): the ends
    get the momentum that the nodes lose. First order in h, and stable at any h as far as the
    linearisation carries. dM/dx is left out, which does not cost the order.

    A segment is slack or taut for a whole step, as it is at its end: with slack as it is at the
    beginning, a light node between a taut and a slack segment would be thrown about. Which ones
    are is found by repetition, seldom more than twice and at most `_SWITCHES` times.

    ``current`` (3, 1) or (3, N), m/s; ``chain`` has N - 1 nodes. Raises ArithmeticError if the
    matrix is singular.
    """
    s = cable.forces(x, v, current)
    masses = cable.masses(s)[..., 1:-1]
    new_v, taut = v.copy(), s.stiffness > 0.0
    for _ in range(_SWITCHES):
        s = cable.switched(s, taut)
        slopes = cable.slopes(s, np.maximum(s.axial, 0.0))
        common = slopes.flow.copy()
        common[:, 2] -= h * slopes.shear
        chain.load(h * (h * slopes.pull + slopes.damping), (h * h) * slopes.drag, h * common)
        chain.diagonal += masses
        right = _carried(cable, s, slopes, v, v, h)[:, 1:-1]
        new_v[:, 1:-1] = v[:, 1:-1] + chain.solve(h * right)
        stretching = np.einsum("ij,ij->j", s.tangent, new_v[:, 1:] - new_v[:, :-1])
        before, taut = taut, s.length - cable.l0 + h * stretching > 0.0
        if np.array_equal(taut, before):
            break
    return Moved(x + h * new_v, new_v, _carried(cable, s, slopes, v, new_v, h)[:, [0, -1]])


def linearised(
    cable: Cable, x: Vector, v: Vector, current: Vector, *, free_end: bool = False
) -> Vector:
    """Return A of d(dx, dv)/dt = A (dx, dv) about a state without net forces, (6 n, 6 n).

    n = N - 1 nodes between fixed ends, or N with the end at the vehicle free; all directions of a
    node, then those of the next; positions, then velocities. At rest dM/dx has no effect.
    """
    s = cable.forces(x, v, current)
    slopes = cable.slopes(s, s.axial)
    chain = Chain(cable.segments if free_end else cable.segments - 1)
    n = 3 * chain.diagonal.shape[2]
    common = np.zeros_like(slopes.drag)
    common[:, 2] = -slopes.shear
    chain.load(slopes.pull, slopes.drag, common)
    stiffness = chain.dense()
    chain.load(slopes.damping, np.zeros_like(slopes.drag), slopes.flow)
    damping = chain.dense()
    inverse = np.zeros((n, n))
    for node, mass in enumerate(cable.masses(s)[..., 1:].T[: n // 3]):
        block = slice(3 * node, 3 * node + 3)
        inverse[block, block] = np.linalg.inv(mass)
    return np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])


def _carried(
    cable: Cable, s: Segments, slopes: Slopes, v: Vector, new_v: Vector, h: float
) -> Vector:
    """Return F + h K v_new + D (v_new - v), the nodes' forces at the end of a step, (3, N + 1)."""
    parting = new_v[:, 1:] - new_v[:, :-1]
    twice = new_v[:, 1:] + new_v[:, :-1]
    pull = s.axial * s.tangent + h * _times(slopes.pull, parting)
    drag = s.drag + h * _times(slopes.drag, parting) + (0.5 * h) * slopes.shear * twice[2]
    if new_v is not v:
        pull += _times(slopes.damping, parting - s.parting)
        drag -= 0.5 * _times(slopes.flow, twice - v[:, 1:] - v[:, :-1])
    return cable.gathered(pull, drag)


def _times(matrices: Vector, vectors: Vector) -> Vector:
    product: Vector = np.einsum("ijk,jk->ik", matrices, vectors)
    return product
