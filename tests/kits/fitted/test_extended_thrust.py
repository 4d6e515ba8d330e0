"""Extended thrust within circles, against SciPy's sequential quadratic programming."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from seatrial_kits.fitted.allocation.extended_thrust import (
    EFFORT,
    Demand,
    Shares,
    Vector,
    components,
)

PLACES = {
    "two aft, one forward": [(-8.0, 2.0), (-8.0, -2.0), (9.0, 0.0)],
    "two aft": [(-35.0, 5.0), (-35.0, -5.0)],
    "one aft": [(-5.0, 0.0)],
}
TUNNELS = np.array([[0.0, 0.0], [1.0, 1.0], [25.0, 30.0]])
"""Two tunnels forward: columns (X, Y, N) of their shares."""
WEIGHTS = np.array([1.0, 1.0, 900.0])


def problem(where, draw):
    """Return a demand, up to 20 times what there is, the tunnels, and the propulsors that turn."""
    places = np.array(PLACES[where])
    sizes = draw.uniform(0.5, 3.0, len(places))
    along = sizes * np.stack([np.ones(len(places)), np.zeros(len(places)), -places[:, 1]])
    abeam = sizes * np.stack([np.zeros(len(places)), np.ones(len(places)), places[:, 0]])
    most = np.abs(np.hstack([TUNNELS, along, abeam])).sum(axis=1)
    wanted = draw.normal(size=3) * most * draw.choice([0.05, 0.5, 1.0, 3.0, 20.0])
    others = Shares(TUNNELS, -np.ones(2), np.ones(2))
    return Demand(wanted, WEIGHTS / most), others, along, abeam


def objective(demand, columns):
    """Return |W (B x - tau)|^2 + eps |x|^2 by |W tau|^2, and its gradient."""
    size = np.sum((demand.weights * demand.wanted) ** 2)
    weighted = demand.weights[:, None] * columns

    def value(x):
        rest = weighted @ x - demand.weights * demand.wanted
        return (rest @ rest + EFFORT * x @ x) / size

    def gradient(x):
        rest = weighted @ x - demand.weights * demand.wanted
        return 2.0 * (weighted.T @ rest + EFFORT * x) / size

    return value, gradient


def best(demand, others, along, abeam, first):
    """Return SciPy's optimum: shares of the others, then components along and abeam."""
    count = along.shape[1]
    value, gradient = objective(demand, np.hstack([others.columns, along, abeam]))
    circles = [
        {"type": "ineq", "fun": lambda x, i=i: 1.0 - x[i] ** 2 - x[i + count] ** 2}
        for i in range(2, 2 + count)
    ]
    options = {"ftol": 1e-15, "maxiter": 500}
    bounds = [(-1, 1)] * len(first)
    found = minimize(
        value, first, jac=gradient, bounds=bounds, constraints=circles, method="SLSQP",
        options=options,
    )  # fmt: skip
    return found.x, value


def found_components(demand, others, along, abeam, starts):
    """Return the components, k by 2, of propulsors with columns ``along`` and ``abeam``."""
    shares = Shares(others.columns.T.tolist(), others.low.tolist(), others.high.tolist())
    rows = zip(along.T.tolist(), abeam.T.tolist(), starts, strict=True)
    parts = [Vector(*row, turns=True, low=-1.0, high=1.0) for row in rows]
    return np.array(components(Demand(*(d.tolist() for d in demand)), shares, parts))


@pytest.mark.parametrize("where", PLACES)
@given(st.integers(0, 2**32 - 1), st.floats(-np.pi, np.pi))
def test_it_is_the_optimum(where, seed, start):
    demand, others, along, abeam = problem(where, np.random.default_rng(seed))
    starts = np.full(along.shape[1], start)
    forces = found_components(demand, others, along, abeam, starts)
    assert np.hypot(*forces.T).max() <= 1.0 + 1e-12
    # The tunnels' shares that go with these forces, by SciPy: the forces are fixed.
    mine = np.concatenate([np.zeros(2), forces[:, 0], forces[:, 1]])
    theirs, value = best(demand, others, along, abeam, 0.9 * mine)
    own = minimize(
        lambda shares: value(np.concatenate([shares, mine[2:]])), theirs[:2], bounds=[(-1, 1)] * 2,
        tol=1e-14,
    )  # fmt: skip
    assert own.fun <= value(theirs) + 1e-6


def test_a_single_one_gives_what_is_nearest_within_its_circle():
    along, abeam = np.array([[2.0], [0.0]]), np.array([[0.0], [2.0]])
    none = Shares(np.zeros((2, 0)), np.zeros(0), np.zeros(0))
    for angle in np.linspace(-3.0, 3.0, 13):
        wanted = 50.0 * np.array([np.cos(angle), np.sin(angle)])
        (force,) = found_components(Demand(wanted, np.ones(2)), none, along, abeam, np.zeros(1))
        np.testing.assert_allclose(force, wanted / 50.0, atol=1e-6)
