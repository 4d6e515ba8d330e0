"""Planar craft at random poses, in water that moves and wind, beside vectors in three dimensions."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.craft.planar import (
    attachment,
    carried,
    kinematics,
    motion_outputs,
    sea_load,
    water_outputs,
)

SEEDS = range(3)


def column(values):
    return ca.DM(np.array(values, dtype=float))


def numbers(expression):
    return np.array(ca.DM(expression)).squeeze()


class Pose:
    """A heeled craft that moves at random; forces, places and water too."""

    def __init__(self, seed, heels=True):
        draw = np.random.default_rng(seed)
        self.north, self.east, self.phi, self.psi = draw.uniform(
            (28, -22, -1.4, 1), (32, -18, 1.4, 3)
        )
        self.phi *= heels
        self.u, self.v, self.p, self.r, *self.nu_dot = draw.normal(size=8)
        self.p *= heels
        self.place, self.pull, self.water, self.rate = draw.normal(size=(4, 3))
        self.shear = draw.normal(size=2)
        kept = [0, 1, 2, 3] if heels else [0, 1, 3]
        self.eta = column(np.array([self.north, self.east, self.phi, self.psi])[kept])
        self.nu = column(np.array([self.u, self.v, self.p, self.r])[kept])
        self.slope = column(np.array(self.nu_dot)[kept])
        self.R = Rotation.from_euler("ZYX", [self.psi, 0, self.phi]).as_matrix()
        self.velocity, self.rates = np.array([self.u, self.v, 0]), np.array([self.p, 0, self.r])


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("heels", [True, False])
def test_motion_is_published_as_of_a_rigid_body(seed, heels):
    pose = Pose(seed, heels)
    found = {n: numbers(v) for n, v in motion_outputs(pose.eta, pose.nu, pose.slope).items()}
    u_dot, v_dot = pose.nu_dot[:2]
    expected = {
        "position": [pose.north, pose.east, 0],
        "attitude": [pose.phi, 0, pose.psi],
        "velocity": pose.velocity,
        "rates": pose.rates,
        "acceleration": np.add([u_dot, v_dot, 0], np.cross(pose.rates, pose.velocity)),
    }
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, atol=1e-13, err_msg=name)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("heels", [True, False])
def test_the_flow_at_a_place_turns_with_the_craft_and_lacks_the_shear(seed, heels):
    pose = Pose(seed, heels)
    u = SimpleNamespace(water_shear=column(pose.shear))
    p = SimpleNamespace(flow_place=column(pose.place))
    found = water_outputs(pose.eta, pose.nu, u, p)
    np.testing.assert_allclose(numbers(found["nu_r"]), [*pose.velocity, *pose.rates], atol=1e-13)
    below = (pose.R @ pose.place)[2]
    sheared = pose.R.T @ [*(pose.shear * below), 0]
    expected = pose.velocity + np.cross(pose.rates, pose.place) - sheared
    np.testing.assert_allclose(numbers(found["flow"]), expected, atol=1e-13)
    still = water_outputs(pose.eta, pose.nu, SimpleNamespace(), p)
    np.testing.assert_allclose(numbers(still["flow"]), expected + sheared, atol=1e-13)


@pytest.mark.parametrize("seed", SEEDS)
def test_water_that_gathers_speed_is_seen_from_a_turning_craft(seed):
    pose, h = Pose(seed, heels=False), 1e-6
    u = SimpleNamespace(water_velocity=column(pose.water), water_acceleration=column(pose.rate))
    nu_r, change = carried(pose.eta, pose.nu, u)

    def in_body(t):
        back = Rotation.from_euler("Z", -(pose.psi + pose.r * t)).as_matrix()
        return (back @ [*(pose.water[:2] + pose.rate[:2] * t), 0])[:2]

    expected = [pose.u - in_body(0)[0], pose.v - in_body(0)[1], pose.r]
    np.testing.assert_allclose(numbers(nu_r), expected, atol=1e-13)
    slope = (in_body(h) - in_body(-h)) / (2 * h)
    np.testing.assert_allclose(numbers(change), [*slope, 0], atol=1e-8)


def test_calm_water_and_still_air_change_nothing():
    pose = Pose(0, heels=False)
    nu_r, change = carried(pose.eta, pose.nu, SimpleNamespace())
    np.testing.assert_array_equal(numbers(nu_r), numbers(pose.nu))
    np.testing.assert_array_equal(numbers(change), [0, 0, 0])
    np.testing.assert_array_equal(numbers(sea_load(SimpleNamespace())), [0, 0, 0])


def test_waves_and_wind_push_along_the_axes_that_are_asked_for():
    waves, wind = np.array([1.0, 2, 4, 8, 16, 32]), np.array([3.0, -5, 7, -11, 13, 17])
    u = SimpleNamespace(wave_load=column(waves), wind_load=column(wind))
    np.testing.assert_array_equal(numbers(sea_load(u)), (waves + wind)[[0, 1, 5]])
    np.testing.assert_array_equal(numbers(sea_load(u, (0, 1, 3, 5))), (waves + wind)[[0, 1, 3, 5]])


def attached(pose):
    """Return place and velocity of the attachment, and the load: their equations derive symbols."""
    x = SimpleNamespace(eta=ca.SX.sym("eta", pose.eta.numel()), nu=ca.SX.sym("nu", pose.nu.numel()))
    u = SimpleNamespace(attachment_force=column(pose.pull))
    motion, load = attachment(x, u, SimpleNamespace(attachment_place=column(pose.place)))
    function = ca.Function("attached", [x.eta, x.nu], [*motion.values(), load])
    return [numbers(value) for value in function(pose.eta, pose.nu)]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("heels", [True, False])
def test_an_attachment_is_a_point_of_the_craft_and_its_force_works_as_there(seed, heels):
    pose = Pose(seed, heels)
    point, moves, load = attached(pose)
    expected = [pose.north, pose.east, 0] + pose.R @ pose.place
    np.testing.assert_allclose(point, expected, atol=1e-12)
    # Along the craft's path, by its own kinematics.
    h, slope = 1e-6, numbers(kinematics(pose.eta, pose.nu))

    def at(t):
        moved = numbers(pose.eta) + t * slope
        heel = moved[2] if heels else 0.0
        R = Rotation.from_euler("ZYX", [moved[-1], 0, heel]).as_matrix()
        return [moved[0], moved[1], 0] + R @ pose.place

    velocity = (at(h) - at(-h)) / (2 * h)
    np.testing.assert_allclose(moves, velocity, atol=1e-7)
    power = load @ numbers(pose.nu)
    assert power == pytest.approx(pose.pull @ velocity, abs=1e-7)
    if not heels:
        force = pose.R.T @ pose.pull
        moment = np.cross(pose.place, force)[2]
        np.testing.assert_allclose(load, [*force[:2], moment], atol=1e-12)
