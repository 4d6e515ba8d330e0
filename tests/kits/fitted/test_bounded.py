"""Weighted least squares with bounds, against SciPy's solver and the conditions of the optimum."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from seatrial_kits.fitted.allocation.bounded import weighted_least_squares

EFFORT = 1e-8
NUMBERS = st.integers(0, 2**32 - 1).map(np.random.default_rng)


def problem(draw, columns=16):
    """Return matrix, target, weights and bounds; columns and rows may repeat or be 0."""
    m, n = draw.integers(1, 7), draw.integers(1, columns + 1)
    matrix = draw.normal(size=(m, n))
    matrix[:, draw.integers(n)] *= draw.integers(2)
    matrix[:, draw.integers(n)] = matrix[:, draw.integers(n)]
    matrix[draw.integers(m)] = matrix[draw.integers(m)]
    wanted = draw.normal(size=m) * draw.choice([0.0, 0.1, 1.0, 10.0, 100.0])
    low = -draw.uniform(0.0, 1.0, n) * draw.integers(2, size=n)
    return matrix, wanted, 10 ** draw.uniform(0, 2, m), low, draw.uniform(0.1, 1.0, n)


def stacked(matrix, wanted, weights):
    n = matrix.shape[1]
    above = np.vstack([weights[:, None] * matrix, np.sqrt(EFFORT) * np.eye(n)])
    return above, np.concatenate([weights * wanted, np.zeros(n)])


def solved(matrix, wanted, weights, low, high):
    numbers = (own.tolist() for own in (matrix.T, wanted, weights, low, high))
    columns, target, weight, *bounds = numbers
    effort = [EFFORT] * len(columns)
    return np.array(weighted_least_squares(columns, target, weight, effort, *bounds))


@given(NUMBERS)
def test_the_least_squares_are_those_of_scipy(draw):
    matrix, wanted, weights, low, high = problem(draw)
    found = solved(matrix, wanted, weights, low, high)
    a, b = stacked(matrix, wanted, weights)
    theirs = lsq_linear(a, b, (low, high), method="bvls", tol=1e-15, max_iter=1000).x
    least, own = (np.sum((a @ x - b) ** 2) for x in (theirs, found))
    assert own <= least + 1e-9 * max(least, 1e-6)


@example(np.random.default_rng(150))  # a column of 0, and a target that nothing meets
@given(NUMBERS)
def test_the_gradient_leads_out_of_every_active_bound_and_vanishes_elsewhere(draw):
    matrix, wanted, weights, low, high = problem(draw)
    x = solved(matrix, wanted, weights, low, high)
    assert ((low <= x) & (x <= high)).all()
    a, b = stacked(matrix, wanted, weights)
    descent = a.T @ (b - a @ x)
    # Orthogonal transformations leave errors of the norms, not of each number; the solver allows
    # 1e-12 of the largest gradient beside them.
    sizes = np.linalg.norm(a, axis=0).max(), np.linalg.norm(a) * np.linalg.norm(x)
    rounding = 2e-12 * sizes[0] * (np.linalg.norm(b) + sizes[1])
    assert (descent[x < high] <= rounding).all()
    assert (descent[x > low] >= -rounding).all()


def test_what_one_cannot_give_the_other_gives():
    found = solved(np.ones((1, 2)), np.ones(1), np.ones(1), -np.ones(2), np.array([0.2, 1.0]))
    np.testing.assert_allclose(found, [0.2, 0.8], atol=1e-7)


def test_what_cannot_be_given_is_shared_by_the_squares_of_the_weights():
    # w1^2 (4 - x) = w2^2 x
    weights, bound = np.array([1.0, 3.0]), np.ones(1)
    found = solved(np.ones((2, 1)), np.array([4.0, 0.0]), weights, -bound, bound)
    np.testing.assert_allclose(found, 0.4, rtol=1e-7)


def test_equal_columns_take_equal_shares():
    found = solved(np.ones((1, 4)), np.array([2.0]), np.ones(1), -np.ones(4), np.ones(4))
    np.testing.assert_allclose(found, 0.5, rtol=1e-7)


def test_bounds_that_are_alike_fix_a_variable():
    low, high = np.array([0.3, -1.0]), np.array([0.3, 1.0])
    found = solved(np.ones((1, 2)), np.array([1.0]), np.ones(1), low, high)
    np.testing.assert_allclose(found, [0.3, 0.7], atol=1e-7)


def test_nothing_to_find_is_nothing_found():
    assert solved(np.ones((2, 0)), np.ones(2), np.ones(2), np.ones(0), np.ones(0)).size == 0


@pytest.mark.parametrize("demand", [1e-3, 1.0, 1e6])
def test_the_same_problem_gives_the_same_bits(demand):
    matrix, _, weights, low, high = problem(np.random.default_rng(5))
    runs = [solved(matrix, np.full(len(matrix), demand), weights, low, high) for _ in range(2)]
    assert (runs[0] == runs[1]).all()
