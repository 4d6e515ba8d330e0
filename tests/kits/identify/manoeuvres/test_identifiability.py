"""Identifiability in linear problems whose covariance is known in closed form."""

import numpy as np
import pytest

from seatrial_kits.identify.manoeuvres.identifiability import identifiability

ROWS, NAMES = 4000, ("a", "b", "c")


def columns(seed=1):
    return np.random.default_rng(seed).standard_normal((ROWS, 3))


def noise(size, seed=2):
    return size * np.random.default_rng(seed).standard_normal(ROWS)


def found_in(jacobian, residual):
    return identifiability(jacobian, residual, [ROWS], NAMES)


def test_all_are_identifiable_where_each_acts_in_its_own_way():
    found = found_in(columns(), noise(0.1))
    assert (found.shown, found.kept, found.pairs) == (NAMES, {}, ())


def test_what_does_not_act_is_kept():
    jacobian = columns()
    jacobian[:, 1] = 0.0
    found = found_in(jacobian, noise(0.1))
    assert found.shown == ("a", "c")
    assert found.kept["b"] > 1e6


def test_of_two_that_act_alike_one_is_kept_and_their_sum_can_be_had():
    jacobian = columns()
    jacobian[:, 1] = 2.0 * jacobian[:, 0]
    found = found_in(jacobian, noise(0.1))
    (pair,) = found.pairs
    assert len(found.shown) == 2
    assert abs(pair.correlation) == pytest.approx(1.0, abs=1e-6)
    # The readings hold a + 2 b alone: first - ratio second, as the one that is kept is a or b.
    assert pair.ratio == pytest.approx(-2.0 if pair.second == "b" else -0.5, rel=1e-6)
    own = 0.1 / np.sqrt(ROWS) * (1.0 if pair.first == "a" else 0.5)
    assert pair.deviation == pytest.approx(own, rel=0.1)


def test_noise_decides_what_is_identifiable():
    jacobian = columns()
    jacobian[:, 2] *= 0.01
    assert found_in(jacobian, noise(0.01)).shown == NAMES
    # Its standard deviation is 0.5 / (0.01 sqrt(4000)), 0.8 of the value.
    found = found_in(jacobian, noise(0.5))
    assert found.shown == ("a", "b")
    assert found.kept["c"] == pytest.approx(0.5 / 0.01 / np.sqrt(ROWS), rel=0.1)


def test_a_pair_that_is_hardly_separable_is_named():
    jacobian = columns()
    jacobian[:, 1] = jacobian[:, 0] + 0.1 * jacobian[:, 1]
    found = found_in(jacobian, noise(0.1))
    assert found.shown == NAMES
    (pair,) = found.pairs
    # Of columns x and x + 0.1 z the estimates correlate by -1 / sqrt(1.01).
    assert pair.correlation == pytest.approx(-1.0 / np.sqrt(1.01), abs=0.002)
