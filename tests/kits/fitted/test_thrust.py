"""Thrusters, azimuths, outboards, tunnels and jets: closed forms, momentum and power."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kits.fitted.fitting import DENSITY, craft, load, padded, shown, state

PLACE = (-1.0, 0.4, 0.2)
LAW = {
    "propulsor_position_1": PLACE,
    "propulsor_thrust_1": (120.0, 70.0),
    "propulsor_exponent_1": 2.0,
    "propulsor_diameter_1": 0.2,
    "propulsor_speed_1": (150.0, 140.0),
}


def at(force, place=PLACE):
    return np.concatenate([force, np.cross(place, force)])


@pytest.mark.parametrize(("order", "thrust"), [(0.5, 30.0), (-0.5, -17.5), (3.0, 120.0), (0, 0)])
def test_a_thruster_follows_its_law_at_its_place_along_its_axis(order, thrust):
    axis = np.array([0.6, 0.0, 0.8])
    part = craft(propulsors="thruster", propulsor_axis_1=axis, propulsor_deduction_1=0.1, **LAW)
    found = load(part, (1.0, 0.3, -0.2, 0.1, 0.2, 0.3), propulsor_order=padded(order))
    np.testing.assert_allclose(found, at(0.9 * thrust * axis), atol=1e-12)
    shows = shown(part, propulsor_order=padded(order))
    assert shows("propulsor_force") == pytest.approx(0.9 * thrust)
    share = math.copysign(min(abs(order), 1), order)
    assert shows("propulsor_rate") == pytest.approx(share * (150 if order > 0 else 140))


def test_the_slope_of_a_linear_law_at_no_order_is_its_thrust():
    part = craft(propulsors="thruster", propulsor_thrust_1=(50.0, 50.0))
    linear = part.linearise(state(part))
    force = linear.y_names.index("propulsor_force.p1")
    assert linear.D[force, linear.u_names.index("propulsor_order.p1")] == pytest.approx(50.0)
    assert np.isfinite(linear.A).all()
    assert np.isfinite(linear.D).all()


@pytest.mark.parametrize("kind", ["azimuth", "outboard"])
def test_at_right_angles_the_moment_is_that_of_the_place(kind):
    part = craft(propulsors=kind, propulsor_angle_limit_1=(-math.pi, math.pi), **LAW)
    quarter = {"propulsor_order": padded(1), "propulsor_angle": padded(math.pi / 2)}
    found = load(part, **quarter)
    np.testing.assert_allclose(found, at([0, 120, 0]), atol=1e-12)
    assert found[5] == pytest.approx(PLACE[0] * 120)


# Angle, speed ahead, and the square of the speed that does not come from ahead of the propeller.
@pytest.mark.parametrize(
    ("angle", "order", "square"),
    [(0, 1, 0), (90, 1, 1.44), (180, 1, 1.44), (0, -1, 1.44), (180, -1, 0), (60, 1, 1.44 * 0.75)],
)
def test_an_azimuth_loses_thrust_when_turned_against_the_flow(angle, order, square):
    a = math.radians(angle)
    part = craft(
        propulsors="azimuth",
        propulsor_angle_limit_1=(-1e9, 1e9),
        propulsor_fading_speed_1=2.0,
        **LAW,
    )
    orders = {"propulsor_order": padded(order), "propulsor_angle": padded(a)}
    found = load(part, (1.2, 0, 0, 0, 0, 0), **orders)
    thrust = (120 if order > 0 else -70) * (1 - square / 4)
    np.testing.assert_allclose(
        found, at([thrust * math.cos(a), thrust * math.sin(a), 0]), atol=1e-11
    )
    assert not load(part, (0, 2.1, 0, 0, 0, 0), **orders | {"propulsor_angle": padded(0)})[:3].any()


@pytest.mark.parametrize(("speed", "left"), [(0, 1), (1, 0.75), (-1, 0.75), (2, 0), (5, 0)])
def test_a_tunnel_thruster_loses_thrust_with_the_speed_ahead_at_its_place(speed, left):
    tunnel = {**LAW, "propulsor_axis_1": (0, 1, 0), "propulsor_fading_speed_1": 2.0}
    part = craft(propulsors="tunnel", **tunnel)
    found = load(part, (speed, 0.7, 0, 0, 0, 0), propulsor_order=padded(1))
    np.testing.assert_allclose(found, at([0, 120 * left, 0]), atol=1e-11)
    # At a place to starboard the speed ahead is less by y r.
    found = load(part, (1.0, 0, 0, 0, 0, 0.5), propulsor_order=padded(1))
    assert found[1] == pytest.approx(120 * (1 - ((1.0 - 0.4 * 0.5) / 2) ** 2), rel=1e-12)


def test_without_a_fading_speed_nothing_fades():
    for kind in ("tunnel", "azimuth"):
        found = load(craft(propulsors=kind, **LAW), (3, 3, 3, 0, 0, 0), propulsor_order=padded(1))
        np.testing.assert_allclose(found, at([120, 0, 0]), atol=1e-11)


@pytest.mark.parametrize("speed", [0.0, 1.5])
def test_the_power_is_that_of_an_actuator_disk(speed):
    # The disk takes T (u + v), v its induced speed: T = 2 rho A v (u + v).
    part = craft(propulsors="thruster", **LAW)
    power = shown(part, (speed, 0, 0, 0, 0, 0), propulsor_order=padded(1))("propulsor_power")
    induced = power / 120 - speed
    area = math.pi / 4 * 0.2**2
    assert 2 * DENSITY * area * induced * (speed + induced) == pytest.approx(120, rel=1e-12)


JET = {**LAW, "propulsor_diameter_1": 0.1}
AREA = math.pi / 4 * 0.1**2


@pytest.mark.parametrize(("order", "bucket"), [(0.8, 1), (-0.8, -70 / 120)])
def test_a_jet_gives_the_momentum_that_it_moves(order, bucket):
    part = craft(propulsors="jet", propulsor_angle_limit_1=(-0.5, 0.5), **JET)
    a, v = 0.3, np.array([1.1, 0.2, -0.1])
    orders = {"propulsor_order": padded(order), "propulsor_angle": padded(a)}
    found = load(part, (*v, 0, 0, 0), **orders)
    speed = math.sqrt(120 * 0.64 / (DENSITY * AREA))
    flux = DENSITY * AREA * speed
    nozzle = np.array([math.cos(a), math.sin(a), 0])
    np.testing.assert_allclose(found, at(flux * (bucket * speed * nozzle - v)), atol=1e-11)
    power = shown(part, (*v, 0, 0, 0), **orders)("propulsor_power")
    assert power == pytest.approx(flux / 2 * (speed**2 - v @ v), rel=1e-12)


@pytest.mark.parametrize("order", [1.0, -1.0])
def test_a_jet_at_rest_gives_its_largest_thrust(order):
    found = load(craft(propulsors="jet", **JET), propulsor_order=padded(order))
    np.testing.assert_allclose(found, at([120 if order > 0 else -70, 0, 0]), atol=1e-11)


def test_a_jet_at_the_speed_of_its_water_gives_nothing():
    speed = math.sqrt(120 / (DENSITY * AREA))
    found = load(craft(propulsors="jet", **JET), (speed, 0, 0, 0, 0, 0), propulsor_order=padded(1))
    np.testing.assert_allclose(found, 0, atol=1e-10)


def test_a_jet_without_an_order_does_not_drag():
    assert not load(craft(propulsors="jet", **JET), (3, 1, 0, 0, 0, 0)).any()


SPEEDS = st.tuples(*[st.floats(-3, 3)] * 3)


@settings(max_examples=60, deadline=None)
@given(
    kind=st.sampled_from(["thruster", "azimuth", "outboard", "tunnel", "jet"]),
    order=st.floats(-1, 1),
    angle=st.floats(-3, 3),
    v=SPEEDS,
)
def test_no_work_comes_from_nothing(kind, order, angle, v):
    part = craft(
        propulsors=kind,
        propulsor_angle_limit_1=(-1e9, 1e9),
        propulsor_fading_speed_1=4.0,
        **{**JET, "propulsor_position_1": (0, 0, 0)},
    )
    orders = {"propulsor_order": padded(order), "propulsor_angle": padded(angle)}
    done = load(part, (*v, 0, 0, 0), **orders)[:3] @ v
    power = shown(part, (*v, 0, 0, 0), **orders)("propulsor_power")
    assert power >= 0
    assert done <= power + 1e-9
