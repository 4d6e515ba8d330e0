"""Motion through the water does not know of a uniform current, whatever the parts."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.physics.craft.kinematics import rotation
from seatrial_kits.fitted.fitted_craft import FittedCraft
from tests.kits.fitted.fitting import craft, state

MODEST = {
    **{f"propulsor_position_{k}": (-0.8 + 0.1 * k, 0.05 * k - 0.2, 0.1) for k in range(1, 9)},
    **{f"propulsor_thrust_{k}": (8.0, 6.0) for k in range(1, 9)},
    **{f"propulsor_time_constant_{k}": 0.3 for k in range(1, 9)},
    **{f"propulsor_angle_limit_{k}": (-1.0, 1.0) for k in (2, 3, 8)},
    **{f"propulsor_speed_{k}": (80.0, 70.0) for k in (5, 6, 7)},
    "propulsor_fading_speed_2": 3.0,
    "propulsor_fading_speed_4": 3.0,
    "propulsor_axis_4": (0.0, 1.0, 0.0),
    **{f"foil_position_{k}": (-0.9, 0.0, -0.1) for k in range(1, 5)},
    **{f"foil_time_constant_{k}": 0.2 for k in range(1, 5)},
    "foil_position_4": (0.2, 0.0, -0.5),
    "foil_area_4": 0.2,
    "ballast_mass_2": 1.0,
    "ballast_position_2": (0.3, 0.0, 0.1),
}
"""Beside the values of ``exercised``: all kinds, with forces that a body of 40 kg stands."""
START = np.array([0.8, 0.1, -0.05])
WATER = np.array([0.9, -0.7, 0.0])
ORDERS = [0.6, 0.7, 0.5, 0.8, 0.9, 0.6, 0.7, 0.8]
ANGLES = [0.3, 0.5, -0.4, 0.2, 0.3, 0.2, 0.4, 0.5]


def fitted(**values):
    kinds = {k: v for k, v in FittedCraft.exercised.items() if k not in ("terms", "restoring")}
    return craft(**{**kinds, **MODEST, **values})


def inputs(orders, angles, water):
    """Return the inputs; the wind goes with the water, as a ship in a stream has it."""
    return {
        "propulsor_order": orders,
        "propulsor_angle": angles,
        "foil_angle": [0.5 * a for a in angles],
        "ballast_order": orders,
        "current": water,
        "wind": np.array([3.0, -2.0]) + water[:2],
    }


def off(carried, still, t, water):
    """Return how far motion with the current is from that without it, carried along."""
    places = carried[:, :3] - still[:, :3] - np.outer(t, water)
    through = [
        a[6:9] - np.array(rotation(*a[3:6])).T @ water - b[6:9]
        for a, b in zip(carried, still, strict=True)
    ]
    rest = np.delete(carried - still, [0, 1, 2, 6, 7, 8], axis=1)
    return max(np.abs(each).max() for each in (places, through, rest))


UNIT = st.floats(-1, 1)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(
    water=st.tuples(UNIT, UNIT, st.just(0.0)),  # the wind has no third component
    orders=st.lists(UNIT, min_size=8, max_size=8),
    angles=st.lists(UNIT, min_size=8, max_size=8),
    attitude=st.tuples(UNIT, UNIT, UNIT),
    nu=st.lists(UNIT, min_size=6, max_size=6),
)
def test_in_a_current_the_rates_of_change_are_those_in_still_water(
    water, orders, angles, attitude, nu
):
    # With v = v_r + R^T w: v' = v_r' - omega x R^T w, and the place moves by w more.
    water, R, part = np.array(water), np.array(rotation(*attitude)), fitted()
    lags = {"lagged_order": orders, "lagged_angle": angles, "lagged_foil": angles}
    slopes = []
    for stream in (0 * water, water):
        for name, value in inputs(orders, angles, stream).items():
            part.set(name, value)
        moving = np.concatenate([np.add(nu[:3], R.T @ stream), nu[3:]])
        slopes.append(part.derivatives(state(part, moving, attitude, **lags)))
    still, carried = slopes
    still[:3] += water
    still[6:9] -= np.cross(nu[3:], R.T @ water)
    # Where the flow at a part all but vanishes, the rounding of current minus current is what is
    # left of it, and roots of it make more of that.
    np.testing.assert_allclose(carried, still, rtol=1e-11, atol=1e-10)


def test_a_current_carries_a_craft_with_all_parts():
    t, exact = np.array([0.0, 0.5, 1.0]), {"rtol": 1e-12, "atol": 1e-13}
    still, carried = (
        fitted(velocity_start=START + stream).reference(
            t, lambda t, x, stream=stream: inputs(ORDERS, ANGLES, stream), **exact
        )
        for stream in (0 * WATER, WATER)
    )
    assert off(carried.x, still.x, t, WATER) < 1e-9


def test_fixed_steps_lose_this_with_the_fourth_power_of_the_step():
    # Velocities in turning axes are not carried along exactly by a Runge-Kutta step.
    def states(velocity, moving, h):
        component = fitted(velocity_start=velocity, max_step=0.01)
        for name, value in inputs(ORDERS, ANGLES, moving).items():
            component.set(name, value)
        component.initialise()
        component.begin()
        for k in range(round(1 / h)):
            component.advance(k * h, h)
        return component._x.copy()

    errors = [
        off(states(START + WATER, WATER, h)[None], states(START, 0 * WATER, h)[None], [1.0], WATER)
        for h in (0.01, 0.005, 0.0025)
    ]
    assert errors[0] < 1e-7
    for coarse, fine in pairwise(errors):
        assert 12 < coarse / fine < 20


def test_with_the_speed_over_ground_propellers_know_the_current():
    water = np.array([0.5, 0.0, 0.0])
    still, carried = (
        fitted(speed_of_advance="over-ground", velocity_start=START + v) for v in (0 * water, water)
    )
    orders, t = [0.5] * 8, np.array([0.0, 1.0])
    a = still.reference(t, lambda t, x: inputs(orders, [0] * 8, 0 * water))
    b = carried.reference(t, lambda t, x: inputs(orders, [0] * 8, water))
    assert off(b.x, a.x, t, water) > 1e-3


@pytest.mark.parametrize("kind", ["thruster", "azimuth", "tunnel"])
def test_shear_is_met_at_the_place_of_a_part(kind):
    # A linear current over depth: a tunnel 2 m below the origin meets what is there.
    values = {"current_speed": 1.0, "current_profile": "linear", "current_reach": 10.0}
    part = craft(
        propulsors=kind,
        propulsor_position_1=(0, 0, 2.0),
        propulsor_axis_1=(0, 1, 0),
        propulsor_thrust_1=(30.0, 30.0),
        propulsor_fading_speed_1=2.0,
        propulsor_order=[1.0] + [0.0] * 7,
        position_start=(0, 0, 3.0),
        **values,
    )
    part.initialise()
    speed = 1.0 - 5.0 / 10.0
    left = 1 if kind == "thruster" else 1 - (speed / 2) ** 2
    assert part.get("propulsor_force")[0] == pytest.approx(30 * left, rel=1e-6)
