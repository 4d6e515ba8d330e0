"""Intervals of linear problems: how often they cover the truth, with noise that is correlated."""

import numpy as np
import pytest
from scipy.signal import lfilter

from seatrial_kits.identify.manoeuvres.intervals import FILE, WITHIN, bootstrap, deviations

ROWS, SEEDS = 600, 200
TIME = np.linspace(0.0, 1.0, ROWS)
JACOBIAN = -np.column_stack((np.ones(ROWS), np.sin(7.0 * TIME), TIME**2))


def estimated(noise):
    """Return the error of least squares, and the residual (measured less predicted)."""
    error = np.linalg.lstsq(-JACOBIAN, noise, rcond=None)[0]
    return error, noise + JACOBIAN @ error


def white(random):
    return random.standard_normal(ROWS)


def coloured(random):
    """Return noise of first order with a correlation of 0.7 from row to row, as GNSS has."""
    return lfilter([1.0], [1.0, -0.7], random.standard_normal(ROWS + 100))[100:]


@pytest.mark.parametrize("noise", [white, coloured])
@pytest.mark.parametrize("by", ["matrix", "bootstrap"])
def test_intervals_of_95_percent_cover_the_truth(noise, by):
    inside = np.zeros(3)
    for seed in range(SEEDS):
        error, residual = estimated(noise(np.random.default_rng(seed)))
        if by == "matrix":
            found = deviations(JACOBIAN, residual, [ROWS], [0, 1, 2], [])
        else:
            found = bootstrap(JACOBIAN, residual, [ROWS])
        inside += np.abs(error) < WITHIN * found
    assert (inside >= 0.90 * SEEDS).all()
    assert (inside <= 0.99 * SEEDS).all()


def test_taken_as_white_correlated_noise_would_not_be_covered():
    inside = np.zeros(3)
    for seed in range(SEEDS):
        error, residual = estimated(coloured(np.random.default_rng(seed)))
        inside += np.abs(error) < WITHIN * residual.std() * np.sqrt(
            np.diag(np.linalg.inv(JACOBIAN.T @ JACOBIAN))
        )
    assert (inside < 0.75 * SEEDS).all()


def test_an_error_of_what_is_kept_widens_the_interval_by_what_it_does():
    random, kept = np.random.default_rng(3), 0.5 * TIME
    jacobian = np.column_stack((JACOBIAN, -kept))
    noise = 1e-3 * white(random)
    _, residual = estimated(noise)
    found = deviations(jacobian, residual, [ROWS], [0, 1, 2], [3])
    wrong = FILE * random.standard_normal(2000)
    bias = np.linalg.lstsq(-JACOBIAN, kept, rcond=None)[0]
    assert found == pytest.approx(np.std(np.outer(wrong, bias), axis=0), rel=0.05)
