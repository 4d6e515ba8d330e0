"""Kinematics and motion outputs of planar craft against rotations, circles and Kirchhoff."""

import casadi as ca
import numpy as np
import pytest

from seatrial.physics.craft.kinematics import rotation, to_ned
from seatrial.physics.craft.planar import (
    horizontal_rotation,
    kinematics,
    planar_coriolis,
)


def numbers(expression):
    return np.array(ca.DM(expression)).squeeze()


@pytest.mark.parametrize(("phi", "psi"), [(0.0, 0.4), (-0.5, 2.5), (1.2, -3.0)])
def test_horizontal_rotation_is_the_horizontal_part_of_the_rotation(phi, psi):
    expected = np.array(rotation(phi, 0.0, psi))[:2, :2]
    np.testing.assert_allclose(numbers(horizontal_rotation(phi, psi)), expected, atol=1e-15)


def test_kinematics_of_a_heeled_craft():
    phi, psi, u, v, p, r = 0.5, 2.0, 1.5, -0.3, 0.2, -0.4
    slope = numbers(kinematics(ca.DM([7.0, 8.0, phi, psi]), ca.DM([u, v, p, r])))
    north, east, _down = to_ned((phi, 0.0, psi), (u, v, 0.0))
    np.testing.assert_allclose(slope, [north, east, p, r * np.cos(phi)], atol=1e-15)


def test_kinematics_of_a_level_craft_has_three_elements():
    slope = numbers(kinematics(ca.DM([7.0, 8.0, np.pi / 2]), ca.DM([1.5, -0.3, 0.1])))
    np.testing.assert_allclose(slope, [0.3, 1.5, 0.1], atol=1e-15)


def test_coriolis_force_does_no_work_and_is_kirchhoffs():
    nu, h = ca.DM([1.2, -0.7, 0.3]), ca.DM([40.0, -90.0])
    force = numbers(planar_coriolis(h, nu))
    momentum = np.array([40.0, -90.0, 0.0])
    omega, velocity = np.array([0, 0, 0.3]), np.array([1.2, -0.7, 0])
    expected = [*np.cross(omega, momentum)[:2], np.cross(velocity, momentum)[2]]
    np.testing.assert_allclose(force, expected, atol=1e-13)
    # A momentum diag(m1, m2) (u, v) gives the Munk moment (m2 - m1) u v and takes no power.
    u, v, r = 1.2, -0.7, 0.3
    force = numbers(planar_coriolis(ca.DM([30 * u, 50 * v]), ca.DM([u, v, r])))
    assert force[2] == pytest.approx((50 - 30) * u * v, rel=1e-14)
    assert force @ [u, v, r] == pytest.approx(0.0, abs=1e-13)
