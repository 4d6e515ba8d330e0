"""The physics of `MarineCraft` with every term of its matrices in use."""

import math

import casadi as ca
import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.kinematics import rotation
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.terms.hydrodynamics import coriolis_load

INERTIAL = {
    "mass": 12.0,
    "inertia": (1.1, 2.3, 2.9, 0.11, -0.2, 0.07),
    "center_of_gravity": (0.05, -0.03, 0.08),
    "added_mass": (3.0, 9.0, 14.0, 0.4, -0.3, 0.6),
    "added_inertia": (0.5, 0.8, 1.2, -0.04, 0.02, 0.05),
    "added_coupling": (0.1, -0.2, 0.3, 0.25, 0.05, -0.4, 0.15, 0.7, -0.1),
}
NEUTRAL = {"restoring": "submerged", "buoyancy": 12.0 * 9.81}
"""Weight and buoyancy balance; with both centres in one place there is no moment either."""
STRAY = {
    "position_start": (1.0, -2.0, 0.5),
    "attitude_start": (0.4, -0.3, 1.0),
    "velocity_start": (0.6, -0.4, 0.3),
    "rates_start": (0.5, -0.7, 0.9),
}
DRAG = {
    "linear_damping_force": (3.0, 5.0, 7.0),
    "linear_damping_moment": (0.3, 0.5, 0.4),
    "quadratic_damping_force": (10.0, 30.0, 40.0),
    "quadratic_damping_moment": (1.0, 2.0, 1.5),
}


def craft(**values):
    component = MarineCraft("craft")
    for name, value in values.items():
        component.set(name, value)
    return component


def free(**values):
    """Return a craft without damping that nothing pulls anywhere."""
    centre = INERTIAL["center_of_gravity"]
    return craft(**{**INERTIAL, **NEUTRAL, "center_of_buoyancy": centre, **STRAY, **values})


def at_start(component):
    component.initialise()
    return np.array([v for p in component.state_ports for v in getattr(component, p.name)])


def test_rigid_mass_matrix_is_that_of_points():
    # Kinetic energy of mass points moving with the body is nu^T M nu / 2.
    rng = np.random.default_rng(7)
    masses, places = rng.uniform(1, 3, 6), rng.normal(size=(6, 3))
    total, centre = masses.sum(), masses @ places / masses.sum()
    r = places - centre
    second = np.einsum("i,ij,ik->jk", masses, r, r)  # integrals of x x dm, x y dm, ...
    xx, yy, zz = np.trace(second) - np.diag(second)
    products = (second[0, 1], second[0, 2], second[1, 2])
    component = craft(mass=total, center_of_gravity=centre, inertia=(xx, yy, zz, *products))
    nu = rng.normal(size=6)
    speeds = nu[:3] + np.cross(nu[3:], places)
    energy = 0.5 * masses @ np.sum(speeds**2, axis=1)
    assert 0.5 * nu @ component.mass_matrix() @ nu == pytest.approx(energy, rel=1e-14)


def test_added_mass_stands_in_the_matrix_as_given():
    added = {name: INERTIAL[name] for name in ("added_mass", "added_inertia", "added_coupling")}
    M = craft(**added).mass_matrix() - craft().mass_matrix()
    np.testing.assert_allclose(M, M.T, rtol=0, atol=0)
    A, J = M[:3, :3], M[3:, 3:]
    upper = np.triu_indices(3, 1)
    assert [*np.diag(A), *A[upper]] == pytest.approx(INERTIAL["added_mass"], rel=1e-15)
    assert [*np.diag(J), *J[upper]] == pytest.approx(INERTIAL["added_inertia"], rel=1e-14)
    assert M[:3, 3:].ravel() == pytest.approx(INERTIAL["added_coupling"], rel=1e-15)


@pytest.mark.parametrize("wrong", [{"added_mass": (-20, 0, 0, 0, 0, 0)}, {"mass": 0.0}])
def test_a_mass_matrix_that_is_not_positive_definite_is_refused(wrong):
    with pytest.raises(InputError, match="positive definite"):
        craft(**wrong).initialise()


def test_longer_sub_steps_are_refused():
    with pytest.raises(InputError, match="max_step"):
        craft(max_step=0.02).initialise()


def test_coriolis_matrix_is_skew_symmetric():
    rng = np.random.default_rng(3)
    for _ in range(200):
        h, nu = rng.normal(size=6), rng.normal(size=6)
        columns = [np.array(coriolis_load(ca.DM(h), ca.DM(axis))).ravel() for axis in np.eye(6)]
        C = np.array(columns).T
        np.testing.assert_array_equal(C + C.T, 0.0)
        np.testing.assert_allclose(
            np.array(coriolis_load(ca.DM(h), ca.DM(nu))).ravel(), C @ nu, atol=1e-14
        )


@pytest.mark.parametrize("form", ["full", "diagonal"])
def test_coriolis_forces_do_no_work(form):
    component = free(coriolis=form)
    M = component.mass_matrix()
    rng = np.random.default_rng(4)
    for _ in range(200):
        x = np.concatenate([STRAY["position_start"], STRAY["attitude_start"], rng.normal(size=6)])
        nu, nu_dot = x[6:], component.derivatives(x)[6:]
        assert abs(nu @ M @ nu_dot) < 1e-12


def momenta(component, x):
    """Return linear and angular momentum about the inertial origin, in {n}."""
    R, p, h = np.array(rotation(*x[3:6])), x[:3], component.mass_matrix() @ x[6:]
    return np.concatenate([R @ h[:3], R @ h[3:] + np.cross(p, R @ h[:3])])


@pytest.mark.parametrize(("form", "conserves"), [("full", True), ("diagonal", False)])
def test_momentum_is_conserved_by_the_full_form_only(form, conserves):
    component = free(coriolis=form)
    run = component.reference(np.linspace(0, 10, 11), rtol=1e-12, atol=1e-13)
    over_time = np.array([momenta(component, x) for x in run.x])
    drift = np.abs(over_time - over_time[0]).max() / np.linalg.norm(over_time[0])
    assert drift < 1e-11 if conserves else drift > 1e-2


def test_motion_does_not_depend_on_where_the_body_origin_is():
    d = np.array([0.3, -0.2, 0.15])  # old origin seen from the new one
    S = np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])
    H = np.block([[np.eye(3), -S], [np.zeros((3, 3)), np.eye(3)]])  # nu_old = H nu_new
    old = free()
    rigid = free(added_mass=0.0, added_inertia=0.0, added_coupling=0.0).mass_matrix()
    added = H.T @ (old.mass_matrix() - rigid) @ H
    A, B, J = added[:3, :3], added[:3, 3:], added[3:, 3:]
    upper = np.triu_indices(3, 1)
    R = np.array(rotation(*STRAY["attitude_start"]))
    centre = np.add(INERTIAL["center_of_gravity"], d)
    new = free(
        added_mass=[*np.diag(A), *A[upper]],
        added_inertia=[*np.diag(J), *J[upper]],
        added_coupling=B.ravel(),
        center_of_gravity=centre,
        center_of_buoyancy=centre,
        position_start=STRAY["position_start"] - R @ d,
        velocity_start=STRAY["velocity_start"] - np.cross(STRAY["rates_start"], d),
    )
    np.testing.assert_allclose(new.mass_matrix(), H.T @ old.mass_matrix() @ H, atol=1e-13)
    force, lever = np.array([2.0, -1.0, 0.5]), np.array([0.1, 0.4, -0.2])
    t = np.linspace(0, 5, 6)
    push = {"force_2": force, "moment_2": np.cross(lever, force)}
    a = old.reference(t, lambda t, x: push)
    push_new = {"force_2": force, "moment_2": np.cross(lever + d, force)}
    b = new.reference(t, lambda t, x: push_new)
    for x, y in zip(a.x, b.x, strict=True):
        np.testing.assert_allclose(y[3:6], x[3:6], atol=1e-9)
        np.testing.assert_allclose(y[:3] + np.array(rotation(*y[3:6])) @ d, x[:3], atol=1e-9)


def test_motion_in_a_current_is_motion_in_still_water_carried_along():
    water = np.array([0.7, -0.5, 0.2])
    R = np.array(rotation(*STRAY["attitude_start"]))
    t = np.linspace(0, 10, 11)
    still = free(**DRAG).reference(t)
    carried = free(**DRAG, velocity_start=STRAY["velocity_start"] + R.T @ water)
    carried = carried.reference(t, lambda t, x: {"current": water})
    for k, time in enumerate(t):
        a, b = still.x[k], carried.x[k]
        np.testing.assert_allclose(b[:3], a[:3] + water * time, atol=1e-9)
        np.testing.assert_allclose(b[3:6], a[3:6], atol=1e-9)
        np.testing.assert_allclose(b[9:], a[9:], atol=1e-9)
        R = np.array(rotation(*a[3:6]))
        np.testing.assert_allclose(b[6:9], a[6:9] + R.T @ water, atol=1e-9)


def test_a_craft_at_rest_in_the_water_stays_so():
    water, R = np.array([0.7, -0.5, 0.2]), np.array(rotation(*STRAY["attitude_start"]))
    component = free(**DRAG, velocity_start=R.T @ water, rates_start=0.0)
    component.set("current", water)
    slope = component.derivatives(at_start(component))
    np.testing.assert_allclose(slope[:3], water, atol=1e-15)
    np.testing.assert_allclose(slope[3:], 0.0, atol=1e-14)


def test_acceleration_of_a_dry_body_is_force_over_mass():
    component = craft(mass=4.0, buoyancy=4 * 9.81, restoring="submerged", **STRAY)
    for name in ("force_2", "force_1", "force_3"):
        component.set(name, (2.0, -4.0, 6.0))
    component.initialise()
    assert component.get("acceleration") == pytest.approx((1.5, -3.0, 4.5), abs=1e-14)


def test_acceleration_is_the_second_derivative_of_position():
    component = free(**DRAG)
    component.set("current", (0.5, 0.3, 0.0))
    component.set("force_1", (5.0, 0.0, 0.0))
    component.set("moment_3", (0.0, 0.4, 0.0))
    R = np.array(rotation(*STRAY["attitude_start"]))
    h, x = 1e-5, at_start(component)
    slope = component.derivatives(x)
    speed = [
        np.array(rotation(*(x + s * slope)[3:6])) @ (x + s * slope)[6:9] for s in (-h, h)
    ]  # of the body origin, in {n}, a little earlier and later
    expected = R.T @ (speed[1] - speed[0]) / (2 * h)
    np.testing.assert_allclose(component.get("acceleration"), expected, atol=1e-9)


def test_all_inputs_act_on_the_acceleration_at_once():
    component = free(**DRAG)
    found = component.linearise(at_start(component))
    accelerated = [name.startswith("acceleration.") for name in found.y_names]
    D = found.D[accelerated]
    assert D.shape == (3, 4 * 6 + 3 + 3)
    assert (np.abs(D).max(axis=0) > 1e-6).all()


def test_an_attachment_pulls_as_its_force_and_moment_do():
    place, pull = np.array([-0.7, 0.2, -0.1]), np.array([3.0, -2.0, 5.0])
    towed, pushed = free(**DRAG, attachment_place=place), free(**DRAG)
    force = np.array(rotation(*STRAY["attitude_start"])).T @ pull
    towed.set("attachment_force", pull)
    pushed.set("force_2", force)
    pushed.set("moment_4", np.cross(place, force))
    x = at_start(towed)
    np.testing.assert_allclose(towed.derivatives(x), pushed.derivatives(x), rtol=1e-12)


def test_the_velocity_of_the_attachment_is_that_of_its_place():
    component, h = free(**DRAG, attachment_place=(-0.7, 0.2, -0.1)), 1e-4
    x = component.reference([0.0, h, 2 * h]).x
    places = []
    for state in x:
        names = ("position", "attitude", "velocity", "rates")
        for name, part in zip(names, np.split(state, 4), strict=True):
            component.set(f"{name}_start", part)
        component.initialise()
        places.append((component.get("attachment_point"), component.get("attachment_velocity")))
    slope = np.subtract(places[2][0], places[0][0]) / (2 * h)
    np.testing.assert_allclose(places[1][1], slope, atol=1e-6)
    arm = np.array(rotation(*x[0, 3:6])) @ (-0.7, 0.2, -0.1)
    np.testing.assert_allclose(places[0][0], x[0, :3] + arm, atol=1e-14)


def test_forces_of_all_kinds_add_up():
    component = free(**DRAG)
    x = at_start(component)
    for a in ("force", "moment"):
        for term, share in [(1, 1.0), (2, -3.0), (4, 4.0)]:
            component.set(f"{a}_{term}", np.array([0.2, -0.3, 0.4]) * share)
    slope = component.derivatives(x)
    for a in ("force", "moment"):
        for term in (1, 2, 4):
            component.set(f"{a}_{term}", 0.0)
        component.set(f"{a}_3", np.array([0.4, -0.6, 0.8]))
    np.testing.assert_allclose(component.derivatives(x), slope, atol=1e-13)


def test_submerged_craft_conserves_energy():
    heavy = {"buoyancy": 110.0, "center_of_buoyancy": (0.02, 0.01, -0.1)}
    component = free(**heavy)
    M, W = component.mass_matrix(), 12.0 * 9.81

    def energy(x):
        down = np.array(rotation(*x[3:6]))[2]
        depth_of_weight = x[2] + down @ component.center_of_gravity
        depth_of_buoyancy = x[2] + down @ component.center_of_buoyancy
        return 0.5 * x[6:] @ M @ x[6:] - W * depth_of_weight + 110.0 * depth_of_buoyancy

    run = component.reference(np.linspace(0, 5, 6), rtol=1e-12, atol=1e-13)
    energies = np.array([energy(x) for x in run.x])
    kinetic = 0.5 * run.x[0, 6:] @ M @ run.x[0, 6:]
    assert np.abs(energies - energies[0]).max() < 1e-9 * kinetic


def test_submerged_craft_rights_itself_and_a_heavy_one_sinks():
    component = craft(restoring="submerged", center_of_buoyancy=(0, 0, -0.1), buoyancy=9.0)
    component.set("attitude_start", (0.2, 0.0, 0.0))
    slope = component.derivatives(at_start(component))
    down = (9.81 - 9.0) / 1.0
    assert slope[6:9] == pytest.approx((0, down * math.sin(0.2), down * math.cos(0.2)))
    assert slope[9] == pytest.approx(-9.0 * 0.1 * math.sin(0.2))


def test_terminal_speed_balances_linear_and_quadratic_damping():
    component = craft(
        restoring="submerged",
        buoyancy=0.0,
        linear_damping_force=(0.0, 0.0, 2.0),
        quadratic_damping_force=(0.0, 0.0, 5.0),
    )
    final = component.reference([0.0, 20.0])["velocity.w"][-1]
    assert 2.0 * final + 5.0 * final**2 == pytest.approx(9.81, rel=1e-9)


@pytest.mark.parametrize(("axis", "sign"), [("u", 1), ("v", -1), ("w", 1)])
def test_damping_opposes_motion_through_the_water(axis, sign):
    component = free(**DRAG, attitude_start=0.0, rates_start=0.0)
    component.set("velocity_start", [sign * (axis == a) for a in "uvw"])
    x = at_start(component)
    power = x[6:] @ component.mass_matrix() @ component.derivatives(x)[6:]
    place = "uvw".index(axis)
    assert power == pytest.approx(
        -DRAG["linear_damping_force"][place] - DRAG["quadratic_damping_force"][place], rel=1e-12
    )


def test_fixed_steps_follow_the_reference():
    component = free(**DRAG)
    component.set("force_1", (3.0, 0.0, 0.0))
    expected = component.reference([0.0, 2.0]).x[-1]
    component.initialise()
    component.begin()
    for k in range(20):
        component.advance(0.1 * k, 0.1)
    reached = [v for p in component.state_ports for v in component.get(p.name)]
    np.testing.assert_allclose(reached, expected, atol=1e-8)
