"""The thruster ship against closed forms, conservation laws and independent computations.

Numbers come from the equations of [ShipScript] by independent calculation.
"""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seatrial.errors import InputError
from seatrial.system.parameters import load_vehicle
from seatrial_kits.ships.hulls.thruster_ship import ThrusterShip
from tests.craft.references import shipped

DATA = Path(__file__).parents[2] / "reference"
A1, A2, A6, c = 7.88e6, 1.364e7, 4.31e9, 7.9e6
d = A2 * A6 - c**2
FULL = (2.5e5, 2.5e5, 1e7)  # N, N, N.m: 100 %
NAMES = ("eta.x", "eta.y", "eta.psi", "nu.u", "nu.v", "nu.r")


def build(model="nonlinear", load=(0.0, 0.0, 0.0), **changes):
    craft = ThrusterShip("ship")
    entries = load_vehicle("thruster-ship").file.components["thruster-ship"]
    values = {name: entry.value for name, entry in entries.items()}
    force = {"force_1": load[:2], "moment_1": load[2]}
    for name, value in {**values, "model": model, **force, **changes}.items():
        craft.set(name, value)
    return craft


def solved(t, **options):
    return build(**options).reference(t, rtol=1e-13, atol=1e-15)


def end(stop, **options):
    return solved([0.0, stop], **options).x[-1]


def energy(x):
    u, v, r = x.T[3:]
    return 0.5 * (A1 * u**2 + A2 * v**2 + A6 * r**2) + c * v * r


# ---------------------------------------------------------------------- reference data


def rows():
    with (DATA / "ship_final_values.csv").open() as file:
        return list(csv.DictReader(file))


COLUMNS = ("x", "y", "psi", "u", "v", "r")
SCALE = {
    f"{model}_{column}": max(abs(float(row[f"{model}_{column}"])) for row in rows())
    for model in ("nl", "lin")
    for column in COLUMNS
}


@pytest.mark.parametrize(("short", "model"), [("nl", "nonlinear"), ("lin", "linear")])
@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row['case']}-{row['T_s']}")
def test_final_values(row, short, model):
    load = [float(row[name]) for name in ("Fx_N", "Fy_N", "Mz_Nm")]
    found = end(float(row["T_s"]), model=model, load=load)
    for value, column in zip(found, COLUMNS, strict=True):
        name = f"{short}_{column}"
        assert abs(value - float(row[name])) < 1e-9 * SCALE[name], name


CASES = {"Fx": (1, 0, 0), "Fy": (0, 1, 0), "Mz": (0, 0, 1)}


@pytest.mark.parametrize("percent", [1, 100])
@pytest.mark.parametrize("axis", CASES)
def test_trajectories(axis, percent):
    table = np.genfromtxt(DATA / f"ship_traj_{axis}{percent}.csv", delimiter=",", names=True)
    load = np.array(CASES[axis]) * FULL * percent / 100
    for short, model in (("nl", "nonlinear"), ("lin", "linear")):
        run = solved(table["t"], model=model, load=load)
        for name, column in zip(NAMES, COLUMNS, strict=True):
            expected = table[f"{short}_{column}"]
            # The reference's rows are interpolated between its steps, which costs up to 2e-13.
            bound = 1e-9 * np.abs(expected).max() + 2e-13
            assert np.abs(run[name] - expected).max() < bound, (model, name)


# ---------------------------------------------------------------------- closed forms


@pytest.mark.parametrize("model", ["nonlinear", "linear"])
def test_a_surge_force_alone_accelerates_evenly(model):
    x = end(10.0, model=model, load=(FULL[0], 0, 0))
    expected = [FULL[0] * 50 / A1, 0, 0, FULL[0] * 10 / A1, 0, 0]
    np.testing.assert_allclose(x, expected, rtol=1e-11, atol=1e-15)


def test_a_moment_alone_turns_the_ship_about_a_fixed_point():
    t = np.linspace(0, 100, 21)
    run = solved(t, load=(0, 0, FULL[2]))
    psi, arm = A2 / d * FULL[2] * t**2 / 2, c / A2
    assert arm == pytest.approx(0.579178886)
    r = A2 / d * FULL[2] * t
    exact = [arm * (1 - np.cos(psi)), -arm * np.sin(psi), psi, 0 * t, -arm * r, r]
    np.testing.assert_allclose(run.x.T, exact, rtol=1e-10, atol=1e-10)


def test_a_sway_force_alone_drifts_astern_as_series_say():
    B52, B62, Fy, t = A6 / d, -c / d, FULL[1], 10.0
    series = Fy**2 * t**4 * ((A2 * B52 * B62 + c * B62**2) / (12 * A1) - B52 * B62 / 8)
    assert end(t, load=(0, Fy, 0))[0] == pytest.approx(series, rel=4e-4)


@pytest.mark.parametrize("axis", CASES)
def test_less_force_for_longer_goes_the_same_way(axis):
    full = np.array(CASES[axis]) * FULL
    quick, slow = end(10.0, load=full), end(100.0, load=full / 100)
    scaled = np.concatenate([slow[:3], 10 * slow[3:]])
    np.testing.assert_allclose(scaled, quick, rtol=1e-10, atol=1e-15)


@pytest.mark.parametrize(
    ("axis", "which", "power", "measured"),
    [
        ("Fy", 0, 2, 1.0003e-4),
        ("Mz", 0, 2, 1.0011e-4),
        ("Fy", 1, 3, 1e-6),
        ("Mz", 1, 3, 1e-6),
        ("Fy", 2, 3, 1e-6),
    ],
)
def test_error_of_the_linear_model_falls_with_the_force(axis, which, power, measured):
    load = np.array(CASES[axis]) * FULL
    errors = [
        end(10.0, load=share * load)[which] - end(10.0, model="linear", load=share * load)[which]
        for share in (1.0, 0.01)
    ]
    # The cube of 1 % leaves 1e-13 of the motion, near what doubles carry.
    assert errors[1] / errors[0] == pytest.approx(measured, rel=1e-4 if power == 2 else 5e-3)


def test_linear_motions_add_up():
    parts = [end(100.0, model="linear", load=np.array(n) * FULL) for n in CASES.values()]
    whole = end(100.0, model="linear", load=FULL)
    np.testing.assert_allclose(np.sum(parts, axis=0), whole, rtol=1e-11)


# ---------------------------------------------------------------------- linear model


def columns(linear, term):
    """Return the columns of X, Y and N of one term of the loads."""
    names = (f"force_{term}.x", f"force_{term}.y", f"moment_{term}")
    return [linear.u_names.index(name) for name in names]


def test_linear_model_is_that_of_the_source():
    for model in ("nonlinear", "linear"):
        linear = build(model).linearise(np.zeros(6))
        A = np.zeros((6, 6))
        A[[0, 1, 2], [3, 4, 5]] = 1
        np.testing.assert_array_equal(linear.A, A)
        B = np.zeros((6, 3))
        B[3, 0], B[4, 1], B[5, 2] = 1.2690355329949e-07, 7.3391695908404e-08, 2.3226513507903e-10
        B[4, 2] = B[5, 1] = -1.3452306210590e-10
        for term in (1, 2, 3, 4):
            np.testing.assert_allclose(linear.B[:, columns(linear, term)], B, rtol=1e-13)


def test_linear_model_is_the_nonlinear_one_linearised():
    linear = build().linearise(np.zeros(6))
    generator = np.random.default_rng(1)
    for _ in range(5):
        x, u = generator.uniform(-1, 1, 6), generator.uniform(-1, 1, len(linear.u_names))
        for term in (1, 2, 3, 4):
            u[columns(linear, term)] *= FULL
        expected = linear.A @ x + linear.B @ u
        np.testing.assert_allclose(build("linear").derivatives(x, u), expected, rtol=1e-12)


def test_six_integrators_that_the_thrusters_control():
    linear = build().linearise(np.zeros(6))
    np.testing.assert_array_equal(np.linalg.eigvals(linear.A), 0)
    B = linear.B[:, columns(linear, 1)] * FULL
    assert np.linalg.matrix_rank(np.hstack([B, linear.A @ B])) == 6


# ---------------------------------------------------------------------- conservation


def test_work_of_the_forces_is_the_kinetic_energy():
    # The power is integrated beside the motion, by the same solver.
    craft = build(load=FULL)

    def slope(_t, z):
        return [*craft.derivatives(z[:6]), np.dot(FULL, z[3:6])]

    z = solve_ivp(slope, (0, 100), np.zeros(7), method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    kinetic = energy(z[None, :6])[0]
    assert z[6] == pytest.approx(kinetic, rel=1e-12)
    assert kinetic > 1e6


FREE = {"eta_start": (0.0, 0.0, 0.3), "nu_start": (5.0, 1.0, 0.02)}


def test_free_motion_conserves_momentum_and_energy():
    run = solved(np.linspace(0, 200, 101), **FREE)
    expected = [695.0915505, 529.8930279, -0.8030548001, 0.6914210840, 2.953821345, 0.1391143014]
    np.testing.assert_allclose(run.x[-1], expected, rtol=1e-8)
    x, y, psi, u, v, r = run.x.T
    h_u, h_v = A1 * u, A2 * v + c * r
    north = h_u * np.cos(psi) - h_v * np.sin(psi)
    east = h_u * np.sin(psi) + h_v * np.cos(psi)
    about_origin = A6 * r + c * v + x * east - y * north
    momentum = np.hypot(north[0], east[0])
    for conserved, scale, bound in (
        (north, momentum, 5e-13),
        (east, momentum, 5e-13),
        (energy(run.x), energy(run.x[:1]), 1e-12),
        (about_origin, momentum * 700, 9e-12),
    ):
        assert np.abs(conserved - conserved[0]).max() < bound * scale


def test_a_centre_of_gravity_that_is_the_position_conserves_nothing():
    """The slip of the source: x_G in its terms (m x_G + m26) is the state x."""
    craft = build()

    def slope(_t, z):
        craft.set("center_of_gravity", z[0])
        return craft.derivatives(z)

    start = np.array([0, 0, 0.3, 5, 1, 0.02])
    run = solve_ivp(slope, (0, 5), start, method="DOP853", rtol=1e-12, atol=1e-12)
    assert run.status == 0
    change = energy(run.y.T)[-1] / energy(run.y.T[:1])[0] - 1
    assert abs(change) > 1e-3
    singular = (np.sqrt(A2 * A6) - c) / 7240e3
    assert singular == pytest.approx(32.398231)
    craft.set("center_of_gravity", singular + 1e-3)
    with pytest.raises(InputError, match="not positive definite"):
        craft.initialise()


# ---------------------------------------------------------------------- fixed steps, inputs


def test_runge_kutta_has_order_four():
    exact = end(100.0, load=FULL)[:2]
    errors = []
    for h in (4.0, 2.0, 1.0, 0.5):
        craft = build(load=FULL, max_step=h)
        craft.initialise()
        craft.begin()
        for k in range(round(100 / h)):
            craft.advance(k * h, h)
        errors.append(np.abs(np.array(craft.get("position")[:2]) - exact).max())
    np.testing.assert_allclose(errors, [0.358, 0.0200, 1.11e-3, 7.3e-5], rtol=0.01)
    np.testing.assert_allclose(
        np.log2(np.divide(errors[:-1], errors[1:])), [4.16, 4.17, 3.92], atol=0.02
    )


def test_mass_matrix():
    M = build().mass_matrix()
    np.testing.assert_array_equal(M, [[A1, 0, 0], [0, A2, c], [0, c, A6]])
    assert d == pytest.approx(5.872599e16)


def test_a_load_acts_as_the_thrusters_do():
    np.testing.assert_array_equal(
        end(20.0, load=FULL), end(20.0, force_2=FULL[:2], moment_2=FULL[2])
    )


def test_motion_is_published_as_sensors_expect_it():
    craft = build(load=FULL, **FREE)
    craft.initialise()
    assert craft.get("position") == [0.0, 0.0, 0.0]
    assert craft.get("attitude") == [0.0, 0.0, 0.3]
    assert craft.get("velocity") == [5.0, 1.0, 0.0]
    assert craft.get("rates") == [0.0, 0.0, 0.02]
    u_dot, v_dot, _ = craft.derivatives(np.array([0, 0, 0.3, 5, 1, 0.02]))[3:]
    expected = [u_dot - 0.02 * 1.0, v_dot + 0.02 * 5.0, 0.0]
    np.testing.assert_allclose(craft.get("acceleration"), expected, rtol=1e-14)


# ---------------------------------------------------------------------- drag

DRAG = (4191.4, 186550.0, 2984.8e6)
"""Of 80 m by 18 m by 6.5 m: N.s2/m2, N.s2/m2, N.m.s2/rad2."""


@pytest.mark.parametrize(
    ("axis", "mass", "load"), [(0, A1, (2.5e5, 0, 0)), (1, A2, (0, 2.5e5, 0)), (2, A6, (0, 0, 1e7))]
)
def test_under_one_force_an_axis_tends_to_its_speed_as_tanh(axis, mass, load):
    # u = u_inf tanh(t / T), T = M / (k u_inf). Y_rdot = 0 keeps the axes apart.
    k, F = DRAG[axis], load[axis]
    end_speed = math.sqrt(F / k)
    T = mass / (k * end_speed)
    t = np.linspace(0.0, 3 * T, 7)
    found = build(load=load, drag=DRAG, Y_rdot=0.0).reference(t, rtol=1e-10).x[:, 3 + axis]
    np.testing.assert_allclose(found, end_speed * np.tanh(t / T), rtol=1e-7, atol=1e-12)


def test_the_default_has_a_hulls_drag_and_the_published_ship_none():
    speeds = {}
    for variant in (None, "published"):
        vessel = shipped(
            "thruster-ship", "thruster-ship.thruster-ship", variant, force_1=(2.5e5, 0)
        )
        speeds[variant] = vessel.reference([0.0, 3600.0])["nu.u"][-1]
    assert speeds == {
        None: pytest.approx(7.72, abs=0.01),
        "published": pytest.approx(114.2, abs=0.1),
    }
    np.testing.assert_allclose(
        shipped("thruster-ship", "thruster-ship.thruster-ship").drag, DRAG, rtol=1e-4
    )


def test_the_drag_takes_power_whatever_the_motion():
    rng = np.random.default_rng(1)
    for nu in rng.normal(size=(20, 3)) * (5.0, 1.0, 0.05):
        x = np.array([0, 0, 0, *nu])
        change = [build(drag=drag).derivatives(x)[3:] for drag in (DRAG, (0.0, 0.0, 0.0))]
        M = build().mass_matrix()
        expected = -np.array(DRAG) * np.abs(nu) * nu
        np.testing.assert_allclose(M @ (change[0] - change[1]), expected, rtol=1e-9, atol=1e-6)
