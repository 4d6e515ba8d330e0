"""The shipped VideoRay Pro 4 against closed forms and reference data."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from seatrial.physics.craft.rov import Rov
from seatrial.system.parameters import load_vehicle
from tests.craft.rov_runs import ran

DATA = Path(__file__).parents[2] / "reference"
GRAVITY = 9.81
QUADRATIC = ("quadratic_damping_force", "quadratic_damping_moment")
DAMPING = ("linear_damping_force", "linear_damping_moment", *QUADRATIC)


def videoray(**values):
    """Return the shipped vehicle at rest, 5 m deep."""
    component = Rov("vehicle")
    for name, entry in load_vehicle("videoray").parameter_set("rov", "source").values.items():
        component.set(name, entry.value)
    for name, value in {"eta_start": (0, 0, 5, 0, 0, 0), **values}.items():
        component.set(name, value)
    return component


# ---------------------------------------------------------------------- closed forms


def terminal(d1, d2, force):
    return (-d1 + math.sqrt(d1 * d1 + 4 * d2 * force)) / (2 * d2)


@pytest.mark.parametrize("force", [0.1, 1.0, 5.0])
def test_drag_balances_thrust_in_surge(force):
    component = videoray(volume=6.5e-3)
    speed = terminal(0.95, 6.04, force)
    component.set("force_1", (force, 0, 0))
    x = np.array([0, 0, 5.0, 0, 0, 0, speed, 0, 0, 0, 0, 0])
    # The accelerations' rounding: 2e-15 of the thrust per kilogram.
    assert np.abs(component.derivatives(x)[6:]).max() < 2e-15 * max(1.0, force)
    if speed < 0.6:  # from rest, while level motion is stable
        end = component.reference([0.0, 200.0]).x[-1]
        assert end[6] == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize(("axis", "d1", "d2"), [(2, 3.70, 26.36), (5, 0.023, 0.45)])
def test_drag_balances_thrust_in_heave_and_yaw(axis, d1, d2):
    component = videoray(volume=6.5e-3)
    component.set("moment_1" if axis == 5 else "force_1", (0, 0, 0.5))
    end = component.reference([0.0, 60.0]).x[-1, 6:]
    assert end[axis] == pytest.approx(terminal(d1, d2, 0.5), rel=1e-9)
    assert np.abs(np.delete(end, axis)).max() == 0.0


def test_buoyancy_brings_it_up():
    lift = GRAVITY * (1000 * 6.533e-3 - 6.5)
    assert lift == pytest.approx(0.005 * 6.5 * GRAVITY, rel=0.02)
    end = videoray().reference([0.0, 60.0])["nu.w"][-1]
    assert end == pytest.approx(-terminal(3.70, 26.36, lift), rel=1e-9)


def test_quadratic_drag_alone_gives_a_hyperbolic_tangent():
    thrust, d2, mass = 2.0, 6.04, 6.5 + 1.94
    speed, time_constant = math.sqrt(thrust / d2), mass / math.sqrt(thrust * d2)
    errors = []
    for count in (10, 20, 40, 80):
        component = videoray(volume=6.5e-3, linear_damping_force=0.0)
        component.set("force_1", (thrust, 0, 0))
        u = ran(component, 4.0, count)[:, 6]
        exact = speed * np.tanh(np.linspace(0, 4.0, count + 1) / time_constant)
        errors.append(np.abs(u - exact).max())
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert ((orders > 3.9) & (orders < 4.4)).all(), orders


@pytest.mark.parametrize("axis", [3, 4])
@pytest.mark.parametrize("angle", [-1.3, -0.2, 0.05, 1.0])
def test_righting_moment(axis, angle):
    component = videoray(volume=6.5e-3)
    x = np.zeros(12)
    x[axis] = angle
    moment = component.mass_matrix() @ component.derivatives(x)[6:]
    expected = np.zeros(6)
    expected[axis] = -6.5 * GRAVITY * 0.03 * math.sin(angle)
    np.testing.assert_allclose(moment, expected, rtol=0, atol=1e-15 * 6.5 * GRAVITY)


def test_natural_frequencies_of_roll_and_pitch():
    component = videoray(volume=6.5e-3, **dict.fromkeys(DAMPING, 0.0))
    A = component.linearise(np.zeros(12)).A
    found = sorted(abs(np.linalg.eigvals(A).imag))[-4::2]
    stiffness = 6.5 * GRAVITY * 0.03
    expected = sorted(math.sqrt(stiffness / i) for i in (0.072 + 0.033, 0.105 + 0.018))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def least_stable(speed, states):
    """Return the largest real part of the eigenvalues of ``states`` at ``speed`` ahead.

    Linear drag alone, weight and buoyancy equal.
    """
    component = videoray(volume=6.5e-3, **dict.fromkeys(QUADRATIC, 0.0))
    x = np.zeros(12)
    x[6] = speed
    A = component.linearise(x).A
    return np.linalg.eigvals(A[np.ix_(states, states)]).real.max()


def test_straight_course_is_unstable_above_the_speed_of_the_munk_moment():
    # Stable if d22 d33 > m11 (m22 - m11) U^2.
    m11, m22 = 6.5 + 1.94, 6.5 + 6.05
    limit = math.sqrt(5.87 * 0.023 / (m11 * (m22 - m11)))
    assert limit == pytest.approx(0.062, abs=5e-4)
    v_r = [7, 11]
    found = brentq(lambda speed: least_stable(speed, v_r), 0.01, 0.5, xtol=1e-12)
    assert found == pytest.approx(limit, rel=1e-9)


def test_level_course_is_unstable_above_a_speed_of_routh_and_hurwitz():
    # M55 s^3 + a2 s^2 + a1 s + a0: heave, pitch rate and pitch at a speed ahead.
    m11, m33, M55 = 6.5 + 1.94, 6.5 + 3.95, 0.105 + 0.018
    d33, d55, K = 3.70, 0.02, 6.5 * GRAVITY * 0.03
    a2, a0 = d55 + M55 * d33 / m33, K * d33 / m33
    limit = math.sqrt((K + d55 * d33 / m33 - M55 * a0 / a2) * m33 / (m11 * (m33 - m11)))
    assert limit == pytest.approx(0.61, abs=5e-3)
    w_q_theta = [8, 10, 4]
    found = brentq(lambda speed: least_stable(speed, w_q_theta), 0.3, 1.0, xtol=1e-12)
    assert found == pytest.approx(limit, rel=1e-9)


# ---------------------------------------------------------------------- reference data


@pytest.mark.slow
def test_level_motion_under_pi_control_is_that_of_the_surface_vessel():
    """The law of the reference, every 0.1 s and held, on the vehicle without quadratic drag."""
    with (DATA / "videoray_pi_case1_physical.csv").open() as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    first = rows[0]
    component = videoray(
        volume=6.5e-3,
        **dict.fromkeys(QUADRATIC, 0.0),
        inertia=(0.072, 0.105, 0.133 - 0.0118, 0, 0, 0),  # the reference rounds m33
        nu_start=(first["u"], first["v"], 0, 0, 0, first["r"]),
    )
    component.initialise()
    component.begin()
    m11, m22, m33 = 6.5 + 1.94, 6.5 + 6.05, 0.133
    kp, ki, period, full, arm = 2.0, 1.0, 0.1, 46.7, 0.1
    wanted, learnt = (0.05, 0.2), [0.0, 0.0]
    for k in range(round(rows[-1]["t"] / period) + 1):
        u, v, _, _, _, r = component.get("nu")
        errors = u - wanted[0], r - wanted[1]
        a_u, a_r = (-kp * e - ki * i for e, i in zip(errors, learnt, strict=True))
        X = m11 * a_u + 0.95 * u - m22 * v * r
        N = (m33 * a_r + 0.023 * r - (m11 - m22) * u * v) / arm
        tau = [(X + N) / (2 * full), (X - N) / (2 * full)]
        assert max(map(abs, tau)) < 1.0  # never saturated: the reference's limit is not reached
        learnt = [i + e * period for i, e in zip(learnt, errors, strict=True)]
        if k % 10 == 0:
            row = rows[k // 10]
            assert row["t"] == pytest.approx(k * period)
            expected = [row[name] for name in ("u", "v", "r", "tau1", "tau2")]
            np.testing.assert_allclose([u, v, r, *tau], expected, rtol=1e-7, atol=1e-9)
        component.set("force_1", (full * sum(tau), 0, 0))
        component.set("moment_1", (0, 0, full * arm * (tau[0] - tau[1])))
        component.advance(k * period, period)
