"""[Paulino2015]'s method where it must be exact, and where its printed forms are not.

Exact derivatives are those of the equations of motion, at random states: nothing is integrated.
"""

import numpy as np
import pytest

from seatrial_kits.identify.source_method import (
    correlation_delay,
    differences,
    integrated,
    least_squares_axis,
    normalised_least_squares,
    planar_least_squares,
    source_method,
    thrust_at_top_speed,
)

TABLE_7_5 = {"m11": 195.0161, "m22": 128.8351, "m33": 643.9295, "d22": 89.6261}
E1, E2 = -0.5055, 49.4372


def one_axis(seed=0):
    random = np.random.default_rng(seed)
    return random.uniform(-0.3, 0.3, 400), random.uniform(-1.0, 1.0, 400)


@pytest.mark.parametrize("offset", [False, True])
def test_one_axis_with_exact_derivatives(offset):
    command, nu = one_axis()
    truth = np.array([-0.1125, -2.37, 0.05 if offset else 0.0, 11.07])
    acceleration = np.column_stack([nu, np.abs(nu) * nu, np.ones(400), command]) @ truth
    found = np.array(least_squares_axis(command, nu, acceleration, offset=offset))
    np.testing.assert_allclose(found, truth, rtol=3e-14, atol=1e-15)


def test_quadratic_thrust_reverses_and_the_printed_one_does_not():
    """Eq. 5.10 prints beta^2: on symmetric commands it explains next to nothing."""
    command, nu = one_axis()
    acceleration = -0.5 * nu + 40.0 * command * np.abs(command)
    *_, thrust = least_squares_axis(command * np.abs(command), nu, acceleration, offset=False)
    assert thrust == pytest.approx(40.0, rel=1e-13)
    printed = np.column_stack([nu, np.abs(nu) * nu, command**2])
    left = acceleration - printed @ normalised_least_squares(printed, acceleration)
    assert 1.0 - left.var() / acceleration.var() < 0.1


def test_drag_of_the_wrong_sign_is_forced_to_zero():
    command, nu = one_axis()
    acceleration = 0.3 * nu - 2.0 * np.abs(nu) * nu + 11.0 * command
    B, C, D, E = least_squares_axis(command, nu, acceleration, offset=False)
    assert (B, D) == (0.0, 0.0)
    rest = np.column_stack([np.abs(nu) * nu, command])
    np.testing.assert_allclose([C, E], np.linalg.lstsq(rest, acceleration, rcond=None)[0])


def test_columns_are_divided_by_their_largest_absolute_value():
    """Eq. 5.14 prints max(): 0 for a command that is never positive."""
    command = -np.abs(one_axis()[0])
    command[0] = 0.0
    assert normalised_least_squares(command[:, None], 3.0 * command)[0] == pytest.approx(3.0)
    nothing = normalised_least_squares(np.column_stack([command, 0 * command]), 3.0 * command)
    np.testing.assert_allclose(nothing, [3.0, 0.0])


def test_integration_rules():
    rate = np.array([1.0, 2.0, 4.0])
    np.testing.assert_allclose(integrated(rate, 0.5, "left"), [0.0, 0.5, 1.5])
    np.testing.assert_allclose(integrated(rate, 0.5, "trapezoid"), [0.0, 0.75, 2.25])


def test_differences_are_exact_for_a_parabola():
    t = np.arange(20) * 0.1
    rate, second = differences(1.0 + 2.0 * t + 3.0 * t**2, 0.1)
    np.testing.assert_allclose(rate[1:-1], (2.0 + 6.0 * t)[1:-1], atol=1e-12)
    np.testing.assert_allclose(second, 6.0, atol=1e-10)


def test_delay_of_a_shifted_signal_is_found_whatever_its_sign():
    command = np.random.default_rng(4).normal(size=500) + 3.0
    later = np.concatenate([np.full(6, 3.0), command[:-6]])
    assert correlation_delay(command, later, 10) == 6
    assert correlation_delay(command, -later, 10) == 6


def test_method_needs_one_reading():
    with pytest.raises(ValueError, match="either an acceleration or an angle"):
        source_method(np.ones(5), 0.1, longest_delay=1)


# ---------------------------------------------------------------------- surge, sway and yaw


def surface_vessel(arm=1.0, seed=0):
    """Return states, their exact derivatives and commands of eq. 5.18 with table 7.5."""
    random = np.random.default_rng(seed)
    nu, commands = random.uniform(-0.5, 0.5, (300, 3)), random.uniform(-0.3, 0.3, (300, 2))
    (u, v, r), (t1, t2) = nu.T, commands.T
    m11, m22, m33, d22 = TABLE_7_5.values()
    X, N = E1 * t1 + E2 * t2, arm * (E1 * t1 - E2 * t2)
    slopes = [
        (X + m22 * v * r) / m11,
        (-d22 * v - m11 * u * r) / m22,
        (N + (m11 - m22) * u * v) / m33,
    ]
    return nu, np.column_stack(slopes), commands


@pytest.mark.parametrize("arm", [1.0, 0.1])
def test_three_degrees_of_freedom_with_exact_derivatives(arm):
    nu, slopes, commands = surface_vessel(arm)
    found = planar_least_squares(
        nu, slopes, commands, m11=TABLE_7_5["m11"], m33=TABLE_7_5["m33"], arm=arm
    )
    truth = np.array([TABLE_7_5["m22"], TABLE_7_5["d22"], E1, E2])
    # Rounding of the rows, relative to the largest unknown (E1 is 250 times smaller).
    error = np.array([found.m22, found.d22, found.E1, found.E2]) - truth
    assert np.abs(error).max() < 2e-15 * 20 * np.abs(truth).max() / arm


def test_the_printed_signs_of_5_20_do_not_give_back_what_made_the_data():
    """Its third row has - m11 u v on the right: with exact data mass and drag are off by half."""
    nu, slopes, commands = surface_vessel()
    (u, v, r), (u_dot, v_dot, r_dot), (t1, t2) = nu.T, slopes.T, commands.T
    m11, m22, m33, d22 = TABLE_7_5.values()
    none = np.zeros_like(u)
    rows = [
        np.column_stack([-v * r, none, -t1, -t2]),
        np.column_stack([v_dot, v, none, none]),
        np.column_stack([u * v, none, -t1, t2]),
    ]
    right = [-m11 * u_dot, -m11 * u * r, -m33 * r_dot - m11 * u * v]
    found = normalised_least_squares(np.vstack(rows), np.concatenate(right))
    assert found[0] < 0.6 * m22
    assert found[1] < 0.6 * d22


def test_thrust_at_top_speed_is_the_source_s():
    """93.4127 N: C_d S = 0.04002 m2 at 4.2 knots in fresh water (4 digits)."""
    assert thrust_at_top_speed(1000.0, 0.04002, 4.2 * 1852 / 3600) == pytest.approx(93.4127, 1e-4)
