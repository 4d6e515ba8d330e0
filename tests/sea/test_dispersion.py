"""Dispersion against 30 digits computed elsewhere, and its limits."""

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.sea.dispersion import group_speed, phase_speed, wave_number

from .references import table


def test_wave_numbers_and_speeds_are_those_of_the_reference():
    data = table("dispersion")
    for depth in np.unique(data["depth"]):
        rows = data[data["depth"] == depth]
        k = wave_number(rows["omega"], depth)
        np.testing.assert_allclose(k, rows["k"], rtol=1e-12)
        np.testing.assert_allclose(2 * np.pi / k, rows["wavelength"], rtol=1e-12)
        np.testing.assert_allclose(
            phase_speed(rows["omega"], depth), rows["phase_speed"], rtol=1e-12
        )
        np.testing.assert_allclose(
            group_speed(rows["omega"], depth), rows["group_speed"], rtol=1e-12
        )


def test_limits_of_shallow_and_deep_water():
    assert phase_speed(1e-4, 2.0) == pytest.approx(np.sqrt(9.81 * 2.0), rel=1e-8)
    assert group_speed(1e-4, 2.0) == pytest.approx(np.sqrt(9.81 * 2.0), rel=1e-8)
    omega = np.sqrt(20.0 * 9.81 / 3.0)  # kh = 20
    assert wave_number(omega, 3.0) == pytest.approx(wave_number(omega), rel=1e-12)
    assert group_speed(5.0) == pytest.approx(0.5 * 9.81 / 5.0, rel=1e-15)
    assert np.isfinite(group_speed(np.array([1e-3, 100.0]), 1e5)).all()


def test_a_depth_must_be_above_0():
    with pytest.raises(InputError, match="depth is -1"):
        wave_number(1.0, -1.0)
