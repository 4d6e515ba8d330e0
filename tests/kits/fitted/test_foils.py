"""Fins, fins by a linear law, rudders in a race (MMG), sails."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial_kits.fitted.parts.lift import lift_slope
from tests.kits.fitted.fitting import DENSITY, craft, load, padded

FIN = {
    "foil_position_1": (-0.8, 0.0, -0.1),
    "foil_area_1": 0.02,
    "foil_aspect_ratio_1": 1.5,
    "foil_angle_limit_1": 1.5,
    "foil_profile_drag_1": 0.01,
}


def fin(roll=0.0, **values):
    return craft(foils="fin", foil_roll_1=roll, **{**FIN, **values})


def with_moment(force, place=FIN["foil_position_1"]):
    return np.concatenate([force, np.cross(place, force)])


@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.0, 3.0])
def test_the_slope_is_that_of_foils_of_low_aspect_ratio(aspect):
    # Whicker & Fehlner 1958, of an unswept foil: 0.9 of the lifting line's 2 pi.
    part, delta = fin(foil_aspect_ratio_1=aspect), 1e-5
    forces = [
        load(part, (1.0, 0, 0, 0, 0, 0), foil_angle=padded(angle))[1] for angle in (-delta, delta)
    ]
    slope = (forces[0] - forces[1]) / (2 * delta) / (DENSITY / 2 * 0.02)
    published = 0.9 * 2 * math.pi * aspect / (math.sqrt(aspect**2 + 4) + 1.8)
    assert slope == pytest.approx(published, rel=3e-5)
    # Helmbold's 2 pi AR / (2 + sqrt(AR^2 + 4)) has the whole 2 pi.
    helmbold = 2 * math.pi * aspect / (2 + math.sqrt(aspect**2 + 4))
    assert 0.9 < slope / helmbold < 0.95


def test_the_slope_goes_to_that_of_the_section():
    assert lift_slope(1e6) == pytest.approx(0.9 * 2 * math.pi, rel=1e-5)


def test_at_no_angle_of_attack_there_is_drag_alone():
    drag = DENSITY / 2 * 0.02 * 1.44 * 0.01
    np.testing.assert_allclose(
        load(fin(), (1.2, 0, 0, 0, 0, 0)), with_moment([-drag, 0, 0]), atol=1e-12
    )


def test_lift_and_drag_below_the_stall():
    delta, U = 0.2, 1.3
    C_L = lift_slope(1.5) * delta + 0.8 / 1.5 * delta**2
    C_D = 0.01 + C_L**2 / (0.9 * math.pi * 1.5)
    q = DENSITY / 2 * 0.02 * U**2
    found = load(fin(), (U, 0, 0, 0, 0, 0), foil_angle=padded(delta))
    expected = with_moment([-q * C_D, -q * C_L, 0])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    assert found[5] > 0  # a positive angle turns to starboard
    # The same angle between flow and fin by drift: the flow turns, and the force with it.
    v = (U * math.cos(delta), U * math.sin(delta), 0, 0, 0, 0)
    found = load(fin(), v, foil_angle=padded(0))
    cos, sin = math.cos(delta), math.sin(delta)
    turned = [-q * (C_D * cos - C_L * sin), -q * (C_L * cos + C_D * sin), 0]
    np.testing.assert_allclose(found, with_moment(turned), rtol=1e-12, atol=1e-12)


def test_a_stern_plane_with_its_span_to_starboard_puts_the_bow_down():
    found = load(fin(math.pi / 2), (1.2, 0, 0, 0, 0, 0), foil_angle=padded(0.1))
    assert found[2] < 0
    assert found[4] < 0


@settings(max_examples=40, deadline=None)
@given(delta=st.floats(-1.5, 1.5), u=st.floats(-3, 3), v=st.floats(-3, 3), roll=st.floats(-3, 3))
def test_a_fin_is_antisymmetric_and_takes_energy(delta, u, v, roll):
    e = np.array([0, -math.cos(roll), -math.sin(roll)])
    part = fin(roll)
    found = load(part, (u, *(v * e)[1:], 0, 0, 0), foil_angle=padded(delta))[:3]
    mirrored = load(part, (u, *(-v * e)[1:], 0, 0, 0), foil_angle=padded(-delta))[:3]
    np.testing.assert_allclose(mirrored, found - 2 * (found @ e) * e, atol=1e-9)
    assert found @ np.array([u, *(v * e)[1:]]) <= 1e-9


def test_a_fin_separates_to_a_plate_and_has_no_steps():
    # At 90 degrees a plate of low aspect ratio: 1.17 on its area, and the profile drag.
    across = load(fin(), (0, -1.0, 0, 0, 0, 0))
    assert across[1] == pytest.approx(DENSITY / 2 * 0.02 * (1.17 + 0.01), rel=1e-12)
    angles = np.radians(np.arange(-90, 90.1, 0.5))
    part = fin()
    force = np.array([load(part, (math.cos(a), math.sin(a), 0, 0, 0, 0))[:2] for a in angles])
    steps = np.abs(np.diff(force, axis=0)).max()
    assert steps < 0.03 * np.abs(force).max()


def test_a_fin_meets_the_flow_of_its_own_place():
    # Turning at r, a fin 0.8 m aft goes to port through the water.
    part = fin()
    turning = load(part, (1.0, 0, 0, 0, 0, 0.3))
    drifting = load(part, (1.0, -0.8 * 0.3, 0, 0, 0, 0))
    np.testing.assert_allclose(turning, drifting, atol=1e-12)


def test_fins_round_the_tail_give_pure_moments():
    # Three fins at 120 degrees, all by the same angle, 0.1 m off the axis: roll and drag alone.
    rolls = [0, 2 * math.pi / 3, -2 * math.pi / 3]
    values = {}
    for k, roll in enumerate(rolls, 1):
        values[f"foil_roll_{k}"] = roll
        values[f"foil_position_{k}"] = (-0.8, 0.1 * math.sin(roll), -0.1 * math.cos(roll))
        values[f"foil_area_{k}"], values[f"foil_aspect_ratio_{k}"] = 0.02, 1.5
    found = load(
        craft(foils="fin fin fin", **values), (1.5, 0, 0, 0, 0, 0), foil_angle=padded(0.1, 0.1, 0.1)
    )
    lift = DENSITY / 2 * 0.02 * 2.25 * (lift_slope(1.5) * 0.1 + 0.8 / 1.5 * 0.01)
    assert found[0] < 0
    np.testing.assert_allclose(found[1:], [0, 0, -3 * 0.1 * lift, 0, 0], atol=1e-12)


@pytest.mark.parametrize("roll", [0.0, math.pi / 2, 0.7])
def test_a_linear_fin_knows_its_own_angle_alone(roll):
    values = {"foil_position_1": (-0.8, 0, 0), "foil_area_1": 0.0133, "foil_lift_1": 0.5}
    part = craft(foils="linear-fin", foil_roll_1=roll, **values)
    v, delta = np.array([1.4, 0.3, -0.2]), 0.1
    found = load(part, (*v, 0, 0.2, 0.3), foil_angle=padded(delta))
    e = np.array([0, -math.cos(roll), -math.sin(roll)])
    force = DENSITY / 2 * (1.4**2 + (e @ v) ** 2) * 0.0133 * 0.5
    expected = force * (delta * e - np.array([delta**2, 0, 0]))
    np.testing.assert_allclose(found, with_moment(expected, (-0.8, 0, 0)), rtol=1e-12, atol=1e-12)


# KVLCC2 at 1:45.7, Yasukawa & Yoshimura 2015; 6.13 AR / (AR + 2.25) of AR = 1.827 is 2.747.
K_T = (0.2931, -0.2753, -0.1385)
L, D, H_R, A_R, T_R, A_H = 7.0, 0.216, 0.345, 0.0539, 0.387, 0.312
X_R, X_H, L_R, EPS, KAPPA, W_P = -3.5, -0.464 * 7, -0.710 * 7, 1.09, 0.50, 0.40
KVLCC2 = {
    "propulsors": "propeller",
    "propulsor_position_1": (-0.48 * 7, 0, 0),
    "propulsor_diameter_1": D,
    "propulsor_speed_1": (100.0, 100.0),
    "propulsor_wake_1": W_P,
    "propulsor_moment_share_1": 0.0,
    "propulsor_deduction_1": 1.0,
    "propulsor_K_T_1": K_T,
    "foils": "rudder",
    "foil_position_1": (X_R, 0, 0),
    "foil_area_1": A_R,
    "foil_aspect_ratio_1": 1.827,
    "foil_behind_1": 1,
    "foil_covered_1": D / H_R,
    "foil_race_gain_1": KAPPA,
    "foil_wake_ratio_1": EPS,
    "foil_straightening_1": (0.640, 0.395),
    "foil_flow_aft_1": X_R - L_R,
    "foil_deduction_1": T_R,
    "foil_hull_share_1": A_H,
    "foil_hull_position_1": X_H,
}
"""The propeller's own force is deducted whole: what remains is the rudder's."""


def mmg(u, beta_R, delta, n):
    """Return X, Y, N of the rudder by the equations of the method, v_R = u gamma_R tan(beta_R)."""
    J = u * (1 - W_P) / (n * D)
    thrust = K_T[0] + K_T[1] * J + K_T[2] * J**2
    eta = D / H_R
    race = 1 + KAPPA * (math.sqrt(1 + 8 * thrust / (math.pi * J**2)) - 1)
    u_R = EPS * u * (1 - W_P) * math.sqrt(eta * race**2 + 1 - eta)
    v_R = u * (0.640 if beta_R > 0 else 0.395) * math.tan(beta_R)
    alpha = delta - math.atan2(v_R, u_R)
    F_N = DENSITY / 2 * A_R * (u_R**2 + v_R**2) * 2.747 * math.sin(alpha)
    cos, sin = math.cos(delta), math.sin(delta)
    return [
        -(1 - T_R) * F_N * sin,
        -(1 + A_H) * F_N * cos,
        -(X_R + A_H * X_H) * F_N * cos,
    ]


@pytest.mark.parametrize("delta", [0.0, 0.3, -0.6])
@pytest.mark.parametrize("beta_R", [0.0, 0.2, -0.3])
@pytest.mark.parametrize("by", ["drift", "turning"])
def test_a_rudder_in_a_race_is_that_of_the_mmg_method(delta, beta_R, by):
    u, n = 1.1, 11.855
    across = -u * math.tan(beta_R)
    nu = (u, across, 0, 0, 0, 0) if by == "drift" else (u, 0, 0, 0, 0, across / L_R)
    orders = {"propulsor_order": padded(n * math.tau / 100), "foil_angle": padded(delta)}
    part = craft(**KVLCC2, foil_angle_limit_1=1.0)
    X, Y, Z, K, M, N = load(part, nu, **orders)
    expected = mmg(u, beta_R, delta, n)
    np.testing.assert_allclose((X, Y, N), expected, rtol=3e-4, atol=1e-12)  # 2.747 is rounded
    np.testing.assert_allclose((Z, K, M), 0, atol=1e-14)


def test_behind_no_propulsor_a_rudder_meets_the_flow_alone():
    part = craft(**{**KVLCC2, "foil_behind_1": 0, "foil_angle_limit_1": 1.0})
    found = load(part, (2.0, 0, 0, 0, 0, 0), foil_angle=padded(0.2))
    slope = 6.13 * 1.827 / (1.827 + 2.25)
    normal = DENSITY / 2 * A_R * (EPS * 2.0) ** 2 * slope * math.sin(0.2)
    assert found[1] == pytest.approx(-(1 + A_H) * normal * math.cos(0.2), rel=1e-12)


def test_a_rudder_at_rest_works_in_the_race_alone():
    # The race far behind an actuator disk at rest has sqrt(8 T / (pi rho D^2)); kappa of it here.
    part = craft(**KVLCC2, foil_angle_limit_1=1.0)
    n = 11.855
    found = load(part, propulsor_order=padded(n * math.tau / 100), foil_angle=padded(0.3))
    race = KAPPA * math.sqrt(8 * K_T[0] * n**2 * D**2 / math.pi)
    slope = 6.13 * 1.827 / (1.827 + 2.25)
    normal = DENSITY / 2 * A_R * EPS**2 * D / H_R * race**2 * slope * math.sin(0.3)
    assert found[0] == pytest.approx(-(1 - T_R) * normal * math.sin(0.3), rel=1e-8)
    assert not load(part, propulsor_order=padded(0))[:3].round(9).any()


def test_astern_the_rudder_acts_the_other_way_round():
    part = craft(**{**KVLCC2, "foil_behind_1": 0, "foil_angle_limit_1": 1.0})
    ahead = load(part, (1.0, 0, 0, 0, 0, 0), foil_angle=padded(0.2))
    astern = load(part, (-1.0, 0, 0, 0, 0, 0), foil_angle=padded(0.2))
    np.testing.assert_allclose(astern, -ahead, atol=1e-12)
