"""Velocity through the water of every craft, beside the current turned into its axes by SciPy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.devices.speed_log import SpeedLog
from tests.craft.fleet import FLEET, craft
from tests.devices.ideal import ideal
from tests.kit import needs_kits

PLACE = np.array([0.7, -0.2, 0.4])
SPEED, DIRECTION = 0.8, 2.3
WATER = SPEED * np.array([math.cos(DIRECTION), math.sin(DIRECTION), 0.0])
SHEARED = {"current_profile": "linear", "current_reach": 5.0}


def moving(vehicle, steps=30, **changes):
    """Return a craft in a stream after so many steps of 0.1 s."""
    made = craft(vehicle, current_speed=SPEED, current_direction=DIRECTION, **changes)
    made.set("flow_place", PLACE)
    made.setup(0.0)
    made.initialise()
    made.begin()
    for i in range(steps):
        made.advance(i * 0.1, 0.1)
    return made


def rotation(made):
    """Return the rotation from body axes to {n}."""
    return Rotation.from_euler("ZYX", made.get("attitude")[::-1]).as_matrix()


@pytest.mark.parametrize("vehicle", FLEET)
def test_it_is_the_velocity_over_ground_less_that_of_the_water(vehicle):
    made = moving(vehicle)
    along = rotation(made).T @ WATER
    if vehicle == "gloria":  # her heave is left out: what a heeled deck sees of it is too
        along[2] = 0.0
    expected = made.get("velocity") - along
    np.testing.assert_allclose(made.get("nu_r")[:3], expected, atol=1e-12)
    np.testing.assert_allclose(made.get("nu_r")[3:], made.get("rates"), atol=1e-15)


@pytest.mark.parametrize("vehicle", FLEET)
def test_the_flow_at_a_place_has_what_the_turning_adds(vehicle):
    made = moving(vehicle)
    expected = made.get("nu_r")[:3] + np.cross(made.get("rates"), PLACE)
    np.testing.assert_allclose(made.get("flow"), expected, atol=1e-12)


@needs_kits("videoray")
def test_the_flow_at_a_place_has_the_shear_of_the_current():
    # At the start: later the craft's depth, where the current is looked up, is extrapolated.
    start = {
        "eta_start": (0.0, 0.0, 2.0, 0.2, -0.4, 0.3),
        "nu_start": (1.0, 0.2, 0.1, 0.3, 0.5, 0.4),
    }
    made = moving("videoray", 0, **start, **SHEARED)
    R = rotation(made)
    depths = made.get("position")[2] + np.array([0.0, (R @ PLACE)[2]])
    above, there = (WATER * (1.0 - depth / 5.0) for depth in depths)
    np.testing.assert_allclose(made.get("nu_r")[:3], made.get("velocity") - R.T @ above, atol=1e-9)
    turning = np.cross(made.get("rates"), PLACE)
    expected = made.get("velocity") + turning - R.T @ there
    np.testing.assert_allclose(made.get("flow"), expected, atol=1e-9)


def test_a_log_measures_the_flow_at_its_place_and_its_calibration_is_a_share():
    made = moving("otter")
    log = ideal(SpeedLog, place=PLACE, scale=0.05, nu_r=made.get("nu_r"))
    np.testing.assert_allclose(
        log.get("water_velocity"), 1.05 * np.array(made.get("flow")[:2]), rtol=1e-12
    )
