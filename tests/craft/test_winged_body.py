"""Term of a winged body: the K of the literature on gliders, written once more frame by frame."""

import math

import numpy as np
import pytest

from seatrial.physics.craft.marine_craft import MarineCraft

K = {
    "wing_drag": (7.19, 386.29),
    "wing_lift": (-0.36, 440.99),
    "wing_side": -115.65,
    "wing_pitch": 0.28,
    "wing_moment": (-58.27, -65.84, 34.1),
    "wing_damping": (-19.83, -205.64, -389.3),
}
"""Of Seawing: Zhang et al. 2013, table 3, their signs of pitch and yaw those of z down."""


def load(nu, terms="winged-body", **values):
    """Return force and moment of a term at a velocity through the water."""
    parts = []
    for text in (terms, ""):
        craft = MarineCraft("glider")
        for name, value in {**K, **values, "terms": text}.items():
            craft.set(name, value)
        x = np.array([0, 0, 5, 0.2, -0.3, 0.4, *nu])
        parts.append(craft.mass_matrix() @ craft.derivatives(x)[6:12])
    return parts[0] - parts[1]


def turned(angle, axis):
    """Return the matrix that turns vectors by an angle about axis 1 or 2."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array(
        {1: [[c, 0, s], [0, 1, 0], [-s, 0, c]], 2: [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis]
    )


@pytest.mark.parametrize(
    "v", [(0.4, 0.0, 0.03), (0.4, -0.1, 0.05), (0.3, 0.2, -0.2), (0.0, 0.0, 0.0)]
)
def test_force_and_moment_are_those_of_the_flow_frame(v):
    rates = np.array([0.05, -0.1, 0.08])
    speed = math.hypot(*v)
    alpha, beta = math.atan2(v[2], v[0]), math.asin(v[1] / speed) if speed else 0.0
    R = turned(-alpha, 1) @ turned(beta, 2)
    if speed:  # the x of the flow frame is the way of the body through the water
        np.testing.assert_allclose(R[:, 0], np.array(v) / speed, atol=1e-15)
    force = [-(7.19 + 386.29 * alpha**2), -115.65 * beta, -(-0.36 + 440.99 * alpha)]
    moment = [-58.27 * beta, 0.28 - 65.84 * alpha, 34.1 * beta]
    moment += np.array(K["wing_damping"]) * rates
    expected = speed**2 * np.concatenate([R @ force, R @ moment])
    np.testing.assert_allclose(load((*v, *rates)), expected, rtol=1e-10, atol=1e-12)


def test_a_hull_that_is_half_out_of_the_water_meets_half_of_it():
    nu = (0.4, -0.1, 0.05, 0.05, -0.1, 0.08)
    afloat = {"restoring": "floating", "hull_size": (0.01, 0.01, 1e3)}
    np.testing.assert_allclose(load(nu, **afloat), load(nu) / 2, rtol=0.03)
