import math

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.craft import kinematics, symbolic

ATTITUDES = [(0.3, -0.5, 2.0), (-2.0, 1.2, -3.0), (0.0, 0.0, 0.0), (3.0, -1.4, 0.1)]


@pytest.mark.parametrize("attitude", ATTITUDES)
def test_rotation_is_that_of_yaw_pitch_roll(attitude):
    phi, theta, psi = attitude
    expected = Rotation.from_euler("ZYX", [psi, theta, phi]).as_matrix()
    np.testing.assert_allclose(kinematics.rotation(*attitude), expected, atol=1e-15)


@pytest.mark.parametrize("attitude", ATTITUDES)
def test_vectors_turn_to_ned_and_back(attitude):
    v = (1.0, -2.0, 0.5)
    R = np.array(kinematics.rotation(*attitude))
    np.testing.assert_allclose(kinematics.to_ned(attitude, v), R @ v, atol=1e-15)
    np.testing.assert_allclose(kinematics.to_body(attitude, v), R.T @ v, atol=1e-15)
    there_and_back = kinematics.to_body(attitude, kinematics.to_ned(attitude, v))
    assert there_and_back == pytest.approx(v, abs=1e-15)


def test_signs_of_the_angles():
    bow_down_component = kinematics.to_ned((0.0, 0.1, 0.0), (1, 0, 0))[2]
    starboard_down_component = kinematics.to_ned((0.1, 0.0, 0.0), (0, 1, 0))[2]
    bow_east_component = kinematics.to_ned((0.0, 0.0, 0.1), (1, 0, 0))[1]
    assert bow_down_component == -math.sin(0.1)
    assert starboard_down_component == math.sin(0.1)
    assert bow_east_component == math.sin(0.1)


@pytest.mark.parametrize("attitude", ATTITUDES)
def test_symbols_and_floats_agree(attitude):
    numbers = ca.DM(attitude)
    expressed = np.array(symbolic.rotation_matrix(numbers))
    np.testing.assert_array_equal(expressed, kinematics.rotation(*attitude))


def test_euler_rates_turn_the_rotation_matrix_at_the_angular_velocity():
    # dR/dt = R S(omega) defines omega in body axes; the Euler rates must produce it.
    attitude, omega = ca.SX.sym("attitude", 3), ca.SX.sym("omega", 3)
    R = symbolic.rotation_matrix(attitude)
    rate = symbolic.euler_rate_matrix(attitude) @ omega
    difference = ca.reshape(ca.jtimes(R, attitude, rate), 3, 3) - R @ symbolic.skew(omega)
    evaluate = ca.Function("difference", [attitude, omega], [difference])
    for angles in ATTITUDES:
        assert np.abs(np.array(evaluate(angles, [0.3, -0.7, 1.1]))).max() < 1e-14


def test_skew_and_cross_are_the_vector_product():
    a, b = (1.0, -2.0, 3.0), (0.5, 4.0, -1.0)
    assert kinematics.cross(a, b) == tuple(np.cross(a, b))
    np.testing.assert_array_equal(
        np.array(symbolic.skew(ca.DM(a)) @ ca.DM(b)).ravel(), np.cross(a, b)
    )
