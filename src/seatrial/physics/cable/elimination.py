"""Direct solver of block-tridiagonal systems, written out for each number of blocks."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from ...model.expressions import Vector, bind

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
