"""KVLCC2 by the MMG standard method: recorded trajectories, and the method's formulas in numpy."""

import csv
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seatrial.errors import InputError
from seatrial_kits.fitted.parts.wageningen import wageningen_b
from tests.craft.references import DATA, assert_met, shipped

COLUMNS = ("x", "y", "psi", "u", "v", "r")
RUNS = {
    "l7_turn_p35": "model",
    "l7_zigzag_10_10": "model",
    "l7_zigzag_m20_20": "model",
    "full_turn_m35": "ship",
    "full_zigzag_20_20": "ship",
}
CURRENT = (0.5, 1.0)
"""Of full_turn_p35_current, m/s to north and east."""
RATE = math.radians(2.34)
"""Of the rudder, at 320 m."""


def ship(variant="ship", **values):
    return shipped("mmg-ship", "kvlcc2.mmg-ship", variant, **{"propeller_order": 1.0, **values})


def columns(run):
    """Return the columns by name; below the names stands a row of units."""
    with (DATA / f"kvlcc2_{run}.csv").open() as file:
        _units, *rows = csv.DictReader(file)
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def corners(t, delta, rate):
    """Return times and angles between which the recorded rudder moves evenly.

    It moves at 0 or +-``rate``: a slope between two rows that is neither has a corner between
    them, from the slope before to the slope after.
    """
    h = t[1] - t[0]
    slopes = np.diff(delta) / h
    known = np.array([-rate, 0.0, rate])
    nearest = known[np.abs(slopes[:, None] - known).argmin(1)]
    found = [(t[0], delta[0]), (t[-1], delta[-1])]
    between = np.abs(slopes - nearest) > 1e-9
    for i in np.flatnonzero(between):
        before, after = nearest[i - 1], nearest[i + 1]
        turned = h * (slopes[i] - after) / (before - after)
        found.append((t[i] + turned, delta[i] + before * turned))
    for i in np.flatnonzero(nearest[1:] != nearest[:-1]):
        if not between[i : i + 2].any():
            found.append((t[i + 1], delta[i + 1]))
    return np.transpose(sorted(found))


def recorded(run, variant):
    """Return the columns, the rudder's corners, and a ship at the start of the record."""
    expected = columns(run)
    length = {"ship": 320.0, "model": 7.0}[variant]
    steered = corners(expected["t"], expected["delta"], RATE * math.sqrt(320.0 / length))
    start = [expected[name][0] for name in ("u", "v", "r")]
    return expected, steered, ship(variant, nu_start=start)


# ---------------------------------------------------------------------- trajectories


@pytest.mark.parametrize(("run", "variant"), RUNS.items())
def test_trajectories_are_those_computed_independently(run, variant):
    expected, (times, angles), vessel = recorded(run, variant)
    rows = slice(None, None, 30)
    found = vessel.reference(
        expected["t"][rows],
        lambda t, _x: {"rudder": -np.interp(t, times, angles)},
        times,
        rtol=1e-9,
    )
    names = {name: expected[name][rows] for name in COLUMNS}
    assert_met(found.x, names, COLUMNS, tolerance=1e-7, least=0.0)


@pytest.mark.slow
def test_a_turn_in_a_current_is_that_computed_independently():
    expected, (times, angles), vessel = recorded("full_turn_p35_current", "ship")
    vessel.set("current_speed", math.hypot(*CURRENT))
    vessel.set("current_direction", math.atan2(*CURRENT[::-1]))
    h, rows = 0.1, []
    vessel.setup(0.0)
    vessel.initialise()
    vessel.begin()
    for k in range(10 * (len(expected["t"]) - 1) + 1):
        if k % 10 == 0:
            rows.append([*vessel.get("eta"), *vessel.get("nu")])
        vessel.set("rudder", -float(np.interp((k + 0.5) * h, times, angles)))
        vessel.advance(k * h, h)
    # The rudder is held over a step of 0.1 s.
    assert_met(rows, expected, COLUMNS, tolerance=1e-6, least=0.0)


@pytest.mark.parametrize(("helm", "turn"), [(-1.0, -0.184), (1.0, 0.082)])
def test_the_ship_turns_at_small_helm_as_an_unstable_one(helm, turn):
    run = ship().reference([0.0, 12000.0], lambda _t, _x: {"rudder": -math.radians(helm)})
    u, v, r = run.x[-1, 3:]
    assert r * 320.0 / math.hypot(u, v) == pytest.approx(turn, abs=5e-4)


@pytest.mark.parametrize("variant", ["ship", "model"])
def test_the_straight_approach_is_steady_and_unstable(variant):
    vessel = ship(variant)
    ahead = np.array([0, 0, 0, vessel.nu_start[0], 0, 0])
    np.testing.assert_allclose(vessel.derivatives(ahead)[3:], 0.0, atol=1e-12)
    assert (np.linalg.eigvals(vessel.linearise(ahead).A[4:, 4:]) > 0).sum() == 1


# ---------------------------------------------------------------------- the method's formulas

DIMENSIONS = {
    "ship": (320.0, 20.8, 312600.0, 11.2, 9.86, 15.80, 112.5, 1025.0, 0.35, 1.7785105973628206),
    "model": (7.0, 0.46, 3.27, 0.25, 0.216, 0.345, 0.0539, 1000.0, 0.40, 11.855149524425073),
}
"""L, d, volume, x_G, D, H_R, A_R, rho, w_P0, n: Yasukawa & Yoshimura 2015."""


def propeller(variant, u, v, r, n):
    """Return J, K_T and the advance u (1 - w_P)."""
    L, _d, _volume, _x_G, D, _H_R, _A_R, _rho, w_P0, _n = DIMENSIONS[variant]
    beta_P = math.atan2(-v, u) + 0.48 * r * L / math.hypot(u, v)
    C2 = 1.6 if beta_P > 0 else 1.1
    advance = u * (1 - w_P0) * (1 + (1 - math.exp(-2.0 * abs(beta_P))) * (C2 - 1))
    J = advance / (n * D)
    return J, 0.2931 - 0.2753 * J - 0.1385 * J**2, advance


def rudder(variant, u, v, r, delta, n):
    """Return u_R, v_R, F_N."""
    L, _d, _volume, _x_G, D, H_R, A_R, rho, _w, _n = DIMENSIONS[variant]
    J, K_T, advance = propeller(variant, u, v, r, n)
    U, eta = math.hypot(u, v), D / H_R
    beta_R = math.atan2(-v, u) + 0.710 * r * L / U
    race = 1 + 0.50 * (math.sqrt(1 + 8 * K_T / (math.pi * J**2)) - 1)
    u_R = 1.09 * advance * math.sqrt(eta * race**2 + 1 - eta)
    v_R = U * (0.395 if beta_R < 0 else 0.640) * beta_R
    alpha = delta - math.atan2(v_R, u_R)
    return u_R, v_R, rho / 2 * A_R * (u_R**2 + v_R**2) * 2.747 * math.sin(alpha)


def accelerations(variant, u, v, r, delta, n):
    """Return u', v', r' by the equations of the method; delta is positive to starboard."""
    L, d, volume, x_G, D, _H_R, _A_R, rho, _w, _n = DIMENSIONS[variant]
    U, m = math.hypot(u, v), rho * volume
    a, b = v / U, r * L / U
    X = -0.022 - 0.040 * a**2 + 0.002 * a * b + 0.011 * b**2 + 0.771 * a**4
    Y = -0.315 * a + 0.083 * b - 1.607 * a**3 + 0.379 * a**2 * b - 0.391 * a * b**2 + 0.008 * b**3
    N = -0.137 * a - 0.049 * b - 0.030 * a**3 - 0.294 * a**2 * b + 0.055 * a * b**2 - 0.013 * b**3
    X, Y, N = rho / 2 * L * d * U**2 * np.array([X, Y, L * N])
    X += (1 - 0.220) * rho * n**2 * D**4 * propeller(variant, u, v, r, n)[1]
    F_N = rudder(variant, u, v, r, delta, n)[2]
    X -= (1 - 0.387) * F_N * math.sin(delta)
    Y -= (1 + 0.312) * F_N * math.cos(delta)
    N -= (-0.5 + 0.312 * -0.464) * L * F_N * math.cos(delta)
    m_x, m_y = np.array([0.022, 0.223]) * rho / 2 * L**2 * d
    J_z, I_zG = 0.011 * rho / 2 * L**4 * d, m * (0.25 * L) ** 2
    M = [[m + m_x, 0, 0], [0, m + m_y, x_G * m], [0, x_G * m, I_zG + x_G**2 * m + J_z]]
    right = [X + (m + m_y) * v * r + x_G * m * r**2, Y - (m + m_x) * u * r, N - x_G * m * u * r]
    return np.linalg.solve(M, right)


@pytest.mark.parametrize("variant", DIMENSIONS)
@settings(max_examples=60, deadline=None)
@given(
    share=st.floats(0.3, 1.0),
    drift=st.floats(-0.7, 0.7),
    turn=st.floats(-1.2, 1.2),
    delta=st.floats(-0.61, 0.61),
    order=st.floats(0.6, 1.0),
)
def test_accelerations_are_those_of_the_method(variant, share, drift, turn, delta, order):
    L, n = DIMENSIONS[variant][0], DIMENSIONS[variant][-1]
    vessel = ship(variant, rudder=-delta, propeller_order=order)
    U = share * vessel.nu_start[0]
    u, v, r = U * math.cos(drift), -U * math.sin(drift), turn * U / L
    found = vessel.derivatives(np.array([0, 0, 0, u, v, r]))[3:]
    expected = accelerations(variant, u, v, r, delta, order * n)
    scale = U**2 / L * np.array([1, 1, 1 / L])
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-12)


@pytest.mark.parametrize("variant", DIMENSIONS)
def test_outputs_are_those_of_the_method(variant):
    L, *_, D, _H_R, _A_R, rho, _w, n = DIMENSIONS[variant]
    u = ship(variant).nu_start[0]
    nu = (0.6 * u, -0.15 * u, 0.3 * u / L)
    vessel = ship(variant, rudder=0.4, nu_start=nu)
    vessel.initialise()
    u_R, v_R, F_N = rudder(variant, *nu, -0.4, n)
    J, K_T, _advance = propeller(variant, *nu, n)
    torque = rho * n**2 * D**5 * (0.03098 - 0.01566 * J - 0.01930 * J**2)
    expected = {
        "rudder_inflow": [u_R, v_R],
        "rudder_force": F_N,
        "propeller_rate": math.tau * n,
        "propeller_thrust": rho * n**2 * D**4 * K_T,
        "propeller_torque": torque,
        "propeller_power": math.tau * n * torque,
    }
    for name, value in expected.items():
        assert vessel.get(name) == pytest.approx(value, rel=1e-11), name


def test_the_moment_of_the_shaft_is_that_of_a_like_propeller_of_the_wageningen_series():
    J = np.linspace(0.0, 0.7, 71)
    K_T, K_Q = (sum(c * J**k for k, c in enumerate(x)) for x in wageningen_b(4.0, 0.721, 0.431))
    for name, series, apart in (("K_T", K_T, 0.023), ("K_Q", K_Q, 2e-4)):
        curve = np.polynomial.polynomial.polyval(J, ship().get(f"propeller_{name}"))
        assert np.abs(curve - series).max() < apart, name


# ---------------------------------------------------------------------- beyond the method


def test_a_positive_rudder_turns_to_port():
    vessel = ship(rudder=0.1)
    _u, sway, yaw = vessel.derivatives(np.array([0, 0, 0, 7.97, 0, 0]))[3:]
    assert sway > 0 > yaw


@pytest.mark.parametrize("nu", [(0, 0, 0), (0, 0, 1e-3), (0, -0.01, 1e-3), (-0.01, 0, -1e-3)])
def test_a_ship_without_way_is_slowed_down_in_every_axis(nu):
    vessel = ship(propeller_order=0.0, rudder_area=0.0)
    slope = vessel.derivatives(np.array([0, 0, 0, *nu], dtype=float))[3:]
    power = np.array(nu) @ vessel.mass_matrix() @ slope
    assert power < 0.0 if any(nu) else power == 0.0
    assert np.isfinite(vessel.linearise(np.array([0, 0, 0, *nu], dtype=float)).A).all()


def test_full_astern_stops_the_ship_and_drives_it_astern():
    run = ship(propeller_order=-1.0).reference(np.arange(0.0, 6001.0, 100.0), rtol=1e-8)
    u = run["nu.u"]
    assert (np.diff(u) < 1e-6).all()
    # Astern -R0' and the thrust at K_T(0) balance: rho/2 L d u^2 R0' = (1 - t) rho n^2 D^4 k0.
    n = 7.82 / math.tau
    thrust = 0.78 * n**2 * 9.86**4 * 0.2931
    assert u[-1] == pytest.approx(-math.sqrt(thrust / (0.5 * 320 * 20.8 * 0.022)), rel=1e-3)


def test_orders_beyond_full_are_full():
    ahead = np.array([0, 0, 0, 5.0, 0.3, 0.001])
    for order in (1.0, -1.0):
        full, more = (ship(propeller_order=k * order).derivatives(ahead) for k in (1, 3))
        np.testing.assert_array_equal(full, more)


def test_sections_have_the_volume_of_the_ship():
    vessel = ship()
    area = np.array(vessel.section_area)
    volume = np.trapezoid(area, dx=32.0)
    assert volume == pytest.approx(312600.0, rel=2e-3)
    assert np.trapezoid(area * np.linspace(-160, 160, 11), dx=32.0) / volume == pytest.approx(
        11.2, abs=1.0
    )


def test_a_propeller_larger_than_the_rudder_is_refused():
    vessel = ship(propeller_diameter=16.0)
    with pytest.raises(InputError, match=r"propeller_diameter is 16\.0 m; at most .*15\.8 m"):
        vessel.initialise()


def test_a_ship_without_mass_is_refused():
    vessel = ship(mass=0.0, added_mass=(0.0, 0.0))
    with pytest.raises(InputError, match=r"mass matrix is not positive definite.*added_mass"):
        vessel.initialise()
