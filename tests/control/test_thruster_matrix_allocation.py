"""Allocation to many thrusters: what the thrusters make of the pulses is what was asked for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.control.allocation.thruster_matrix_allocation import ThrusterMatrixAllocation
from seatrial.devices.actuators.polynomial_thruster import PolynomialThruster
from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.errors import InputError
from tests.devices.running import started

PLACES = ThrusterMatrixAllocation.exercised
"""The BlueROV2 Heavy: four thrusters at 45 degrees below the CG, four vertical ones."""
AHEAD, ASTERN = 51.4, 39.9  # N
SURGE, SWAY, HEAVE, YAW = 0, 1, 2, 5


def thrusts(places=PLACES, **wanted):
    """Return what the pulses mean, by the inverse of the law from thrust to pulse."""
    component = started(ThrusterMatrixAllocation, **places, **wanted)
    away = np.array(component.get("pulse")) - 1.5e-3
    share = np.maximum(np.abs(away) - 26e-6, 0.0) / (400e-6 - 26e-6)
    return np.sign(away) * share ** (1 / 0.75) * np.where(away > 0, AHEAD, ASTERN)


def load(thrust, places=PLACES):
    propulsion = started(Propulsion, **places, thrust=list(thrust))
    return np.array([*propulsion.get("force"), *propulsion.get("moment")])


def matrix(places=PLACES):
    """Return the columns of the thruster matrix as propulsion has them."""
    return np.array([load(np.eye(16)[i], places) for i in range(16)]).T


@given(
    st.floats(-30, 30), st.floats(-20, 20), st.floats(-30, 30), st.floats(-4, 4)
)  # fmt: skip
def test_what_fits_is_given_by_the_pseudo_inverse(surge, sway, heave, moment):
    found = thrusts(surge=surge, sway=sway, heave=heave, yaw_moment=moment)
    wanted = [surge, sway, heave, 0, 0, moment]
    np.testing.assert_allclose(found, np.linalg.pinv(matrix()) @ wanted, atol=1e-9)
    np.testing.assert_allclose(load(found), wanted, atol=1e-9)


def test_thrusters_below_the_cg_are_balanced_unless_only_yaw_is_allocated():
    np.testing.assert_allclose(load(thrusts(surge=20.0))[4], 0.0, atol=1e-9)
    alone = load(thrusts(surge=20.0, moments="yaw"))
    np.testing.assert_allclose(alone, [20, 0, 0, 0, 0.085 * 20, 0], atol=1e-9)


@given(*[st.floats(-1e4, 1e4)] * 4)
def test_no_thruster_goes_beyond_its_limits(surge, sway, heave, moment):
    found = thrusts(surge=surge, sway=sway, heave=heave, yaw_moment=moment)
    assert found.max() <= AHEAD + 1e-9
    assert found.min() >= -ASTERN - 1e-9


@pytest.mark.parametrize("side", [1, -1])
def test_the_moment_comes_first_then_heave_then_the_force_in_its_direction(side):
    found = load(thrusts(surge=300.0, sway=150.0, heave=40.0, yaw_moment=side * 10.0))
    np.testing.assert_allclose(found[[HEAVE, YAW]], [40.0, side * 10.0], rtol=1e-9)
    assert 0 < found[SURGE] < 300.0
    np.testing.assert_allclose(found[SWAY], found[SURGE] / 2, rtol=1e-9)


def test_a_moment_beyond_all_takes_what_there_is():
    found = load(thrusts(surge=10.0, yaw_moment=1e6))
    np.testing.assert_allclose(found[YAW], 4 * 0.1887975 * ASTERN, rtol=1e-6)
    np.testing.assert_allclose(found[SURGE], 0.0, atol=1e-9)


@given(*[st.floats(-2, 2)] * 3)
def test_roll_and_pitch_moments_are_given_too(roll, pitch, moment):
    wanted = {"roll_moment": roll, "pitch_moment": pitch, "yaw_moment": moment}
    found = thrusts(surge=5.0, **wanted)
    np.testing.assert_allclose(load(found), [5, 0, 0, roll, pitch, moment], atol=1e-9)


def test_roll_and_pitch_come_before_all_else():
    found = load(thrusts(surge=300.0, heave=300.0, pitch_moment=15.0, yaw_moment=5.0))
    np.testing.assert_allclose(found[[3, 4, YAW]], [0.0, 15.0, 5.0], atol=1e-9)
    assert 0 < found[HEAVE] < 300.0


def test_of_a_craft_that_cannot_they_are_left_out():
    found = load(thrusts(surge=20.0, pitch_moment=5.0, roll_moment=5.0, moments="yaw"))
    np.testing.assert_allclose(found, [20, 0, 0, 0, 0.085 * 20, 0], atol=1e-9)


@pytest.mark.parametrize("newtons", [-30.5, -4.0, -0.01, 0.3, 11.0, 29.0])
def test_a_polynomial_is_inverted(newtons):
    """What a thruster with that curve makes of the pulse is what was asked for."""
    one = {"position_1": [0, 0, 0], "direction_1": [1, 0, 0], "moments": "yaw"}
    limits = {"thrust_ahead": 30.6, "thrust_astern": 30.6, "law": "polynomial"}
    pulse = started(ThrusterMatrixAllocation, **one, **limits, surge=newtons).get("pulse")[0]
    motor = started(PolynomialThruster, command=(pulse - 1.5e-3) / 400e-6)
    motor.advance(0.0, 5.0)
    assert motor.get("thrust") == pytest.approx(newtons, abs=1e-5)


def test_a_polynomial_is_followed_to_its_crest_only():
    """T'(V) = 0 there, where the thrust is 30.6218 N."""
    one = {"position_1": [0, 0, 0], "direction_1": [1, 0, 0], "moments": "yaw"}
    found = started(ThrusterMatrixAllocation, **one, law="polynomial", surge=1e3).get("pulse")[0]
    assert (found - 1.5e-3) / 400e-6 == pytest.approx(0.971655, abs=2e-6)


def test_a_polynomial_that_falls_is_refused():
    with pytest.raises(InputError, match="whose thrust falls from command 0 on"):
        started(ThrusterMatrixAllocation, law="polynomial", thrust_curve=[-1, 0, 0, 0, 0])


def test_two_thrusters_of_a_catamaran():
    places = {
        "position_1": [-0.7, -0.4, 0.1],
        "position_2": [-0.7, 0.4, 0.1],
        "direction_1": [1, 0, 0],
        "direction_2": [1, 0, 0],
    }
    found = thrusts(places, surge=20.0, yaw_moment=4.0, sway=5.0, heave=3.0, moments="yaw")
    np.testing.assert_allclose(found[:2], [15.0, 5.0], rtol=1e-9)
    assert not found[2:].any()


def test_without_thrusters_all_channels_are_at_neutral():
    component = started(ThrusterMatrixAllocation, surge=20.0)
    assert component.get("pulse") == [1.5e-3] * 16


def test_a_direction_that_is_no_unit_vector_is_refused():
    with pytest.raises(InputError, match=r"direction_2 is .* of length 2: give a unit vector"):
        started(ThrusterMatrixAllocation, direction_2=[0, 2, 0])
