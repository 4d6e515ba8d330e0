"""Linear coefficients from derivatives against a linear solver and the source's numbers."""

import numpy as np
import pytest

from seatrial_kits.ships.hulls.linear_manoeuvring import LinearDerivatives, linear_coefficients
from tests.kits.ships.mariner import T_D, A, B, K, dimensionless, rudder_effect, ship

MARINER = LinearDerivatives(
    mass=0.00798,
    center_of_gravity=-0.023,
    inertia=0.000392,
    Y_vdot=-0.00748,
    Y_rdot=-0.00009354,
    N_vdot=0.00004646,
    N_rdot=-0.000438,
    Y_v=-0.0116,
    # The published table has Y_r - m and N_r - m x_G.
    Y_r=-0.00499 + 0.00798,
    N_v=-0.00264,
    N_r=-0.00166 - 0.023 * 0.00798,
    Y_delta=0.00278,
    N_delta=-0.00139,
)


def solved(d):
    """Return A* and B* of [Moro1979], eqs 4 and 5, by a linear solver."""
    moment = d.mass * d.center_of_gravity
    M = [[d.mass - d.Y_vdot, moment - d.Y_rdot], [moment - d.N_vdot, d.inertia - d.N_rdot]]
    right = [[d.Y_v, d.Y_r - d.mass, d.Y_delta], [d.N_v, d.N_r - moment, d.N_delta]]
    both = np.linalg.solve(M, right)
    return both[:, :2], both[:, 2]


@pytest.mark.parametrize("seed", range(5))
def test_closed_forms_solve_the_equations(seed):
    values = dict(vars(MARINER))
    generator = np.random.default_rng(seed)
    changed = {name: value * generator.uniform(0.7, 1.3) for name, value in values.items()}
    derivatives = LinearDerivatives(**changed)
    for found, expected in zip(linear_coefficients(derivatives), solved(derivatives), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_derivatives_of_the_mariner_give_the_matrix_of_the_source():
    found, _ = linear_coefficients(MARINER)
    np.testing.assert_allclose(
        found, [[-0.77008219, -0.33495172], [-3.39411916, -2.09281795]], atol=5e-9
    )
    np.testing.assert_allclose(found, A, rtol=2e-3)


def test_rudder_vector_of_the_source_is_25_times_too_large():
    _, found = linear_coefficients(MARINER)
    np.testing.assert_allclose(found, [0.17034447, -1.62749491], atol=5e-9)
    np.testing.assert_allclose(np.divide(B, found), 25.3, atol=0.1)


def test_taking_the_tabulated_derivatives_for_the_hull_s_own_makes_an_unstable_ship():
    twice = LinearDerivatives(**{**vars(MARINER), "Y_r": -0.00499, "N_r": -0.00166})
    poles = np.sort(np.linalg.eigvals(linear_coefficients(twice)[0]))
    np.testing.assert_allclose(poles, [-3.20, 0.417], atol=5e-3)


def test_gain_of_the_source_with_the_right_rudder_is_four_times_too_slow():
    matrix, effect = linear_coefficients(MARINER)
    craft = dimensionless(state_matrix=matrix.ravel(), rudder_vector=effect)
    linear = craft.linearise(np.array([0, 0, 0, 1.0, 0, 0]))
    loop = linear.A[2:, 2:][np.ix_([2, 3, 0], [2, 3, 0])]
    loop += np.outer([*rudder_effect(linear), 0.0], [0.0, K * T_D, K])
    poles = np.sort_complex(np.linalg.eigvals(loop))
    expected = [-2.7169, -0.10771 - 0.10639j, -0.10771 + 0.10639j]
    np.testing.assert_allclose(poles, expected, atol=6e-5)


def test_cubic_model_has_these_coefficients_to_first_order():
    craft = ship("cubic", Y=first_order("Y"), N=first_order("N"))
    straight = np.array([0, 0, 0, 7.7175, 0, 0])
    linear = craft.linearise(straight)
    time, scale = 160.93 / 7.7175, np.array([7.7175, 7.7175 / 160.93])
    found, effect = linear_coefficients(MARINER)
    np.testing.assert_allclose(linear.A[4:, 4:] * scale / scale[:, None] * time, found, rtol=1e-12)
    np.testing.assert_allclose(rudder_effect(linear) / scale * time, effect, rtol=1e-12)


def first_order(port):
    """Return the coefficients of v, r and d alone, without those that break the symmetry."""
    values = ship("cubic").get(port)
    return [value if place in (0, 1, 6) else 0.0 for place, value in enumerate(values)]
