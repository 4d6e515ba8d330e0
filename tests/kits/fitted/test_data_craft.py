"""Supply ship and WAM-V by data: main particulars, balances and time constants in closed form."""

import math

import numpy as np
import pytest

from tests.craft.references import shipped

G, RHO = 9.81, 1025.0
L, B, T, C_B, C_W = 83.0, 18.0, 5.0, 0.65, 0.8
X_G, Z_G = -4.5, -1.2
M = RHO * L * B * T * C_B
M_A = {"22": 3e6, "26": -6e6, "33": 8e6, "44": 1.02e8, "46": -1.03e8, "66": 1.156e9}
"""Added mass of MSS's osv.m."""


def ship(**values):
    return shipped("fitted-craft", "supply-ship.hull", **values)


def boat(variant=None, **values):
    """Return the WAM-V with about the hydrostatics that follow from its shape."""
    afloat = {"waterplane_area": 3.2, "GM_T": 19.0, "GM_L": 35.0}
    return shipped("fitted-craft", "wam-v.hull", variant, **{**afloat, **values})


def orders(*shares, angles=()):
    """Return inputs of propulsors that have these orders and angles."""
    return {
        "propulsor_order": [*shares, *[0] * (8 - len(shares))],
        "propulsor_angle": [*angles, *[0] * (8 - len(angles))],
    }


def speeds(component, until, inputs, **start):
    """Return the velocities and rates at the end of a run under steady inputs."""
    for name, value in start.items():
        component.set(name, value)
    run = component.reference(np.array([0.0, until]), lambda t, x: inputs)
    names = ("velocity.u", "velocity.v", "velocity.w", "rates.p", "rates.q", "rates.r")
    return np.array([run[name][-1] for name in names])


def test_the_supply_ship_has_the_mass_matrix_of_its_source():
    matrix = ship().mass_matrix()
    assert matrix[0, 0] == pytest.approx(M + 1e6, rel=1e-12)
    assert matrix[1, 1] == pytest.approx(M + M_A["22"], rel=1e-12)
    assert matrix[1, 5] == pytest.approx(M * X_G + M_A["26"], rel=1e-12)
    assert matrix[2, 2] == pytest.approx(M + M_A["33"], rel=1e-12)
    assert matrix[3, 3] == pytest.approx(M * ((0.35 * B) ** 2 + Z_G**2) + M_A["44"], rel=1e-12)
    assert matrix[3, 5] == pytest.approx(-M * X_G * Z_G + M_A["46"], rel=1e-12)
    assert matrix[5, 5] == pytest.approx(M * ((0.25 * L) ** 2 + X_G**2) + M_A["66"], rel=1e-12)


def test_the_supply_ship_floats_as_its_source_computes():
    volume, plane = M / RHO, C_W * L * B
    lever = T - (2.5 * T - volume / plane) / 3 - Z_G
    munro_smith = 6 * C_W**3 / ((1 + C_W) * (1 + 2 * C_W))
    across = munro_smith * B**3 * L / 12 / volume - lever
    along = 0.7 * L**3 * B / 12 / volume - lever
    assert ship().get("GM_T") == pytest.approx(across, rel=1e-12)
    assert ship().get("GM_L") == pytest.approx(along, rel=1e-12)
    damping, matrix = ship().get("linear_damping_moment"), ship().mass_matrix()
    roll = 2 * 0.15 * math.sqrt(M * G * across * matrix[3, 3])
    stiffness = M * G * along + RHO * G * plane * 0.5**2
    pitch = 2 * 0.3 * math.sqrt(stiffness * matrix[4, 4])
    assert damping == pytest.approx([roll, pitch, matrix[5, 5]], rel=1e-12)


def test_equal_azimuths_ahead_give_their_share_of_the_top_speed():
    # 7.7 m/s are those of 420 kN and 655 kN; alike they have no moment. Thrust goes by the square.
    found = speeds(ship(), 1500.0, orders(0, 0, 1, math.sqrt(420 / 655)))
    assert found[0] == pytest.approx(7.7 * math.sqrt(2 * 420 / 1075), rel=1e-6)
    assert np.abs(found[1:]).max() < 1e-6


def test_tunnels_push_abeam_and_azimuths_where_they_point():
    component = ship(**{f"propulsor_time_constant_{k}": 0 for k in (1, 2, 3, 4)})
    component.set("velocity_start", (0, 0, 0))
    for name, value in orders(1, -0.5, 0.5, 1, angles=(0, 0, math.pi / 2, -math.pi / 2)).items():
        component.set(name, value)
    component.initialise()
    forces = component.get("propulsor_force")[:4]
    assert forces == pytest.approx([300e3, -75e3, 105e3, 655e3], rel=1e-9)


@pytest.mark.parametrize(("thrust", "share"), [(500.0, 1.0), (250.0, 0.5)])
def test_the_wam_v_ahead_goes_where_its_drag_balances_the_thrust(thrust, share):
    known = (-51.3 + math.sqrt(51.3**2 + 4 * 72.4 * thrust)) / (2 * 72.4)
    found = speeds(boat(), 120.0, orders(share, share))
    assert found[0] == pytest.approx(known, rel=1e-4)
    assert abs(found[5]) < 1e-9


def test_the_wam_v_turns_by_its_outboards_as_its_yaw_damping_allows():
    # Both at 90 degrees to port push the stern to port: it turns to starboard, at N / 400 N.m.s.
    share, angle = 0.02, -math.pi / 2
    found = speeds(boat(), 60.0, orders(share, share, angles=(angle, angle)))
    assert found[5] == pytest.approx(2 * share * 250 * 2.373776 / 400, rel=0.02)


def test_a_wam_v_without_thrust_slows_down_as_its_drag_says():
    # u' = -(d1 + d2 u) u / m: u = d1 u0 e / (d1 + d2 u0 (1 - e)), e = exp(-d1 t / m).
    u0, t = 2.0, 5.0
    e = math.exp(-51.3 * t / 180)
    known = 51.3 * u0 * e / (51.3 + 72.4 * u0 * (1 - e))
    found = speeds(boat(), t, orders(0.0), velocity_start=(u0, 0, 0))
    assert found[0] == pytest.approx(known, rel=1e-6)


def test_added_mass_makes_the_wam_v_turn_by_munk_moments():
    # Of an oblique course, N = -(Y - X) u v of the added mass; without added mass there is none.
    course = {"velocity_start": (1.0, 0.2, 0.0)}
    bare, added = (
        speeds(boat(variant, linear_damping_moment=(100, 100, 0)), 0.5, orders(0.0), **course)[5]
        for variant in ("vrx", "added-mass")
    )
    assert bare == pytest.approx(0.0, abs=1e-9)
    assert added < -1e-3
