"""Flat outputs of linear systems x' = A(t) x + B(t) tau, and tracking control by them.

[Paulino2015], chapter 4. A flat output F is as many functions of the state as there are inputs,
from which state and inputs follow by differentiation alone. n states, m inputs; matrices are
CasADi expressions, and ``derivative`` returns d/dt of one (zeros for constant matrices).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from seatrial.model.expressions import Vector

Derivative = Callable[[Any], Any]


def kronecker_indices(A: Vector, B: Vector) -> tuple[int, ...]:
    """Return how many columns b_j, A b_j, A^2 b_j, ... of each input j make a basis.

    A (n, n), B (n, m), constant numbers. Input by input, as many as are linearly independent of
    those before ([Paulino2015], algorithm 1, corrected). Their sum is n if the system is
    controllable. The first inputs get the most, and other indices may serve as well: each
    thruster of a `SurfaceVessel` alone moves all of nu, so that these are (3, 0).
    """
    basis = np.empty((len(A), 0))
    counts = []
    for column in np.asarray(B, dtype=float).T:
        before = basis.shape[1]
        for _ in range(len(A)):
            length = np.linalg.norm(column)
            if length == 0.0:
                break
            # Of length 1: the rank is about directions, whatever the units.
            longer = np.column_stack([basis, column / length])
            if np.linalg.matrix_rank(longer) == basis.shape[1]:
                break
            basis, column = longer, A @ column
        counts.append(basis.shape[1] - before)
    return tuple(counts)


def controllability_matrix(A: Any, B: Any, indices: Sequence[int], derivative: Derivative) -> Any:
    """Return C_K (n, n): per input j the columns b_j, (A - d/dt) b_j, ..., indices[j] of them.

    [Paulino2015], eqs 4.11 and 4.13, corrected: the first column of a group is that of B. Its
    binomial form (4.14) holds for constant A only. The indices must add up to n.
    """
    columns = []
    for j, count in enumerate(indices):
        column = B[:, j]
        for _ in range(count):
            columns.append(column)
            column = A @ column - derivative(column)
    return ca.horzcat(*columns)


def flat_output(C_K: Any, indices: Sequence[int], scaling: Sequence[Any]) -> Any:
    """Return the matrix (m, n) of F = alpha S C_K^-1 x, alpha the diagonal of ``scaling``.

    S selects the last column of each group of C_K ([Paulino2015], eq. 4.15 and algorithm 2). F_i
    and its derivatives below order indices[i] do not depend on the inputs.
    """
    inverse = ca.inv(C_K)
    last = np.cumsum(indices) - 1
    rows = [
        factor * inverse[int(row), :] for factor, row in zip(scaling, last.tolist(), strict=True)
    ]
    return ca.vertcat(*rows)


def tracking_gain(
    A: Any,
    B: Any,
    F: Any,
    indices: Sequence[int],
    gains: Sequence[Sequence[Any]],
    derivative: Derivative,
) -> Any:
    """Return G (m, n) of the law tau = G x, with which each flat output decays as wanted:

        F_i^(k) + gains[i][k - 1] F_i^(k - 1) + ... + gains[i][0] F_i = 0,   k = indices[i]

    [Paulino2015], eqs 4.16 to 4.23. With g_0 = row i of ``F`` and g_(j + 1) = g_j' + g_j A,
    F_i^(j) = g_j x below order k, and F_i^(k) = g_k x + g_(k - 1) B tau.
    """
    wanted, effect = [], []
    for i, order in enumerate(indices):
        row = F[i, :]
        total = ca.DM.zeros(1, A.shape[0])
        for j in range(order):
            total = total + gains[i][j] * row
            if j == order - 1:
                effect.append(row @ B)
            row = derivative(row) + row @ A
        wanted.append(total + row)
    return -ca.solve(ca.vertcat(*effect), ca.vertcat(*wanted))
