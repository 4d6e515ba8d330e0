"""The lag of polynomial thrusters: its transition against SciPy's matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.devices.actuators.polynomial_thruster import companion_exponential

T200 = (108700.0, 9258.0, 89.0)


@pytest.mark.parametrize("poles", [T200, (1.0, 3.0, 3.0), (1e-3, 0.05, 0.4), (5e5, 1e5, 300.0)])
@pytest.mark.parametrize("t", [0.0, 1e-6, 0.004, 0.05, 1.0, 5.0])
def test_transition_is_the_matrix_exponential(poles, t):
    """In states that are of one size."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], -np.array(poles)])
    size = np.power(poles[0] ** (1 / 3), np.arange(3.0))
    found, expected = (
        each * size / size[:, None] for each in (companion_exponential(poles, t), expm(A * t))
    )
    assert np.abs(found - expected).max() <= 5e-12 * max(1.0, np.abs(expected).max())
