"""Axes of ROS against SciPy's rotations, which know nothing of ours."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.ros2.frames import TO_ENU, TO_FLU, enu, flu, heading, quaternion, turned

RANDOM = np.random.default_rng(5)


def there(attitude):
    """Ahead-left-up in east-north-up: unit vectors carried over one by one."""
    phi, theta, psi = attitude
    body = Rotation.from_euler("ZYX", [psi, theta, phi])
    axes = [body.apply(axis) for axis in ([1, 0, 0], [0, -1, 0], [0, 0, -1])]
    return Rotation.from_matrix(np.array([[y, x, -z] for x, y, z in axes]).T)


@pytest.mark.slow
def test_random_attitudes_are_those_of_scipy():
    angles = RANDOM.uniform(-1.0, 1.0, (10_000, 3)) * [math.pi, math.pi / 2, math.pi]
    found = Rotation.from_quat([quaternion(each) for each in angles])
    wanted = Rotation.concatenate([there(each) for each in angles])
    assert (found.inv() * wanted).magnitude().max() < 1e-7
    headings = [
        math.remainder(heading(q) - psi, math.tau)
        for q, (_, _, psi) in zip(found.as_quat(), angles, strict=True)
    ]
    assert np.abs(headings).max() < 1e-6


@pytest.mark.parametrize(
    ("attitude", "ahead", "left"),
    [
        ((0.0, 0.0, 0.0), (0, 1, 0), (-1, 0, 0)),  # north; port side west
        ((0.0, 0.0, 90.0), (1, 0, 0), (0, 1, 0)),  # yaw: east; port side north
        ((90.0, 0.0, 0.0), (0, 1, 0), (0, 0, 1)),  # roll to starboard: port side up
        ((0.0, 90.0, 0.0), (0, 0, 1), (-1, 0, 0)),  # pitch: bow up
    ],
)
def test_quarter_turns(attitude, ahead, left):
    turn = Rotation.from_quat(quaternion(np.radians(attitude)))
    np.testing.assert_allclose(turn.apply([1, 0, 0]), ahead, atol=1e-12)
    np.testing.assert_allclose(turn.apply([0, 1, 0]), left, atol=1e-12)


def test_rates_turn_the_attitude_that_they_are_the_rates_of():
    step = 1e-6
    for _ in range(200):
        attitude = RANDOM.uniform(-1.0, 1.0, 3) * [3.0, 1.2, 3.0]
        rates = RANDOM.uniform(-1.0, 1.0, 3)
        body = Rotation.from_euler("ZYX", attitude[::-1])
        later = (body * Rotation.from_rotvec(step * rates)).as_euler("ZYX")[::-1]
        before, after = (Rotation.from_quat(quaternion(a)) for a in (attitude, later))
        np.testing.assert_allclose((before.inv() * after).as_rotvec() / step, flu(rates), atol=1e-5)


def test_vectors_and_covariances_turn_as_their_samples_do():
    samples = RANDOM.multivariate_normal(
        [1, 2, 3], [[4, 1, 0.5], [1, 3, -0.7], [0.5, -0.7, 2]], 500
    )
    for turn, one in ((TO_ENU, enu), (TO_FLU, flu)):
        moved = np.array([one(each) for each in samples])
        np.testing.assert_allclose(turned(np.cov(samples.T), turn), np.cov(moved.T), atol=1e-12)
        assert [one(one(each)) for each in samples] == [tuple(each) for each in samples]
