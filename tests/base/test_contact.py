"""Contact by penalty, against closed forms and trajectories computed elsewhere."""

import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.physics.contact import Bristle, friction, hunt_crossley, kelvin_voigt, restitution

REFERENCE = Path(__file__).parents[1] / "reference"
G, MASS, STIFFNESS = 9.81, 10.0, 24525.0
DECK_MASS, DECK_STIFFNESS, DECK_DAMPING = 39.577, 5027.625, 1500.0
REDUCED = MASS * DECK_MASS / (MASS + DECK_MASS)


def rk4(rate, state, h):
    k1 = rate(state)
    k2 = rate(state + 0.5 * h * k1)
    k3 = rate(state + 0.5 * h * k2)
    k4 = rate(state + h * k3)
    return state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def landing(law, damping, h, points=151):
    """Return the rows of the landing every 10 ms: t, foot and deck with their speeds, force."""

    def force(state):
        foot, sink, deck, heave = state
        return law(foot - deck, sink - heave, STIFFNESS, damping)

    def rate(state):
        _, sink, deck, heave = state
        f = force(state)
        deck_force = f - DECK_STIFFNESS * deck - DECK_DAMPING * heave
        return np.array([sink, G - f / MASS, heave, deck_force / DECK_MASS])

    state, rows, each = np.array([-0.02, 0.5, 0.0, 0.0]), [], round(0.01 / h)
    for k in range(points):
        rows.append([0.01 * k, *state, force(state)])
        for _ in range(each):
            state = rk4(rate, state, h)
    return np.array(rows)


@pytest.mark.parametrize(
    ("name", "law", "damping", "h", "tolerance"),
    [
        ("hc", hunt_crossley, 1.0, 1e-4, 1e-6),
        ("hc", hunt_crossley, 1.0, 1e-3, 5e-5),
        ("kv", kelvin_voigt, math.sqrt(STIFFNESS * REDUCED), 1e-4, 1e-3),
        ("kv", kelvin_voigt, math.sqrt(STIFFNESS * REDUCED), 2e-3, 2e-2),
    ],
)
def test_a_landing_on_a_floating_deck_is_the_references(name, law, damping, h, tolerance):
    expected = np.loadtxt(REFERENCE / f"sea_landing_{name}.csv", delimiter=",", skiprows=1)
    found = landing(law, damping, h)
    assert np.allclose(found[:, 0], expected[:, 0])
    assert (np.abs(found - expected) <= tolerance * np.abs(expected).max(axis=0)).all()


def test_at_rest_the_deck_carries_the_weight():
    foot, _, deck, _, force = landing(hunt_crossley, 1.0, 1e-3, 1001)[-1, 1:]
    assert force == pytest.approx(98.1, rel=1e-9)
    assert deck == pytest.approx(98.1 / DECK_STIFFNESS, rel=1e-9)
    assert foot - deck == pytest.approx(98.1 / STIFFNESS, rel=1e-9)


@pytest.mark.parametrize(
    ("damped_speed", "expected"),
    [(0.2, 0.882), (0.5, 0.748), (1.0, 0.594), (2.0, 0.411), (5.0, 0.197)],
)
def test_restitution_of_the_closed_form_and_of_an_impact(damped_speed, expected):
    assert restitution(damped_speed, 1.0) == pytest.approx(expected, abs=5e-4)
    assert restitution(2.0 * damped_speed, 0.5) == restitution(damped_speed, 1.0)

    def rate(state):
        return np.array([state[1], -hunt_crossley(state[0], state[1], 1e4, damped_speed)])

    state = np.array([0.0, 1.0])
    while state[0] >= 0.0:
        state = rk4(rate, state, 1e-5)
    assert -state[1] == pytest.approx(restitution(damped_speed, 1.0), abs=1e-4)


def test_without_damping_nothing_is_lost():
    assert restitution(0.0, 3.0) == 1.0


@given(st.floats(-0.1, 0.1), st.floats(-5.0, 5.0), st.floats(0.0, 10.0))
def test_contact_never_pulls_and_acts_inside_alone(penetration, rate, damping):
    for law in (hunt_crossley, kelvin_voigt):
        force = law(penetration, rate, 1e4, damping)
        assert force >= 0.0
        assert force == 0.0 or penetration > 0.0
    assert hunt_crossley(penetration, rate, 1e4, damping) <= 1e4 * max(penetration, 0.0) * (
        1.0 + damping * abs(rate)
    )


@given(st.floats(0.0, 2.0 * math.pi), st.floats(-1.0, 1.0))
def test_friction_opposes_and_prefers_no_axis(turn, speed):
    velocity = [speed * math.cos(turn), speed * math.sin(turn)]
    x, y = friction(100.0, velocity, 0.6, 0.01)
    size = 60.0 * abs(speed) / math.hypot(speed, 0.01)
    assert math.hypot(x, y) == pytest.approx(size)
    assert x * velocity[0] + y * velocity[1] <= 0.0
    assert x * velocity[1] - y * velocity[0] == pytest.approx(0.0, abs=1e-12)


def test_creep_on_a_slope_is_the_closed_form():
    slope, mass, mu, slip = math.radians(5.0), 10.0, 0.6, 0.01
    normal = mass * G * math.cos(slope)

    def rate(state):
        return np.array([G * math.sin(slope) + friction(normal, state, mu, slip)[0] / mass])

    state = np.array([0.0])
    for _ in range(1000):
        state = rk4(rate, state, 1e-3)
    share = math.tan(slope) / mu
    assert state[0] == pytest.approx(slip * share / math.sqrt(1.0 - share**2), rel=1e-9)
    assert state[0] == pytest.approx(1.474e-3, abs=5e-7)


def test_bristles_hold_without_creep():
    slope, mass = math.radians(5.0), 10.0
    normal = mass * G * math.cos(slope)
    law = Bristle(0.6, 2e4, math.sqrt(2e4 * mass))

    def rate(state):
        speed, bend = [state[0]], [state[1]]
        pulled = law.force(bend, speed, normal)[0]
        return np.array([G * math.sin(slope) + pulled / mass, law.rate(bend, speed, normal)[0]])

    state = np.array([0.0, 0.0])
    for _ in range(5000):
        state = rk4(rate, state, 1e-3)
    assert abs(state[0]) < 1e-15
    assert state[1] == pytest.approx(mass * G * math.sin(slope) / 2e4)


def test_bristles_slide_with_coulombs_force_and_rest_in_the_air():
    law = Bristle(0.6, 2e4, 100.0)
    bend = (0.6 * 50.0 / 2e4, 0.0)
    assert law.rate(bend, (0.3, 0.0), 50.0) == pytest.approx((0.0, 0.0))
    assert law.force(bend, (0.0, 0.0), 50.0) == pytest.approx((-30.0, 0.0))
    assert law.rate(bend, (0.3, 0.0), 0.0) == (0.0, 0.0)
    assert law.force(bend, (0.3, 0.0), 0.0) == (0.0, 0.0)


def test_expressions_of_casadi_are_the_numbers():
    x, v = ca.SX.sym("x"), ca.SX.sym("v")
    for law in (hunt_crossley, kelvin_voigt):
        function = ca.Function("f", [x, v], [law(x, v, 1e4, 0.7)])
        for values in ((0.01, 0.5), (0.01, -3.0), (-0.01, 0.5), (0.02, -0.1)):
            assert float(function(*values)) == law(*values, 1e4, 0.7)
    function = ca.Function("f", [x, v], friction(10.0, [x, v], 0.5, 0.01))
    assert [float(f) for f in function(0.3, -0.1)] == pytest.approx(
        friction(10.0, [0.3, -0.1], 0.5, 0.01)
    )
