"""Momentum and energy of each part: no part gives work that shaft, flow or weight does not."""

import math
import tomllib

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.physics.craft.kinematics import rotation
from seatrial.shipped import available
from seatrial_kits.fitted.parts.screws import all_quadrants
from seatrial_kits.fitted.parts.wageningen import wageningen_b, wageningen_b4_70
from tests.kits.fitted.fitting import BODY, DENSITY, craft, load, padded, shown, state

ANGLES = st.floats(-math.pi, math.pi)
SPEEDS = st.floats(-4, 4)


def disk_limit(power, diameter):
    """Return the largest thrust at rest, N, of an actuator disk: T^3 = 2 rho A P^2 (Rankine)."""
    return (2 * DENSITY * math.pi / 4 * diameter**2 * power**2) ** (1 / 3)


@pytest.mark.parametrize("kind", ["thruster", "azimuth", "outboard", "tunnel"])
def test_thrusters_at_rest_take_the_power_of_an_ideal_disk(kind):
    law = {"propulsor_thrust_1": (90.0, 60.0), "propulsor_diameter_1": 0.25}
    for order, thrust in ((1.0, 90.0), (-1.0, 60.0)):
        shows = shown(craft(propulsors=kind, **law), propulsor_order=padded(order))
        assert disk_limit(shows("propulsor_power"), 0.25) == pytest.approx(thrust, rel=1e-12)


def test_a_jet_at_rest_takes_the_energy_of_its_stream():
    """At rest T = rho A w^2 and P = rho A w^3 / 2: T^3 = 4 rho A P^2, twice an open disk's."""
    law = {"propulsor_thrust_1": (90.0, 60.0), "propulsor_diameter_1": 0.1}
    shows = shown(craft(propulsors="jet", **law), propulsor_order=padded(1))
    limit = 2 ** (1 / 3) * disk_limit(shows("propulsor_power"), 0.1)
    assert limit == pytest.approx(90.0, rel=1e-12)


@pytest.mark.parametrize("blades", [2, 3, 4, 5, 6, 7])
def test_propellers_of_the_series_at_rest_stay_below_the_ideal_disk(blades):
    """K_T^3 <= 2 pi^3 K_Q^2, which is T^3 <= 2 rho A P^2 with P = 2 pi n Q."""
    for pitch in (0.6, 0.8, 1.0, 1.2, 1.4):
        K_T, K_Q = (each[0] for each in wageningen_b(blades, pitch, 0.6))
        assert 0 < K_T**3 < 2 * math.pi**3 * K_Q**2


@pytest.mark.parametrize(("vehicle", "name"), [("remus100", "K"), ("kvlcc2", "propeller_K")])
def test_propellers_of_shipped_vehicles_at_rest_stay_below_the_ideal_disk(vehicle, name):
    """K_T^3 <= 2 pi^3 K_Q^2, by the coefficients at J = 0 of the vehicle's file."""
    data = tomllib.loads(available("vehicles")[vehicle].read_text("utf-8"))
    part = data["mmg-ship"] if "mmg-ship" in data else data["hull"]["propulsors"][0]
    found = [part[f"{name}_{letter}"] for letter in "TQ"]
    K_T, K_Q = ((each["value"] if isinstance(each, dict) else each)[0] for each in found)
    assert 0 < K_T**3 < 2 * math.pi**3 * K_Q**2


def test_the_propeller_of_four_quadrants_takes_energy_in_all_of_them():
    """2 pi n Q - V_a T > 0, for all signs of shaft speed and advance; at rest the ideal disk's T."""
    beta = np.linspace(-math.pi, math.pi, 721)
    n, advance = np.cos(beta) / (0.7 * math.pi), np.sin(beta)  # D = 1 m, V = 1 m/s
    found = all_quadrants(1.0, DENSITY, ca.DM(n), ca.DM(advance), wageningen_b4_70())
    thrust, moment = (np.array(each).ravel() for each in found)
    assert (math.tau * n * moment - advance * thrust > 0).all()
    at_rest = np.argmin(np.abs(beta))
    power = math.tau * n[at_rest] * moment[at_rest]
    assert 0 < thrust[at_rest] < disk_limit(power, 1.0)


@pytest.mark.parametrize("kind", ["propeller", "wageningen-b", "four-quadrant"])
@pytest.mark.parametrize(("order", "hand"), [(0.8, 1), (0.8, -1), (-0.6, 1)])
@pytest.mark.parametrize("speed", [-1.5, 2.0])
def test_the_shaft_does_the_work_of_its_reaction(kind, order, hand, speed):
    """P = -K Omega: the hull takes K = -hand Q about the axis, the shaft turns at hand Omega."""
    part = craft(
        propulsors=kind,
        propulsor_hand_1=hand,
        propulsor_diameter_1=0.3,
        propulsor_speed_1=(60.0, 40.0),
        propulsor_K_T_1=(0.4, -0.3, -0.15),
        propulsor_K_Q_1=(0.05, -0.02, -0.03),
        propulsor_C_T_1=(0.02, 0.18, 0.1, 0, 0, -0.7, 0, 0.02, 0),
        propulsor_C_Q_1=(0.03, 0.2, 0.1, 0, 0, -0.9, 0.1, 0.06, 0),
        propulsor_position_1=0.0,
    )
    nu, orders = (speed, 0.3, 0, 0, 0, 0), {"propulsor_order": padded(order)}
    reaction = load(part, nu, **orders)[3]
    shows = shown(part, nu, **orders)
    assert shows("propulsor_power") == pytest.approx(
        -hand * reaction * shows("propulsor_rate"), rel=1e-9
    )


@settings(max_examples=20, deadline=None)
@given(delta=st.floats(-1.5, 1.5), u=SPEEDS, v=SPEEDS)
def test_a_fins_lift_does_no_work_and_its_drag_takes_all(delta, u, v):
    """F . v = -rho/2 A C_D V^3 with C_D >= C_D0: the lift C_L is the force across v.

    Up to the stall, C_D = C_D0 + C_L^2 / (0.9 pi AR).
    """
    area, aspect, profile = 0.02, 1.5, 0.01
    part = craft(
        foils="fin",
        foil_area_1=area,
        foil_aspect_ratio_1=aspect,
        foil_angle_limit_1=1.5,
        foil_profile_drag_1=profile,
    )
    V = math.hypot(u, v)
    if V < 0.05:
        return
    force = load(part, (u, v, 0, 0, 0, 0), foil_angle=padded(delta))[:2]
    scale = DENSITY / 2 * area * V**2
    C_D = -(force @ [u, v]) / V / scale
    C_L = (force[0] * v - force[1] * u) / V / scale
    assert profile - C_D < 1e-9
    attack = math.asin(math.sin(math.atan2(v, u) + delta))  # e is to port
    if abs(attack) < 0.39:
        induced = C_L**2 / (0.9 * math.pi * aspect)
        assert C_D - profile == pytest.approx(induced, rel=1e-9, abs=1e-9)


@settings(max_examples=20, deadline=None)
@given(delta=st.floats(-1, 1), u=SPEEDS, v=SPEEDS)
def test_a_rudder_takes_the_work_of_its_normal_force(delta, u, v):
    """F . v = -rho/2 A f_alpha V^3 sin^2(alpha), and no force along its chord."""
    part = craft(foils="rudder", foil_area_1=0.02, foil_aspect_ratio_1=1.5, foil_angle_limit_1=1.5)
    V = math.hypot(u, v)
    if abs(u) < 0.05:
        return
    force = load(part, (u, v, 0, 0, 0, 0), foil_angle=padded(delta))[:2]
    alpha = delta + math.atan2(v, u)  # gamma_R = 1; the drift is positive to port
    slope = 6.13 * 1.5 / (1.5 + 2.25)
    taken = DENSITY / 2 * 0.02 * slope * V**3 * math.sin(alpha) ** 2
    assert force @ [u, v] == pytest.approx(-taken, rel=1e-9, abs=1e-9)
    assert force @ [math.cos(delta), -math.sin(delta)] == pytest.approx(0, abs=1e-9)


@settings(max_examples=20, deadline=None)
@given(angle=ANGLES, wind=st.tuples(SPEEDS, SPEEDS), v=st.tuples(SPEEDS, SPEEDS), heading=ANGLES)
def test_a_sail_takes_its_work_from_the_air(angle, wind, v, heading):
    """F . (v - w) <= 0: in the frame of the air a sail only brakes, however the craft moves."""
    part = craft(foils="sail", foil_area_1=2.0, foil_angle_limit_1=4.0)
    cos, sin = math.cos(heading), math.sin(heading)
    air = np.array([cos * wind[0] + sin * wind[1], cos * wind[1] - sin * wind[0]])
    orders = {"wind": wind, "foil_angle": padded(angle)}
    force = load(part, (*v, 0, 0, 0, 0), (0, 0, heading), **orders)[:2]
    assert force @ (v - air) <= 1e-9


MOVING = {
    "ballasts": "moving-mass",
    "ballast_mass_1": 5.0,
    "ballast_position_1": (-0.1, 0.02, 0.04),
    "ballast_axis_1": (0.8, 0.0, 0.6),
    "ballast_travel_1": 0.2,
}


def mass_matrix(masses):
    """Return M (6, 6) of the body of `fitting` in water with point masses (kg, place) added."""
    M = craft().mass_matrix()
    for m, r in masses:
        S = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
        J = np.hstack([np.eye(3), -S])
        M = M + m * J.T @ J
    return M


def moved(share):
    """Return the point masses that the moving mass takes away and adds at its share of travel."""
    place = np.array(MOVING["ballast_position_1"])
    return [(-5.0, place), (5.0, place + share * 0.2 * np.array([0.8, 0, 0.6]))]


@pytest.mark.parametrize("share", [-0.7, 0.0, 1.0])
def test_a_craft_with_a_moved_mass_keeps_momentum_and_energy(share):
    """Free, in a void: d/dt R p = 0, d/dt (R h) = -v x p, d/dt (nu . M nu / 2) = 0.

    M nu = (p, h) about the body origin, whose velocity is v: the moved mass pulls at the hull as
    the hull at the moved mass.
    """
    void = {"added_mass": 0.0, "added_inertia": 0.0, "terms": "coriolis"}
    part = craft(**void, **MOVING)
    part.set("ballast_order", padded(share))
    nu = np.array([1.1, 0.4, -0.3, 0.5, -0.2, 0.7])
    M = mass_matrix(moved(share)) - np.diag([3, 30, 32, 0.2, 4, 4.1])
    nu_dot = part.derivatives(state(part, nu, (0.2, -0.3, 0.5)))[6:12]
    (p, h), (p_dot, h_dot) = ((M @ each).reshape(2, 3) for each in (nu, nu_dot))
    v, omega = nu.reshape(2, 3)
    np.testing.assert_allclose(p_dot + np.cross(omega, p), 0, atol=1e-11)
    np.testing.assert_allclose(h_dot + np.cross(omega, h) + np.cross(v, p), 0, atol=1e-11)
    assert nu @ M @ nu_dot == pytest.approx(0, abs=1e-11)


ENGINE = {
    "ballasts": "buoyancy-engine",
    "ballast_volume_1": 1e-3,
    "ballast_position_1": (0.3, 0, 0),
}


@pytest.mark.parametrize(
    ("ballast", "order", "masses", "displaced"),
    [
        (MOVING, 0.6, moved(0.6), []),
        (ENGINE, -0.4, [], [(-0.4e-3 * DENSITY, np.array([0.3, 0, 0]))]),
    ],
)
def test_the_load_at_rest_is_the_slope_of_the_potential_energy(ballast, order, masses, displaced):
    """Load . nu = -dU/dt, U = -g (sum of m z_n of the masses - that of the displaced water).

    A point at r sinks by down . (v + omega x r), so that the force is g m down and the moment
    r x it; the body's own weight and buoyancy have the moment of m z_G alone.
    """
    part = craft(**ballast)
    part.set("ballast_order", padded(order))
    attitude = (0.3, -0.4, 0.6)
    found = mass_matrix(masses) @ part.derivatives(state(part, attitude=attitude))[6:12]
    heavy = [*masses, *[(-m, r) for m, r in displaced]]
    total = sum(m for m, _ in heavy)
    first = BODY["mass"] * np.array(BODY["center_of_gravity"]) + sum(m * r for m, r in heavy)
    down = np.array(rotation(*attitude))[2]  # of {n}, in body axes
    np.testing.assert_allclose(found[:3], 9.81 * total * down, atol=1e-10)
    np.testing.assert_allclose(found[3:], 9.81 * np.cross(first, down), atol=1e-10)
