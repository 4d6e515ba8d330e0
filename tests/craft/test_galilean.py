"""In a uniform current with its air, the same orders give the same motion through the water.

Exempt, as their pages say: Gloria, whose heave is left out, and the linear Mariner, which keeps its
speed over ground.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.craft.fleet import FLEET, craft
from tests.kit import vehicles

DURATION = 1.0
CRAFT = [name for name in FLEET if name not in ("gloria", "mariner")]
CRAFT += [f"{name} cubic" for name in vehicles("mariner")]


def moved(name, orders, water, h):
    """Return position, attitude and nu_r after 1 s of constant orders in a uniform current."""
    vehicle, _, variant = name.partition(" ")
    speed, direction = math.hypot(*water), math.atan2(water[1], water[0])
    made = craft(vehicle, "cubic" if variant else None, max_step=h)
    made.set("current_speed", speed)
    made.set("current_direction", direction)
    _launch(made, water)
    made.setup(0.0)
    _order(made, orders)
    made.initialise()
    made.begin()
    for i in range(round(DURATION / h)):
        made.advance(i * h, h)
    return np.array([*made.get("position"), *made.get("attitude"), *made.get("nu_r")])


def _launch(made, water):
    """Start from rest in the water, a ship at its speed: bow north, along the current's axes."""
    names = ("nu_start", "velocity_start")
    start = next(name for name in names if name in made.ports)
    values = list(made.get(start))
    values[:2] = values[0] + water[0], water[1]
    made.set(start, values)


def _order(made, orders):
    scale = max(_mass(made), 1.0)
    for name, value in (
        ("force_1", [scale * each for each in orders[:3]]),
        ("moment_1", [0.1 * scale * each for each in orders[3:]]),
        ("command", [0.05 * each for each in orders[:2]]),
        ("rudder", 0.3 * orders[0]),
        ("propeller_order", orders[1]),
    ):
        if name in made.ports:
            axes = made.ports[name].axes
            made.set(name, value[-len(axes) :] if axes else np.ravel(value)[-1])


def _mass(made):
    return float(np.ravel(made.get("mass"))[0])


def off(name, orders, water, h):
    """Return by how much the two motions through the water differ."""
    carried, still = (moved(name, orders, each, h) for each in (water, (0.0, 0.0)))
    carried[:2] -= DURATION * np.array(water)
    return np.abs(carried - still).max()


UNIT = st.floats(-1, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", CRAFT)
@settings(max_examples=3, deadline=None)
@given(orders=st.lists(UNIT, min_size=6, max_size=6), water=st.tuples(UNIT, UNIT))
def test_motion_through_the_water_does_not_know_of_the_current(name, orders, water):
    assert off(name, orders, water, 2e-3) < 1e-9


@pytest.mark.parametrize("name", vehicles("otter", "videoray", "hydrone"))
def test_what_is_left_falls_at_least_with_the_fourth_power_of_the_step(name):
    orders = [0.7, -0.3, 0.1, 0.2, -0.1, 0.9]
    coarse, fine = (off(name, orders, (0.6, -0.8), h) for h in (0.01, 0.005))
    assert fine < 1e-12 or coarse / fine > 12.0
