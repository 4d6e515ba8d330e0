"""The force at a point of a heeling boat: its power, and how the point moves."""

import numpy as np
import pytest

from seatrial_kits.sailing.sailboat import Sailboat
from tests.craft.test_attachment import PLACE, PULL, built, loads, output


@pytest.mark.parametrize("roll", [0.0, 0.5])
def test_the_power_of_the_load_is_that_of_the_force_at_its_point(roll):
    boat = built(
        Sailboat,
        mass=30.0,
        inertia=(4.0, 12.0),
        X_udot=-3.0,
        Y_vdot=-20.0,
        K_pdot=-1.0,
        N_rdot=-5.0,
    )
    state = np.array([1.0, 2.0, roll, 0.8, 1.5, -0.4, 0.3, 0.2])
    power = loads(boat, state) @ state[4:]
    boat.set("attachment_force", (0.0, 0.0, 0.0))
    velocity = output(boat, "attachment_velocity", state)
    assert power == pytest.approx(velocity @ PULL, rel=1e-12)


def test_the_velocity_is_how_the_point_moves():
    boat = built(Sailboat, mass=30.0, inertia=(4.0, 12.0))
    state, h = np.array([1.0, 2.0, 0.5, 0.8, 1.5, -0.4, 0.3, 0.2]), 1e-6
    velocity = output(boat, "attachment_velocity", state)
    eta_dot = boat.derivatives(state)[:4]
    ends = []
    for sign in (-1, 1):
        moved = state.copy()
        moved[:4] += sign * h * eta_dot
        ends.append(output(boat, "attachment_point", moved))
    np.testing.assert_allclose((ends[1] - ends[0]) / (2 * h), velocity, atol=1e-8)
    psi, (x, y, z) = 0.8, PLACE
    upright = output(boat, "attachment_point", np.array([1.0, 2.0, 0, psi, 0, 0, 0, 0]))
    turned = [1 + x * np.cos(psi) - y * np.sin(psi), 2 + x * np.sin(psi) + y * np.cos(psi), z]
    np.testing.assert_allclose(upright, turned, rtol=1e-12)
