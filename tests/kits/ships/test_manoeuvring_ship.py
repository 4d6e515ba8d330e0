"""The Mariner against closed forms and independent computations.

Numbers come from the equations of [Moro1979] and of Chislett and Stroem-Tejsen (1965) by
independent calculation.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.errors import InputError
from seatrial_kits.ships.hulls.manoeuvring_ship import ManoeuvringShip
from tests.kits.ships.mariner import (
    FEET,
    T_D,
    A,
    B,
    K,
    L,
    U,
    dimensionless,
    machine,
    rudder_effect,
    ship,
    slope_at,
)

DATA = Path(__file__).parents[2] / "reference"
TIME = L / U
KP, KD = K * FEET, K * FEET * T_D * TIME


def table(name):
    return np.genfromtxt(DATA / name, delimiter=",", names=True)


def pd(reference=0.0, kp=K, kd=K * T_D):
    """Return the source's law as an input of the ship, without rudder machine."""
    return lambda _t, x: {"rudder": kp * (x.eta[2] - reference) + kd * x.nu[2]}


def closed_loop():
    return np.array(
        [
            [A[0][0], A[0][1] + K * T_D * B[0], K * B[0]],
            [A[1][0], A[1][1] + K * T_D * B[1], K * B[1]],
            [0.0, 1.0, 0.0],
        ]
    )


# ---------------------------------------------------------------------- linear, dimensionless


@pytest.mark.parametrize(
    ("file", "start", "reference"),
    [("mariner_step_unit_ref.csv", 0.0, 1.0), ("mariner_initial_5deg.csv", np.radians(5), 0.0)],
)
def test_responses_of_the_source_s_loop(file, start, reference):
    expected = table(file)
    craft = dimensionless(eta_start=(0.0, 0.0, start))
    run = craft.reference(expected["t_nd"], pd(reference), rtol=1e-12)
    found = {"v_nd": run["nu.v"], "r_nd": run["nu.r"], "phi": run["eta.psi"]}
    found["delta"] = K * (found["phi"] - reference) + K * T_D * found["r_nd"]
    for name, values in found.items():
        # 9 significant digits: half a unit of the eighth decimal where a heading exceeds 1.
        assert np.abs(values - expected[name]).max() < 5.1e-9 * np.abs(values).max(), name


@pytest.mark.slow
def test_overshoot_rise_and_settling_of_a_step():
    t = np.arange(0.0, 20.0, 0.005)
    psi = dimensionless().reference(t, pd(1.0))["eta.psi"]
    assert psi.max() - 1 == pytest.approx(0.054319, abs=1e-6)
    assert t[psi.argmax()] == pytest.approx(5.818, abs=3e-3)
    rise = t[np.argmax(psi > 0.9)] - t[np.argmax(psi > 0.1)]
    assert rise == pytest.approx(2.762, abs=6e-3)
    assert t[np.flatnonzero(np.abs(psi - 1) > 0.02)[-1]] == pytest.approx(8.505, abs=6e-3)


@pytest.mark.parametrize(("K_scale", "B_scale"), [(FEET, 1 / FEET), (0.1, 10.0)])
def test_only_the_product_of_gain_and_rudder_effect_counts(K_scale, B_scale):
    craft = dimensionless(rudder_vector=np.array(B) * B_scale)
    start = np.array([0.0, 0.0, 0.1, 1.0, 0.2, -0.3])
    law = K * K_scale * (start[2] + T_D * start[5])
    found = slope_at(craft, start, law)[4:]
    np.testing.assert_allclose(found, closed_loop()[:2] @ [0.2, -0.3, 0.1], rtol=1e-14)


def test_steady_state_under_a_disturbance():
    d = np.array([0.01, 0.1])
    v, delta = -np.linalg.solve([[A[0][0], B[0]], [A[1][0], B[1]]], d)
    assert (v, delta) == pytest.approx((0.01821308, 0.000928127), abs=5e-9)
    craft = dimensionless(disturbance=d)
    run = craft.reference([0.0, 60.0], pd(), rtol=1e-12)
    assert run["nu.v"][-1] == pytest.approx(v, abs=1e-9)
    assert run["nu.r"][-1] == pytest.approx(0.0, abs=1e-9)
    assert run["eta.psi"][-1] == pytest.approx(delta / K, abs=1e-9)
    assert delta / K == pytest.approx(0.02729786, abs=5e-9)


@pytest.mark.parametrize(
    ("method", "order"), [("euler", (1.00, 1.02)), ("heun", (2.00, 2.01)), ("rk4", (4.01, 4.05))]
)
def test_orders_of_convergence(method, order):
    exact = expm(5.0 * closed_loop()) @ [0, 0, 0.1]
    errors = [np.abs(stepped(method, 5.0 / n, n) - exact).max() for n in (50, 100, 200, 400)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert order[0] - 0.005 < orders.min()
    assert orders.max() < order[1] + 0.005


def stepped(method, h, count):
    """Return (v, r, psi) after ``count`` steps of a textbook method on the plant's equations."""
    craft, law = dimensionless(), K * np.array([T_D, 1.0])

    def slope(z):
        state = np.array([0, 0, z[2], 1.0, z[0], z[1]])
        return slope_at(craft, state, law @ z[1:])[[4, 5, 2]]

    z = np.array([0, 0, 0.1])
    for _ in range(count):
        k1 = slope(z)
        if method == "euler":
            z = z + h * k1
        elif method == "heun":
            z = z + h / 2 * (k1 + slope(z + h * k1))
        else:
            k2 = slope(z + h / 2 * k1)
            k3 = slope(z + h / 2 * k2)
            z = z + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(z + h * k3))
    return z


def test_steps_of_the_component_have_order_four():
    errors = []
    for h in (0.1, 0.05, 0.025):
        craft = dimensionless(max_step=h, rudder=0.02, nu_start=(1.0, 0.1, -0.2))
        craft.initialise()
        craft.begin()
        craft.advance(0.0, 5.0)
        system = np.zeros((3, 3))
        system[:2, :2], system[:2, 2] = A, np.array(B) * 0.02
        exact = (expm(5.0 * system) @ [0.1, -0.2, 1.0])[:2]
        errors.append(np.abs(np.array(craft.get("nu")[1:]) - exact).max())
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 4.0, atol=0.1)


# ---------------------------------------------------------------------- dimensional


def test_dimensional_matrices():
    linear = ship("linear").linearise(np.array([0, 0, 0, U, 0, 0]))
    expected = [[-0.03689898, -2.58088635], [-0.00100996, -0.10041910]]
    np.testing.assert_allclose(linear.A[4:, 4:], expected, atol=5e-9)
    np.testing.assert_allclose(rudder_effect(linear), [0.06322043, -0.00374568], atol=5e-9)
    disturbance = [linear.u_names.index(f"disturbance.{axis}") for axis in "vr"]
    np.testing.assert_array_equal(linear.B[4:, disturbance], np.eye(2))


def test_dimensional_run_is_the_dimensionless_one():
    t = np.linspace(0, 15, 31)
    short = dimensionless().reference(t, pd(0.1), rtol=1e-12)
    long = ship("linear").reference(t * TIME, pd(0.1, KP, KD), rtol=1e-12)
    np.testing.assert_allclose(long["eta.psi"], short["eta.psi"], atol=1e-11)
    np.testing.assert_allclose(long["nu.v"] / U, short["nu.v"], atol=1e-11)
    np.testing.assert_allclose(long["eta.y"] / L, short["eta.y"], atol=1e-10)


def test_nomoto_time_constants():
    linear = ship("linear").linearise(np.array([0, 0, 0, U, 0, 0]))
    (a, b), (c, d) = linear.A[4:, 4:]
    Yd, Nd = rudder_effect(linear)
    poles = np.sort(np.linalg.eigvals(linear.A[4:, 4:]))
    np.testing.assert_allclose(-1 / poles, [7.765, 117.21], rtol=1e-4)
    constant = c * Yd - a * Nd
    assert Nd / constant == pytest.approx(18.537, rel=1e-4)
    assert constant / (a * d - b * c) == pytest.approx(-0.18390, rel=1e-4)


def coupled(craft, gear, x, command, h):
    """One Runge-Kutta step of ship and rudder machine together, the command held."""

    def slope(z):
        return np.append(slope_at(craft, z[:6], z[6]), gear.slope(z[6], command))

    k1 = slope(x)
    k2 = slope(x + h / 2 * k1)
    k3 = slope(x + h / 2 * k2)
    return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(x + h * k3))


def steered(variant, stop, command, h=0.1, **gear_settings):
    """Return t, the states with the rudder, and the commands, every ``h``."""
    craft, gear = ship(variant), machine(**gear_settings)
    x = np.array([0, 0, 0, U, 0, 0, 0.0])
    states, commands = [], []
    for k in range(round(stop / h) + 1):
        states.append(x)
        commands.append(command(k * h, x))
        x = coupled(craft, gear, x, commands[-1], h)
    return h * np.arange(len(states)), np.array(states), np.array(commands)


@cache
def step(variant, degrees, stop=600.0):
    goal = np.radians(degrees)
    return steered(variant, stop, lambda _t, x: KP * (x[2] - goal) + KD * x[5])


@pytest.mark.parametrize(
    ("variant", "file", "stop"),
    [
        ("cubic", "nl", 100.0),
        pytest.param("cubic", "nl", 600.0, marks=pytest.mark.interop),
        pytest.param("linear", "linS", 600.0, marks=pytest.mark.interop),
    ],
)
def test_step_of_5_degrees_with_rudder_machine(variant, file, stop):
    expected = table(f"mariner_dim_step5deg_{file}.csv")
    t, x, command = step(variant, 5.0, stop)
    found = {"t_s": t, "v": x[:, 4], "r": x[:, 5], "psi": x[:, 2]}
    found |= {"delta": x[:, 6], "delta_cmd": command}
    for name, values in found.items():
        # 9 significant digits, and the last figure of a sum of such.
        bound = 6e-9 * np.abs(expected[name]).max()
        found_there = values[::20]
        assert np.abs(found_there - expected[name][: len(found_there)]).max() < bound, name


@pytest.mark.interop
@pytest.mark.parametrize(
    ("degrees", "overshoot", "rudder"), [(5, 5.569, 3.684), (20, 5.567, 14.41)]
)
def test_figures_of_the_steps(degrees, overshoot, rudder):
    t, x, _ = step("linear", degrees)
    psi = np.degrees(x[:, 2])
    assert 100 * (psi.max() / degrees - 1) == pytest.approx(overshoot, rel=1e-4)
    assert np.degrees(np.abs(x[:, 6]).max()) == pytest.approx(rudder, rel=3e-4)
    if degrees == 5:
        assert t[psi.argmax()] == pytest.approx(119.6, abs=0.05)
        outside = np.flatnonzero(np.abs(psi - 5) > 0.02 * 5)[-1]
        assert t[outside] == pytest.approx(175.5, abs=0.1)


@pytest.mark.interop
def test_propeller_turns_the_cubic_ship_off_its_course():
    t, x, _ = step("cubic", 5.0)
    psi = np.degrees(x[:, 2])
    assert psi[-1] - 5 == pytest.approx(1.287, abs=5e-4)
    assert t[psi.argmax()] == pytest.approx(119.0, abs=0.05)
    assert np.degrees(np.abs(x[:, 6]).max()) == pytest.approx(3.52, abs=5e-3)


@pytest.mark.interop
@pytest.mark.parametrize(("variant", "mirrors"), [("linear", True), ("cubic", False)])
def test_port_and_starboard_mirror_each_other_in_the_linear_model_only(variant, mirrors):
    sides = [step(variant, degrees)[1][:, 2] for degrees in (5.0, -5.0)]
    if mirrors:
        np.testing.assert_array_equal(sides[0], -sides[1])
    else:
        assert np.abs(sides[0] + sides[1]).max() > np.radians(2.5)


@pytest.mark.interop
def test_turning_circle():
    """15 degrees to port at 100 s; the course is not straight before: the propeller turns it."""

    def command(t, _x):
        return np.radians(-15.0) if t > 99.95 else 0.0

    t, states, _ = steered("cubic", 700.0, command, positive="starboard")
    x, y, psi = states[:, :3].T
    execute = x[np.argmax(t > 99.95)]
    assert execute == pytest.approx(770.1, rel=1e-4)
    quarter = np.argmax(np.abs(psi) >= np.pi / 2)
    assert x[quarter] - execute == pytest.approx(946.3, rel=1e-4)
    assert -y[quarter] == pytest.approx(539.8, rel=1e-4)
    assert -y.min() == pytest.approx(1314.6, rel=1e-4)
    assert x.max() - execute == pytest.approx(950.1, rel=1e-4)
    speed = np.hypot(states[-1, 3], states[-1, 4])
    assert speed == pytest.approx(6.629, rel=1e-4)
    assert speed / abs(states[-1, 5]) == pytest.approx(711.21, rel=1e-4)


# ---------------------------------------------------------------------- inputs and limits


def test_positive_rudder_turns_to_port():
    for variant in ("linear", "cubic"):
        slopes = [slope_at(ship(variant), np.array([0, 0, 0, U, 0, 0]), d) for d in (0, 0.1)]
        sway, yaw = (slopes[1] - slopes[0])[4:]
        assert sway > 0 > yaw


def test_straight_course_of_the_linear_model_keeps_its_speed():
    run = ship("linear", eta_start=(0.0, 0.0, np.pi / 6)).reference([0.0, 100.0])
    expected = [100 * U * np.cos(np.pi / 6), 100 * U * 0.5, np.pi / 6, U, 0, 0]
    np.testing.assert_allclose(run.x[-1], expected, rtol=1e-12)


def test_linear_model_refuses_another_speed():
    with pytest.raises(InputError, match=r"nu_start\.u is 7\.0 m/s; the linear model keeps"):
        ship("linear", nu_start=(7.0, 0.0, 0.0)).initialise()
    ship("cubic", nu_start=(7.0, 0.0, 0.0)).initialise()


def test_mass_matrix_must_have_a_positive_determinant():
    craft = ManoeuvringShip("ship")
    craft.set("model", "cubic")
    craft.set("mass", 0.0)
    with pytest.raises(InputError, match="determinant of the mass matrix is 0"):
        craft.initialise()
