"""Orders that lag, are limited in rate, range and turn; and parts that are refused."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from tests.kits.fitted.fitting import craft, padded

THRUSTER = {"propulsor_thrust_1": (50.0, 50.0)}


def followed(component, name, t, **orders):
    """Return the first of a state over times, the craft held where it is by its mass."""
    return component.reference(t, lambda t, x: orders)[f"{name}.{'f1' if 'foil' in name else 'p1'}"]


def test_an_order_lags_by_its_time_constant_and_is_limited_before():
    t = np.linspace(0, 3, 7)
    part = craft(propulsors="thruster", propulsor_time_constant_1=0.8, **THRUSTER)
    for order, limited in ((0.5, 0.5), (4.0, 1.0), (-4.0, -1.0)):
        found = followed(part, "lagged_order", t, propulsor_order=padded(order))
        np.testing.assert_allclose(found, limited * -np.expm1(-t / 0.8), atol=1e-9)


def test_without_a_lag_the_order_acts_at_once_and_its_state_stays():
    part = craft(propulsors="thruster", **THRUSTER)
    part.set("propulsor_order", padded(0.5))
    part.initialise()
    assert part.get("propulsor_force")[0] == 25.0
    part.begin()
    part.advance(0.0, 0.1)
    assert part.get("lagged_order")[0] == 0.0


def test_a_rate_limit_is_kept_exactly():
    t = np.linspace(0, 2.5, 6)
    limits = {"propulsor_angle_limit_1": (-1.0, 1.0), "propulsor_angle_rate_1": 0.3}
    part = craft(propulsors="azimuth", **limits, **THRUSTER)
    found = followed(part, "lagged_angle", t, propulsor_angle=padded(0.9))
    np.testing.assert_allclose(found, 0.3 * t, atol=1e-10)
    settled = followed(part, "lagged_angle", [0, 6.0], propulsor_angle=padded(3.0))
    assert settled[-1] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(
    ("start", "order", "end"),
    [(0.0, 3.0, 3.0), (0.0, 3.3, 3.3 - math.tau), (3.0, -3.0, math.tau - 3.0), (20.0, 0.2, 19.05)],
)
def test_an_endless_azimuth_turns_the_shortest_way_and_counts(start, order, end):
    part = craft(
        propulsors="azimuth",
        propulsor_angle_limit_1=(-1e9, 1e9),
        propulsor_angle_time_constant_1=0.5,
        lagged_angle_start=padded(start),
        **THRUSTER,
    )
    found = followed(part, "lagged_angle", [0, 20.0], propulsor_angle=padded(order))[-1]
    assert found == pytest.approx(end, abs=5e-4 if start == 20 else 1e-9)
    assert math.remainder(found - order, math.tau) == pytest.approx(0, abs=1e-9)


def test_a_range_of_two_pi_is_endless_and_one_of_less_is_not():
    order = {"propulsor_angle": padded(-3.0)}
    shared = {"propulsors": "azimuth", "propulsor_angle_time_constant_1": 0.5, **THRUSTER}
    for low, high, end in [(-math.pi, math.pi, math.tau - 3.0), (-3.1, 3.1, -3.0)]:
        limits = {"propulsor_angle_limit_1": (low, high), "lagged_angle_start": padded(3.0)}
        part = craft(**shared, **limits)
        assert followed(part, "lagged_angle", [0, 20.0], **order)[-1] == pytest.approx(
            end, abs=1e-9
        )


def test_foils_and_ballast_follow_their_rates():
    part = craft(
        foils="fin",
        foil_angle_limit_1=0.5,
        foil_angle_rate_1=0.2,
        foil_time_constant_1=0.1,
        ballasts="tank",
        ballast_mass_1=1.0,
        ballast_rate_1=0.05,
    )
    orders = {"foil_angle": padded(-2.0), "ballast_order": padded(1.0)}
    run = part.reference([0, 2.0, 40.0], lambda t, x: orders)
    foil, tank = run["lagged_foil.f1"], run["lagged_ballast.b1"]
    assert foil[1] == pytest.approx(-0.4, abs=1e-9)
    assert foil[2] == pytest.approx(-0.5, abs=1e-9)
    assert tank[1:] == pytest.approx([0.1, 1.0], abs=1e-9)


def test_the_terminals_have_a_member_for_each_place():
    part = craft()
    assert part.terminals["propulsor_orders"].members["p3"] == "propulsor_order.p3"
    assert part.terminals["propulsor_angles"].members["p8"] == "propulsor_angle.p8"
    assert part.terminals["foil_angles"].members["f1"] == "foil_angle.f1"
    assert part.terminals["ballast_orders"].members["b2"] == "ballast_order.b2"
    assert "motion" in part.terminals


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"propulsors": "thrustr"}, "unknown kind 'thrustr'; did you mean 'thruster'"),
        ({"propulsors": "jet " * 9}, "9 are named, at most 8"),
        (
            {"propulsors": "thruster thruster", "propulsor_axis_2": (1, 1, 0)},
            r"craft.propulsor_axis_2 is \(1.0, 1.0, 0.0\), of a thruster: a unit vector .* 1.41421",
        ),
        (
            {"propulsors": "azimuth", "propulsor_angle_limit_1": (0.5, -0.5)},
            "propulsor_angle_limit_1 .* from may not be more than to",
        ),
        ({"propulsors": "tunnel", "propulsor_thrust_1": (0, 5)}, "propulsor_thrust_1 .* ahead"),
        ({"propulsors": "propeller"}, "propulsor_K_T_1 .* k0 of more than 0"),
        ({"propulsors": "wageningen-b", "propulsor_blades_1": 8}, "blades_1 is 8.0.* 2 to 7"),
        ({"propulsors": "wageningen-b", "propulsor_blades_1": 3.5}, "a whole number"),
        ({"propulsors": "wageningen-b", "propulsor_pitch_ratio_1": 2}, "0.5 to 1.4 are allowed"),
        ({"propulsors": "four-quadrant"}, "propulsor_C_T_1 .* other than 0"),
        (
            {"propulsors": "wageningen-b", "propulsor_speed_1": (0, 1)},
            "propulsor_speed_1 .* more than 0 is needed ahead",
        ),
        ({"propulsors": "wageningen-b", "propulsor_hand_1": 0}, "propulsor_hand_1 is 0.0"),
        (
            {"propulsors": "thruster", "foils": "rudder", "foil_behind_1": 2},
            "foil_behind_1 is 2.0, of a rudder: 0 for none, or the number of a propulsor, 1 to 1",
        ),
        ({"foils": "linear-fin"}, "foil_lift_1 is 0.0, of a linear-fin: more than 0"),
        ({"ballasts": "tank"}, "ballast_mass_1 is 0.0, of a tank"),
        ({"ballasts": "moving-mass", "ballast_mass_1": 1}, "ballast_travel_1"),
        (
            {"ballasts": "moving-mass", "ballast_mass_1": 1, "ballast_travel_1": 0.1}
            | {"ballast_axis_1": (0.6, 0.0, 0.9)},
            "ballast_axis_1 .* a unit vector is needed, its length is 1.08167",
        ),
        (
            {"ballasts": "buoyancy-engine", "ballast_volume_1": 0.05},
            "ballast_volume_1 is 0.05, .* less than the craft's 0.03902 m3",
        ),
        (
            {"restoring": "surface-linear", "ballasts": "buoyancy-engine", "ballast_volume_1": 1},
            "restoring is 'surface-linear', submerged or floating is needed",
        ),
    ],
)
def test_parts_that_cannot_be_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        craft(**values).initialise()


def test_places_beyond_the_kinds_are_not_checked():
    craft(propulsors="thruster", propulsor_axis_2=(3, 0, 0), ballast_axis_1=(0, 0, 0)).initialise()
    craft(ballasts="tank", ballast_mass_1=1.0, ballast_axis_1=(3, 0, 0)).initialise()
