"""The ROV against the equations of [Paulino2015] written anew, and conservation laws."""

import math

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.errors import InputError
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.symbolic import euler_rate_matrix, rotation_matrix

from .rov_runs import ran

GRAVITY = 9.81
# Everything of the equations in use: CG off the origin, full added mass, drag, buoyancy.
GENERAL = {
    "mass": 12.0,
    "inertia": (1.1, 2.3, 2.9, 0.11, -0.2, 0.07),
    "center_of_gravity": (0.05, -0.03, 0.08),
    "added_mass": (3.0, 9.0, 14.0, 0.4, -0.3, 0.6),
    "added_inertia": (0.5, 0.8, 1.2, -0.04, 0.02, 0.05),
    "added_coupling": (0.1, -0.2, 0.3, 0.25, 0.05, -0.4, 0.15, 0.7, -0.1),
    "linear_damping_force": (3.0, 5.0, 7.0),
    "linear_damping_moment": (0.3, 0.5, 0.4),
    "quadratic_damping_force": (10.0, 30.0, 40.0),
    "quadratic_damping_moment": (1.0, 2.0, 1.5),
    "volume": 0.0121,
    "density": 1000.0,
    "center_of_buoyancy": (0.02, 0.01, -0.06),
    "attachment_place": (-0.15, 0.04, -0.05),
}
DAMPING = [name for name in GENERAL if "damping" in name]
# No force at all: no drag, weight and buoyancy equal and in one place.
FREE = {
    **dict.fromkeys(DAMPING, 0.0),
    "volume": 0.012,
    "center_of_buoyancy": GENERAL["center_of_gravity"],
}
ETA = np.array([1.0, -2.0, 5.0, 0.4, -0.3, 1.0])
NU = np.array([0.6, -0.4, 0.3, 0.5, -0.7, 0.9])


def craft(**values):
    component = Rov("vehicle")
    for name, value in {**GENERAL, "eta_start": ETA, "nu_start": NU, **values}.items():
        component.set(name, value)
    return component


def close(found, expected, atol):
    np.testing.assert_allclose(found, expected, rtol=0, atol=atol)


def J1(eta):
    return Rotation.from_euler("ZYX", [eta[5], eta[4], eta[3]]).as_matrix()


def S(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


# ---------------------------------------------------------------------- kinematics


def test_rotation_and_rates_are_those_of_the_source():
    rng = np.random.default_rng(1)
    for phi, theta, psi in rng.uniform((-3, -1.2, -3), (3, 1.2, 3), (200, 3)):
        (sp, cp), (st, ct), (sy, cy) = ((math.sin(a), math.cos(a)) for a in (phi, theta, psi))
        C_x = np.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]])
        C_y = np.array([[ct, 0, -st], [0, 1, 0], [st, 0, ct]])  # 3.8 with the sign corrected
        C_z = np.array([[cy, sy, 0], [-sy, cy, 0], [0, 0, 1]])
        R = np.array(rotation_matrix(ca.DM([phi, theta, psi])))
        close(R, (C_x @ C_y @ C_z).T, atol=1e-15)
        # 1e-15 is the rounding of one product; nine of them add up.
        close(R.T @ R, np.eye(3), atol=2e-15)
        assert np.linalg.det(R) == pytest.approx(1.0, abs=2e-15)
        # 3.11 with C_x(phi): angular velocity from the rates of the angles.
        inverse = np.column_stack([[1, 0, 0], C_x @ [0, 1, 0], C_x @ C_y @ [0, 0, 1]])
        J2 = np.array(euler_rate_matrix(ca.DM([phi, theta, psi])))
        scale = 1.0 + abs(math.tan(theta))
        close(J2 @ inverse, np.eye(3), atol=1e-15 * scale)


def test_the_rotation_turns_with_the_angular_velocity():
    h, component = 1e-5, craft()
    slope = component.derivatives(np.concatenate([ETA, NU]))
    difference = (J1(ETA + h * slope[:6]) - J1(ETA - h * slope[:6])) / (2 * h)
    close(difference, J1(ETA) @ S(NU[3:]), atol=1e-9)
    close(slope[:3], J1(ETA) @ NU[:3], atol=1e-15)


# ---------------------------------------------------------------------- dynamics


def source_accelerations(eta, nu, loads, water, water_rate):
    """Return nu' from eqs 3.15 to 3.45, written as vectors and matrices of their own."""
    m, r_G, r_B = GENERAL["mass"], *(GENERAL[f"center_of_{a}"] for a in ("gravity", "buoyancy"))
    r_T = GENERAL["attachment_place"]
    xx, yy, zz, xy, xz, yz = GENERAL["inertia"]
    I_G = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
    I_0 = I_G + m * (np.dot(r_G, r_G) * np.eye(3) - np.outer(r_G, r_G))
    M_CR = np.block([[m * np.eye(3), -m * S(r_G)], [m * S(r_G), I_0]])
    A, J = (
        np.array([[a, d, e], [d, b, f], [e, f, c]])
        for a, b, c, d, e, f in (GENERAL["added_mass"], GENERAL["added_inertia"])
    )
    B = np.reshape(GENERAL["added_coupling"], (3, 3))
    M_A = np.block([[A, B], [B.T, J]])
    R = J1(eta)
    nu_c = np.concatenate([R.T @ water, np.zeros(3)])
    nu_r = nu - nu_c
    v, w = nu_r[:3], nu_r[3:]
    # 3.16 and 3.17 for the rigid body, the general form of C for the added mass.
    rigid = np.concatenate(
        [
            m * (np.cross(w, v) + np.cross(w, np.cross(w, r_G))),
            np.cross(w, I_0 @ w) + m * np.cross(r_G, np.cross(w, v)),
        ]
    )
    a, b = np.split(M_A @ nu_r, 2)
    added = np.concatenate([-S(a) @ w, -S(a) @ v - S(b) @ w])
    D1 = np.concatenate([GENERAL["linear_damping_force"], GENERAL["linear_damping_moment"]])
    D2 = np.concatenate([GENERAL["quadratic_damping_force"], GENERAL["quadratic_damping_moment"]])
    W, buoyancy = m * GRAVITY, GENERAL["density"] * GRAVITY * GENERAL["volume"]
    f = R.T @ [0, 0, 1]
    G = -np.concatenate([(W - buoyancy) * f, np.cross(r_G, W * f) - np.cross(r_B, buoyancy * f)])
    pull = R.T @ loads["attachment_force"]
    tau = np.concatenate([loads["force_1"] + pull, loads["moment_1"] + np.cross(r_T, pull)])
    resistance = rigid + added + D1 * nu_r + D2 * np.abs(nu_r) * nu_r + G
    nu_r_dot = np.linalg.solve(M_CR + M_A, tau - resistance)
    turning = -np.cross(nu[3:], R.T @ water) + R.T @ water_rate
    return nu_r_dot + np.concatenate([turning, np.zeros(3)])


def test_accelerations_are_those_of_the_source():
    rng, component = np.random.default_rng(2), craft()
    for _ in range(100):
        eta = rng.uniform((-5, -5, 0, -3, -1.2, -9), (5, 5, 9, 3, 1.2, 9))
        nu, water, water_rate = rng.normal(size=6), rng.normal(size=3), rng.normal(size=3)
        loads = {
            name: rng.normal(scale=20.0, size=3)
            for name in ("force_1", "moment_1", "attachment_force")
        }
        inputs = {**loads, "current": water, "current_acceleration": water_rate}
        for name, value in inputs.items():
            component.set(name, value)
        expected = source_accelerations(eta, nu, loads, water, water_rate)
        found = component.derivatives(np.concatenate([eta, nu]))[6:]
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-11)


def test_coriolis_forces_do_no_work():
    component = craft(**FREE)
    M, rng = component.mass_matrix(), np.random.default_rng(3)
    for _ in range(100):
        nu = rng.normal(size=6)
        power = nu @ M @ component.derivatives(np.concatenate([ETA, nu]))[6:]
        assert abs(power) < 1e-14 * (nu @ M @ nu) * np.linalg.norm(nu)


def test_a_mass_matrix_that_is_not_positive_definite_is_refused():
    with pytest.raises(InputError, match="positive definite"):
        craft(added_mass=(-20.0, 0, 0, 0, 0, 0)).initialise()


def energy(component, x):
    return 0.5 * x[6:] @ component.mass_matrix() @ x[6:]


def impulses(component, x, water=(0.0, 0.0, 0.0)):
    """Return Kirchhoff's impulses in {n}, about the origin that the water carries along."""
    R, nu_r = J1(x[:6]), x[6:] - np.concatenate([J1(x[:6]).T @ water, np.zeros(3)])
    linear, angular = np.split(component.mass_matrix() @ nu_r, 2)
    P = R @ linear
    return np.concatenate([P, np.cross(x[:3], P) + R @ angular])


def test_free_motion_keeps_energy_and_impulses():
    component = craft(**FREE)
    x = ran(component, 2.0, 400)
    start, first = energy(component, x[0]), impulses(component, x[0])
    assert max(abs(energy(component, row) - start) for row in x) < 1e-10 * start
    drift = [np.abs(impulses(component, row) - first).max() for row in x]
    assert max(drift) < 1e-9 * np.abs(first).max()


def test_runge_kutta_has_its_order_in_free_motion():
    exact = craft(**FREE).reference([0.0, 2.0], rtol=1e-13, atol=1e-14).x[-1]
    errors, energies = [], []
    for count in (50, 100, 200, 400):
        component = craft(**FREE)
        x = ran(component, 2.0, count)[-1]
        errors.append(np.abs(x - exact).max())
        energies.append(
            abs(energy(component, x) / energy(component, np.concatenate([ETA, NU])) - 1)
        )
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert ((orders > 3.9) & (orders < 4.1)).all(), orders
    assert (np.divide(energies[:-1], energies[1:]) > 16).all(), energies


WATER = np.array([0.7, -0.5, 0.2])
ACCURATE = {"rtol": 2.3e-14, "atol": 1e-15}


def test_motion_in_a_current_is_motion_in_still_water_carried_along():
    t = np.linspace(0, 5, 11)
    still = craft().reference(t, **ACCURATE)
    start = NU + np.concatenate([J1(ETA).T @ WATER, np.zeros(3)])
    carried = craft(nu_start=start).reference(t, lambda t, x: {"current": WATER}, **ACCURATE)
    for time, a, b in zip(t, still.x, carried.x, strict=True):
        shift = np.concatenate([WATER * time, np.zeros(3), J1(a[:6]).T @ WATER, np.zeros(3)])
        close(b, a + shift, atol=5e-11)


def test_a_current_that_changes_carries_the_vehicle_with_its_acceleration():
    t = np.linspace(0, 5, 11)

    def water(time):
        return np.array([0.5 * math.sin(time), 0.3 * time, -0.1 * time**2])

    def inputs(time, x):
        slope = [0.5 * math.cos(time), 0.3, -0.2 * time]
        return {"current": water(time), "current_acceleration": slope}

    still = craft().reference(t, **ACCURATE)
    moved = craft().reference(t, inputs, **ACCURATE)
    for time, a, b in zip(t, still.x, moved.x, strict=True):
        shift = [0.5 * (1 - math.cos(time)), 0.15 * time**2, -(time**3) / 30]
        close(b[:3], a[:3] + shift, atol=1e-9)
        close(b[3:6], a[3:6], atol=1e-9)


def test_impulses_of_the_relative_motion_are_kept_in_a_current():
    component = craft(**FREE)
    t = np.linspace(0, 5, 11)
    run = component.reference(t, lambda t, x: {"current": WATER}, **ACCURATE)
    rows = []
    for time, x in zip(t, run.x, strict=True):
        carried = np.concatenate([x[:3] - WATER * time, x[3:]])
        rows.append(impulses(component, carried, WATER))
    assert np.abs(np.array(rows) - rows[0]).max() < 1e-11 * np.abs(rows[0]).max()


# ---------------------------------------------------------------------- the tether


def test_a_tether_pulls_where_it_is_attached():
    # The work of the force is that of its point: f . v_point = tau . nu.
    component = craft()
    rng = np.random.default_rng(5)
    base = component.derivatives(np.concatenate([ETA, NU]))[6:]
    component.initialise()
    for _ in range(20):
        force = rng.normal(scale=10.0, size=3)
        component.set("attachment_force", force)
        change = component.derivatives(np.concatenate([ETA, NU]))[6:] - base
        tau = component.mass_matrix() @ change
        close(J1(ETA) @ tau[:3], force, atol=1e-12)
        power = np.dot(force, component.get("attachment_velocity"))
        assert tau @ NU == pytest.approx(power, abs=1e-12)


def test_the_velocity_of_the_attachment_is_its_derivative():
    h = 1e-4
    x = craft().reference([0.0, h, 2 * h]).x
    places = []
    for row in x[::2]:
        component = craft(eta_start=row[:6], nu_start=row[6:])
        component.initialise()
        places.append(np.array(component.get("attachment_point")))
    component = craft(eta_start=x[1, :6], nu_start=x[1, 6:])
    component.initialise()
    velocity = (places[1] - places[0]) / (2 * h)
    close(component.get("attachment_velocity"), velocity, atol=1e-7)
    arm = J1(x[1]).T @ (np.array(component.get("attachment_point")) - x[1, :3])
    close(arm, GENERAL["attachment_place"], atol=1e-15)


# ---------------------------------------------------------------------- outputs


@pytest.mark.parametrize("turns", [-3, 0, 2])
@pytest.mark.parametrize("angle", [-3.1, -1e-9, 0.0, 2.0, math.pi])
def test_roll_and_yaw_are_wrapped(turns, angle):
    start = (0, 0, 0, angle + turns * math.tau, 0.4, angle - turns * math.tau)
    component = craft(eta_start=start)
    component.initialise()
    phi, theta, psi = component.get("attitude")
    assert theta == 0.4
    for wrapped in (phi, psi):
        assert -math.pi < wrapped <= math.pi
        assert math.cos(wrapped - angle) == pytest.approx(1.0, abs=1e-14)


def test_acceleration_is_the_second_derivative_of_position():
    component = craft()
    inputs = {"current": WATER, "force_1": (5.0, 0.0, 2.0), "attachment_force": (1, 2, -3)}
    for name, value in inputs.items():
        component.set(name, value)
    component.initialise()
    x, h = np.concatenate([ETA, NU]), 1e-5
    slope = component.derivatives(x)
    before, after = (J1((x + s * slope)[:6]) @ (x + s * slope)[6:9] for s in (-h, h))
    expected = J1(ETA).T @ (after - before) / (2 * h)
    close(component.get("acceleration"), expected, atol=1e-8)


def test_motion_outputs_are_the_states():
    component = craft()
    component.initialise()
    assert component.get("position") + component.get("attitude") == ETA.tolist()
    assert component.get("velocity") + component.get("rates") == NU.tolist()
