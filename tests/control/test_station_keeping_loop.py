"""Station keeping of the Hydrone in a closed loop, with every device between hull and autopilot."""

import math

import numpy as np
import pytest

from seatrial.control.station_keeping import HOLD, RETURN

from .hydrone_loop import held

DEG = math.radians(1.0)


@pytest.mark.interop
def test_settles_from_3_m_and_40_degrees_against_a_steady_push():
    rows = held(40, position=(-3, 0), heading=40 * DEG, force=(-3, 0), moment=0.8)
    t, north, east, psi, mode = rows.T
    distance = np.hypot(north, east)
    assert north.max() < 0.15  # overshoot
    assert distance[t > 14].max() < 0.2
    assert np.abs(psi[t > 20]).max() < 1.5 * DEG
    assert (mode[t > 14] == HOLD).all()
    # The integrals leave no error ahead and in heading; the one abeam stays.
    assert abs(north[-1]) < 0.005
    assert abs(psi[-1]) < 0.01 * DEG


@pytest.mark.interop
def test_holds_with_the_profiles_sensors():
    rows = held(90, position=(-3, 0), heading=40 * DEG, force=(-3, 0), moment=0.8, ideal=False)
    t, north, east, psi, mode = rows.T
    late = t > 30
    assert np.hypot(north, east)[late].max() < 0.3
    assert np.sqrt(np.mean(north[late] ** 2)) < 0.06
    assert np.abs(psi[late]).max() < 2.5 * DEG
    assert (mode[late] == HOLD).all()


@pytest.mark.interop
@pytest.mark.parametrize("heading", [0.0, 143.0, -90.0])
def test_comes_back_from_far(heading):
    rows = held(90, position=(-20, 15), heading=heading * DEG, ideal=False)
    t, north, east, psi, _ = rows.T
    assert np.hypot(north, east)[t > 75].max() < 1.1
    assert np.abs(psi[t > 85]).max() < 3 * DEG


@pytest.mark.interop
def test_steady_force_abeam_is_a_cycle_about_the_hold_radius():
    t, north, east, _, mode = held(150, force=(0, 2), ideal=False).T
    assert np.hypot(north, east).max() < 1.3
    assert 0.15 < np.mean(mode[t > 20] == RETURN) < 0.5
    entries = np.sum(np.diff(mode[mode > 0]) > 0.5)
    assert 3 <= entries <= 10


@pytest.mark.interop
def test_holds_in_a_current():
    _, north, east, _, _ = held(150, current=(-0.2, 0.1, 0), ideal=False).T
    assert np.hypot(north, east).max() < 1.4
