"""Inputs of the steps of a prediction keep the impulse of what was replayed."""

from __future__ import annotations

import numpy as np

from seatrial_kits.identify.manoeuvres.replay import Inputs


def test_the_impulse_of_each_step_is_kept():
    """A thrust that jumps and settles, 10 ms apart, in steps of 25 ms: by closed form."""
    lag, time = 0.1, np.arange(0.005, 2.0, 0.01)
    thrust = np.where(time < 0.5, 0.0, 100.0 * (1.0 - np.exp(-(time - 0.5) / lag)))
    edges = np.arange(0.0, 1.99, 0.025)
    found = Inputs(time, np.column_stack((thrust, 2.0 * time + 1.0))).means(edges)
    assert found.shape == (2, len(edges) - 1)
    impulse = np.cumsum(found * np.diff(edges), axis=1)
    past = np.maximum(edges[1:] - 0.5, 0.0)
    exact = 100.0 * (past - lag * (1.0 - np.exp(-past / lag)))
    # Trapezia of 10 ms: h^2 / 12 of the change of the slope, 1000 N/s, of which the jump has all.
    np.testing.assert_allclose(impulse[0], exact, atol=2.0 * 0.01**2 / 12.0 * 1000.0)
    inside = edges[1:-1] + 0.0125
    np.testing.assert_allclose(found[1][1:], 2.0 * inside + 1.0, rtol=1e-12)


def test_a_held_input_stands_until_the_next_time():
    """Steps that begin within, at and beyond the times of a held input: areas by hand."""
    held = Inputs(np.array([0.0, 0.1, 0.2]), np.array([[1.0], [3.0], [-2.0]]), is_held=True)
    found = held.means(np.array([0.0, 0.05, 0.15, 0.2, 0.4]))
    np.testing.assert_allclose(found, [[1.0, (0.05 * 1.0 + 0.05 * 3.0) / 0.1, 3.0, -2.0]])
