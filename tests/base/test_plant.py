"""Plants against closed forms, SciPy's expm and its solvers."""

from __future__ import annotations

import itertools
import math
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from scipy import integrate, linalg

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.dependencies.found import feedthrough_of
from seatrial.model.component import Input, Output, Parameter
from seatrial.model.plant import Plant, State


class Logistic(Plant):
    """x' = r x (1 - x / K): nonlinear, solved by a logistic curve."""

    rate = Parameter(2.0, "1/s", "growth")
    capacity = Parameter(3.0, "m", "carrying capacity")
    x = State("m", "size", start=0.1)

    def equations(self, x, u, p):
        return {"x": p.rate * x.x * (1 - x.x / p.capacity)}, {}


def logistic(t: float, x0: float = 0.1, rate: float = 2.0, capacity: float = 3.0) -> float:
    return capacity / (1 + (capacity / x0 - 1) * math.exp(-rate * t))


class Oscillator(Plant):
    """Two masses in a row: vector states and inputs, parameters of every kind."""

    stiffness = Parameter((40.0, 25.0), "N/m", "springs", axes="ab")
    damping = Parameter(0.8, "N.s/m", "dampers")
    mass = Parameter(2.0, "kg", "each mass")
    drive = Parameter(1.0, "1", "share of the force that acts", tunable=True)
    force = Input("N", "force on each", axes="ab")
    gust = Input("N", "force on both")
    place = State("m", "place", axes="ab")
    speed = State("m/s", "speed", axes="ab")
    spring = Output("N", "force of the first spring")
    acceleration = Output("m/s2", "acceleration", axes="ab")
    feedthrough: ClassVar = {"acceleration": ("force", "gust")}

    def equations(self, x, u, p):
        K = ca.vertcat(
            ca.horzcat(p.stiffness[0] + p.stiffness[1], -p.stiffness[1]),
            ca.horzcat(-p.stiffness[1], p.stiffness[1]),
        )
        push = p.drive * u.force + u.gust - K @ x.place - p.damping * x.speed
        derivatives = {"speed": push / p.mass, "place": x.speed}
        return derivatives, {"spring": p.stiffness[0] * x.place[0], "acceleration": push / p.mass}


K = np.array([[65.0, -25.0], [-25.0, 25.0]])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-K / 2.0, -0.4 * np.eye(2)]])
B = np.vstack([np.zeros((2, 3)), [[0.5, 0.0, 0.5], [0.0, 0.5, 0.5]]])


class Pendulum(Plant):
    """m l^2 theta'' = -m g l sin(theta) - c theta' + torque."""

    damping = Parameter(0.3, "N.m.s/rad", "damping")
    torque = Input("N.m", "torque")
    theta = State("rad", "angle from hanging")
    omega = State("rad/s", "rate")
    tip = Output("m", "place of the tip", axes="xz")
    power = Output("W", "power of the torque")
    feedthrough: ClassVar = {"power": ("torque",)}

    def equations(self, x, u, p):
        alpha = (u.torque - p.damping * x.omega - 2.0 * 9.81 * 1.5 * ca.sin(x.theta)) / (
            2.0 * 1.5**2
        )
        tip = ca.vertcat(1.5 * ca.sin(x.theta), 1.5 * ca.cos(x.theta))
        return {"theta": x.omega, "omega": alpha}, {"tip": tip, "power": u.torque * x.omega}


def running(cls: type[Plant], **values) -> Plant:
    plant = cls("plant")
    for name, value in values.items():
        plant.set(name, value)
    plant.initialise()
    plant.begin()
    return plant


def state(plant: Plant) -> list[float]:
    got = [plant.get(port.name) for port in plant.state_ports]
    return [v for value in got for v in (value if isinstance(value, list) else [value])]


def orders(errors: list[float]) -> list[float]:
    return [math.log2(a / b) for a, b in itertools.pairwise(errors)]


# ---------------------------------------------------------------------- the fixed step


def test_order_four_on_a_nonlinear_problem() -> None:
    errors = []
    for steps in (40, 80, 160, 320):
        plant, h = running(Logistic, max_step=1.0), 2.0 / steps
        for k in range(steps):
            plant.advance(k * h, h)
        errors.append(abs(plant.get("x") - logistic(2.0)))
    assert orders(errors) == pytest.approx([4.0] * 3, abs=0.05)
    assert errors[-1] < 3e-10


def test_order_four_on_a_linear_problem_against_expm() -> None:
    x0, force = np.array([0.1, -0.2, 0.3, 0.0]), np.array([3.0, -2.0, 0.5])
    rest = np.linalg.solve(A, -B @ force)
    exact = rest + linalg.expm(A * 2.0) @ (x0 - rest)
    errors = []
    for steps in (80, 160, 320, 640):
        plant, h = (
            running(Oscillator, max_step=1.0, place_start=x0[:2], speed_start=x0[2:]),
            2.0 / steps,
        )
        plant.set("force", force[:2])
        plant.set("gust", force[2])
        for k in range(steps):
            plant.advance(k * h, h)
        errors.append(np.abs(state(plant) - exact).max())
    assert orders(errors) == pytest.approx([4.0] * 3, abs=0.05)
    assert errors[-1] < 1e-8


def test_one_step_is_the_taylor_polynomial_of_order_four() -> None:
    """For x' = A x a step of the classical method is the first five terms of expm(A h)."""
    plant = running(Oscillator, max_step=1.0, place_start=(1.0, -0.5), speed_start=(0.2, 2.0))
    x, h = np.array(state(plant)), 0.05
    terms, term = x.copy(), x.copy()
    for k in range(1, 5):
        term = A @ term * h / k
        terms += term
    plant.advance(0.0, h)
    np.testing.assert_allclose(state(plant), terms, rtol=1e-14)


class Fade(Plant):
    """x' = -rate x."""

    rate = Parameter(1.0, "1/s", "rate")
    x = State("m", "x", start=1.0)

    def equations(self, x, u, p):
        return {"x": -p.rate * x.x}, {}


@pytest.mark.parametrize(
    ("h", "max_step", "count"),
    [(0.1, 0.1, 1), (0.1, 0.05, 2), (0.1, 0.03, 4), (0.1, 0.0999, 2), (0.3, 0.1, 3), (1.0, 0.01, 100), (0.01, 1.0, 1), (0.7, 0.1, 7), (0.1, 0.1001, 1), (0.07, 0.01, 7)],
)  # fmt: skip
def test_sub_steps_are_equal_and_no_longer_than_allowed(h, max_step, count) -> None:
    """With rate = count / h each of count sub-steps multiplies by 1 - 1 + 1/2 - 1/6 + 1/24 = 3/8.

    0.7 / 0.1 and 0.07 / 0.01 are 6.999999999999999 and 7.000000000000001 in doubles.
    """
    plant = running(Fade, max_step=max_step, rate=count / h)
    plant.advance(0.0, h)
    assert plant.get("x") == pytest.approx(0.375**count, rel=1e-12)


def test_inputs_are_held_over_a_step() -> None:
    """Against expm of the system with its inputs as states that stand still."""
    held = linalg.expm(np.block([[A, B], [np.zeros((3, 7))]]) * 0.05)
    plant, x = running(Oscillator, max_step=0.001), np.zeros(4)
    rng = np.random.default_rng(1)
    for k in range(60):
        u = rng.normal(size=3)
        plant.set("force", u[:2])
        plant.set("gust", u[2])
        plant.advance(k * 0.05, 0.05)
        x = (held @ np.concatenate([x, u]))[:4]
        np.testing.assert_allclose(state(plant), x, atol=1e-11)


def test_outputs_follow_states_and_inputs_at_once() -> None:
    plant = running(Oscillator, place_start=(0.1, 0.3), speed_start=(1.0, -1.0))
    for force in ([0.0, 0.0], [5.0, -3.0]):
        plant.set("force", force)
        x = np.array(state(plant))
        expected = A[2:] @ x + np.array(force) / 2.0
        assert plant.get("acceleration") == pytest.approx(expected.tolist(), rel=1e-14)
        assert plant.get("spring") == pytest.approx(40.0 * x[0], rel=1e-15)
        plant.advance(0.0, 0.01)


def test_start_values_are_parameters_and_published() -> None:
    plant = Oscillator("plant")
    plant.initialise()
    plant.set("place_start", (1.0, 2.0))
    plant.set("speed_start.b", 3.0)
    assert state(plant) == [1.0, 2.0, 0.0, 3.0]
    plant.begin()
    with pytest.raises(InputError, match=r"place_start\.a is a fixed parameter"):
        plant.set("place_start", (0.0, 0.0))
    assert Oscillator.ports["place_start"].description == "start value of place: place"
    assert Oscillator.ports["place_start"].unit == "m"


def test_tunable_parameters_act_at_the_next_step_and_fixed_ones_are_refused() -> None:
    plant = running(Oscillator, max_step=0.001)
    plant.set("force", (4.0, 0.0))
    x = np.zeros(4)
    held = linalg.expm(np.block([[A, B], [np.zeros((3, 7))]]) * 0.02)
    for k, drive in enumerate([1.0, 1.0, -2.0, 0.0, 3.0]):
        plant.set("drive", drive)
        expected = A[2:] @ x + [drive * 2.0, 0.0]
        assert plant.get("acceleration") == pytest.approx(expected.tolist(), abs=1e-9)
        plant.advance(k * 0.02, 0.02)
        x = (held @ np.concatenate([x, [drive * 4.0, 0.0, 0.0]]))[:4]
        np.testing.assert_allclose(state(plant), x, atol=1e-11)
    with pytest.raises(InputError, match="mass is a fixed parameter"):
        plant.set("mass", 3.0)


def test_a_state_that_runs_away_is_named() -> None:
    plant = running(Logistic, x_start=-0.1, max_step=1.0)  # escapes at t = log(1 + 30) / 2 = 1.7
    with pytest.raises(SimulationError, match=r"plant: output x is (nan|-inf) at t = ") as error:
        for k in range(200):
            plant.advance(k * 0.1, 0.1)
    assert float(str(error.value).split(" = ")[1].split()[0]) < 5.0


# ---------------------------------------------------------------------- state and instances


def drive(plant: Plant, first: int, last: int) -> list[list[float]]:
    rows = []
    for k in range(first, last):
        plant.set("torque", math.sin(k))
        plant.advance(k * 0.05, 0.05)
        rows.append([*state(plant), plant.get("power"), *plant.get("tip")])
    return rows


@pytest.mark.parametrize("at", [0, 1, 37])
def test_a_restored_plant_goes_on_bit_by_bit(at: int) -> None:
    plant = running(Pendulum, theta_start=2.0)
    drive(plant, 0, at)
    kept = plant.get_state()
    went_on = drive(plant, at, 100)
    for _ in range(3):
        plant.set_state(kept)
        assert drive(plant, at, 100) == went_on
    fresh = Pendulum("fresh")  # never started
    fresh.set_state(kept)
    assert drive(fresh, at, 100) == went_on


def test_restoring_does_not_disturb_another_instance() -> None:
    a, b = running(Pendulum, theta_start=1.0), running(Pendulum, theta_start=2.0)
    kept = a.get_state()
    b.set_state(kept)
    drive(b, 0, 20)
    assert (a.get("theta"), kept["_x"].tolist()) == (1.0, [1.0, 0.0])
    assert drive(a, 0, 20)[-1] == [*state(b), b.get("power"), *b.get("tip")]


def test_instances_of_one_class_share_nothing() -> None:
    """Turn about they give what each gives alone."""
    starts = [0.1, 1.0, 3.0]
    alone = [drive(running(Pendulum, theta_start=s, damping=s), 0, 50) for s in starts]
    plants = [running(Pendulum, theta_start=s, damping=s) for s in starts]
    together: list[list[list[float]]] = [[], [], []]
    for k in range(50):
        for rows, plant in zip(together, plants, strict=True):
            rows += drive(plant, k, k + 1)
    assert together == alone


def test_a_state_taken_before_the_start_restores_a_plant_that_can_start() -> None:
    plant = Pendulum("plant")
    before = plant.get_state()
    plant.set("theta_start", 1.0)
    plant.initialise()
    plant.begin()
    went_on = drive(plant, 0, 10)
    plant.set_state(before)
    plant.set("theta_start", 1.0)
    plant.initialise()
    plant.begin()
    assert drive(plant, 0, 10) == went_on


def test_the_fast_step_is_the_plain_formula() -> None:
    """Against the four stages spelt out in NumPy, over chaotic length."""
    plant = running(Pendulum, theta_start=3.0, max_step=0.01, damping=0.0)
    x, h = np.array([3.0, 0.0]), 0.01

    def f(x):
        return np.array([x[1], -2.0 * 9.81 * 1.5 * math.sin(x[0]) / (2.0 * 1.5**2)])

    for k in range(500):
        plant.advance(k * h, h)
        k1 = f(x)
        k2 = f(x + h / 2 * k1)
        k3 = f(x + h / 2 * k2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + f(x + h * k3))
    np.testing.assert_allclose(state(plant), x, rtol=1e-11)


# ---------------------------------------------------------------------- equations chosen by text


class Decay(Plant):
    """x' = -x, or x' = -x^2, or nothing at all."""

    law = Parameter("linear", "1", "law", choices=("linear", "square", "none"))
    sign = Parameter("down", "1", "sign", choices=("down", "up"))
    x = State("m", "x", start=1.0)
    rate = Output("m/s", "dx/dt", axes="ab")

    def equations(self, x, u, p):
        laws = {"linear": x.x, "square": x.x**2, "none": 0.0}
        rate = (-1 if p.sign == "down" else 1) * laws[p.law]
        return {"x": rate}, {"rate": ca.vertcat(rate, 0)}


def test_two_variants_live_side_by_side() -> None:
    exact = {
        ("linear", "down"): math.exp(-0.5),
        ("square", "down"): 1 / 1.5,
        ("none", "down"): 1.0,
        ("linear", "up"): math.exp(0.5),
        ("square", "up"): 2.0,
    }
    plants = {key: running(Decay, law=key[0], sign=key[1], max_step=1e-3) for key in exact}
    for k in range(50):
        for plant in plants.values():
            plant.advance(k * 0.01, 0.01)
    for key, plant in plants.items():
        assert plant.get("x") == pytest.approx(exact[key], rel=1e-11)
    assert [plants["none", "down"].get("rate"), plants["square", "up"].get("rate.b")] == [[0, 0], 0]
    kept = plants["square", "down"].get_state()
    plants["linear", "up"].set_state(kept)  # the text travels with the state
    for key in (("linear", "up"), ("square", "down")):
        plants[key].advance(0.5, 0.5)
        assert plants[key].get("x") == pytest.approx(0.5, rel=1e-11)


def test_a_text_changed_before_begin_chooses_anew() -> None:
    plant = Decay("plant")
    plant.initialise()
    assert plant.get("rate.a") == -1.0
    plant.set("sign", "up")
    assert plant.get("rate.a") == 1.0
    plant.set("law", "cubic")
    with pytest.raises(InputError, match="unknown value of law 'cubic'"):
        plant.begin()


# ---------------------------------------------------------------------- declarations refused


def declared(equations, **ports) -> type[Plant]:
    ports = {"u": Input("m", "u"), "x": State("m", "x", axes="ab"), **ports}
    return type("Odd", (Plant,), {**ports, "equations": equations})


@pytest.mark.parametrize(
    ("equations", "message"),
    [
        (lambda s, x, u, p: ({"x": x.x, "z": 1}, {}), r"Odd: derivatives: \['x', 'z'\] do not match the ports \['x'\]"),
        (lambda s, x, u, p: ({}, {}), r"derivatives: \[\] do not match the ports \['x'\]"),
        (lambda s, x, u, p: ({"x": x.x}, {"y": 1}), r"Odd: outputs: \['y'\] do not match the ports \[\]"),
        (lambda s, x, u, p: ({"x": x.x[0]}, {}), r"derivatives: x has shape \(1, 1\), its port \(2, 1\)"),
        (lambda s, x, u, p: ({"x": x.x.T}, {}), r"x has shape \(1, 2\), its port \(2, 1\)"),
        (lambda s, x, u, p: ({"x": ca.vertcat(x.x, 0)}, {}), r"x has shape \(3, 1\)"),
    ],
)  # fmt: skip
def test_equations_that_do_not_match_the_ports(equations, message: str) -> None:
    with pytest.raises(TypeError, match=message):
        declared(equations)("it").initialise()


def test_a_mistake_in_equations_is_named_with_its_line() -> None:
    def equations(self, x, u, p):
        half = x.x / 2
        return {"x": half * u.speed}, {}

    line = equations.__code__.co_firstlineno + 2
    message = (
        rf"^Odd: test_plant.py, line {line}: return {{'x': half \* u.speed}}, {{}}: AttributeError: "
        r".* no attribute 'speed' \(x has x; u has u; p has max_step, x_start\)$"
    ).replace("'x'", '"x"')
    with pytest.raises(InputError, match=message):
        declared(equations)("it").initialise()


def test_a_plant_without_equations_says_so() -> None:
    class Empty(Plant):
        x = State("m", "x")

    with pytest.raises(TypeError, match="Empty defines no equations"):
        Empty("it").initialise()


def test_feedthrough_is_found_in_the_expressions_and_a_declaration_cannot_deny_it() -> None:
    def equations(self, x, u, p):
        return {"x": x.x}, {"y": x.x + ca.vertcat(0, u.u), "z": u.v**2 + 0 * u.u}

    ports = {"v": Input("m", "v"), "y": Output("m", "y", axes="ab"), "z": Output("m2", "z")}
    free = declared(equations, **ports)
    running(free, u=2.0, v=3.0)
    assert {k: set(v) for k, v in feedthrough_of(free).items()} == {
        "x": set(),
        "y": {"u"},
        "z": {"v"},
    }
    whole = declared(equations, **ports, feedthrough={"y": ("u",), "z": ("v", "u")})
    running(whole, u=2.0, v=3.0)
    partly = declared(equations, **ports, feedthrough={"y": ("u",), "z": ("u",)})
    with pytest.raises(InputError, match=r"Odd\.feedthrough says that 'z' does not depend on 'v'"):
        partly("it").initialise()


@pytest.mark.parametrize(
    "port",
    [
        lambda: Input("1", "count", type=int),
        lambda: Output("1", "flag", type=bool),
        lambda: Output("1", "text", type=str),
    ],
)
def test_ports_of_a_plant_are_real(port) -> None:
    with pytest.raises(TypeError, match=r"Odd\.q: a plant's ports are real numbers"):
        declared(lambda s, x, u, p: ({"x": x.x}, {}), q=port())


def test_a_text_input_does_not_reach_the_equations() -> None:
    def equations(self, x, u, p):
        assert set(vars(u)) == {"u"}
        return {"x": x.x + u.u}, {}

    plant = running(declared(equations, fault=Input("1", "failure", type=str, start="none")), u=2.0)
    plant.set("fault", "off")
    plant.advance(0.0, 0.1)
    with pytest.raises(TypeError, match="Odd: text inputs stand before or after all others"):
        declared(equations, text=Input("1", "text", type=str), v=Input("m", "v"))


def test_text_that_chooses_equations_cannot_be_tunable() -> None:
    with pytest.raises(TypeError, match=r"Odd\.law: equations cannot change in a run"):
        declared(lambda s, x, u, p: ({"x": x.x}, {}), law=Parameter("a", "1", "law", tunable=True))


def test_zeros_keep_their_places() -> None:
    """CasADi leaves out structural zeros; a result array has a place for each."""

    class Sparse(Plant):
        rate = Parameter(2.0, "1/s", "rate")
        a = State("1", "a", axes="xyz")
        b = State("1", "b", axes="xyz")
        y = Output("1", "y", axes="xyz")

        def equations(self, x, u, p):
            a = ca.SX(3, 1)
            a[1] = p.rate
            return {"a": a, "b": ca.SX(3, 1)}, {"y": ca.vertcat(0, 0, x.a[1])}

    plant = running(Sparse, a_start=(1.0, 2.0, 3.0), b_start=(4.0, 5.0, 6.0))
    plant.advance(0.0, 0.5)
    assert (plant.get("a"), plant.get("b"), plant.get("y")) == (
        pytest.approx([1.0, 3.0, 3.0], rel=1e-14),
        [4.0, 5.0, 6.0],
        pytest.approx([0.0, 0.0, 3.0], rel=1e-14),
    )
    assert plant.derivatives(np.zeros(6)).tolist() == [0, 2, 0, 0, 0, 0]
    point = plant.linearise(np.zeros(6))
    assert (point.A.shape, point.B.shape, point.C.shape) == ((6, 6), (6, 0), (3, 6))
    assert (point.C[2, 1], np.count_nonzero(point.A), np.count_nonzero(point.C)) == (1.0, 0, 1)


# ---------------------------------------------------------------------- reference

METHODS = ["RK23", "RK45", "DOP853", "Radau", "BDF"]
# Measured errors of each at the tolerances below, times about five.
TOLERANCE = {
    "RK23": 3e-7,
    "RK45": 3e-8,
    "DOP853": 1e-9,
    "Radau": 2e-10,
    "BDF": 1e-6,
    "CVODES": 1e-6,
}


@pytest.mark.parametrize("method", [*METHODS, "CVODES"])
def test_reference_follows_the_closed_form(method: str) -> None:
    t = np.linspace(0.0, 4.0, 17)
    got = Logistic("plant").reference(t, method=method, rtol=1e-8, atol=1e-10)
    exact = np.array([logistic(time) for time in t])
    np.testing.assert_allclose(got["x"], exact, rtol=0, atol=TOLERANCE[method])
    assert (got.t.tolist(), got.x.shape, got.x_names) == (t.tolist(), (17, 1), ("x",))


class Cart(Plant):
    """v' = a, x' = v."""

    a = Input("m/s2", "acceleration")
    x = State("m", "place")
    v = State("m/s", "speed")

    def equations(self, x, u, p):
        return {"x": x.v, "v": u.a}, {}


BREAKS = (0.1, 1 / 3, math.sqrt(0.5), 0.9)
PUSHES = (0.0, 7.0, -11.0, 0.0, 4.0)


def pushed(t: float) -> tuple[float, float]:
    """Place and speed after pushes that jump at the breaks."""
    x = v = 0.0
    for a, b, push in zip((0.0, *BREAKS), (*BREAKS, 2.0), PUSHES, strict=True):
        h = min(max(t - a, 0.0), b - a)
        x, v = x + v * h + push * h**2 / 2, v + push * h
    return x, v


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("atol", [1e-3, 1e-9])
def test_jumps_at_breaks_are_reproduced_exactly(method: str, atol: float) -> None:
    """Between breaks speed is linear and place a parabola: exact whatever the tolerance.

    For BDF, which starts at order one, that holds of the speed only.
    """

    def inputs(t, x):
        return {"a": PUSHES[sum(t >= b for b in BREAKS)]}

    def errors(breaks, rtol: float, atol: float) -> list[float]:
        t = np.array([0.0, 0.05, 0.1, 0.2, 0.5, 0.7, 0.75, 1.0])
        got = Cart("plant").reference(t, inputs, breaks, method=method, rtol=rtol, atol=atol)
        return np.abs(got.x - [pushed(time) for time in t]).max(axis=0).tolist()

    place, speed = errors(BREAKS, 1e-3, atol)
    assert speed < 1e-14
    assert place < 1e-14 if method != "BDF" else errors(BREAKS, 1e-10, 1e-12)[0] < 1e-9
    assert errors((), 1e-3, atol)[1] > 1e-3  # who does not know the breaks misses them


@pytest.mark.parametrize("method", METHODS)
def test_inputs_are_never_asked_beyond_their_piece(method: str) -> None:
    """At the end of a piece just before the break, at its start at the break."""
    asked: list[float] = []

    def inputs(t, x):
        asked.append(t)
        return {"a": 1.0 if t < 0.5 else -1.0}

    Cart("plant").reference([0.0, 1.0], inputs, [0.5], method=method)
    second = asked.index(0.5)
    assert max(asked[:second]) == np.nextafter(0.5, 0.0)
    assert min(asked[second:]) == 0.5
    assert max(asked) == np.nextafter(1.0, 0.0)


def test_breaks_outside_the_span_or_at_its_ends_change_nothing() -> None:
    t = np.linspace(1.0, 2.0, 5)

    def inputs(t, x):
        return {"a": math.sin(t)}

    plain = Cart("plant").reference(t, inputs)
    with_breaks = Cart("plant").reference(t, inputs, [-1.0, 0.5, 1.0, 2.0, 3.0])
    assert plain.x.tolist() == with_breaks.x.tolist()


def test_inputs_may_depend_on_the_state() -> None:
    """A load that follows the plant: the closed loop is linear, so expm has the answer."""
    gain = np.array([[-30.0, 5.0, -2.0, 1.0], [0.0, -10.0, 0.5, -3.0]])

    def load(t, x):
        assert (x.place.shape, x.speed.shape) == ((2,), (2,))
        return {"force": gain @ np.concatenate([x.place, x.speed])}

    plant = Oscillator("plant")
    plant.set("place_start", (0.2, -0.1))
    plant.set("gust", 1.5)  # not named by load: stays
    t = np.linspace(0.0, 3.0, 7)
    got = plant.reference(t, load)
    closed = A + B[:, :2] @ gain
    rest = np.linalg.solve(closed, -B[:, 2] * 1.5)
    x0 = np.array([0.2, -0.1, 0.0, 0.0])
    exact = np.array([rest + linalg.expm(closed * time) @ (x0 - rest) for time in t])
    np.testing.assert_allclose(got.x, exact, rtol=0, atol=1e-9)
    assert got["speed.b"].tolist() == got.x[:, 3].tolist()


@pytest.mark.slow
def test_reference_agrees_with_scipys_solve_ivp() -> None:
    plant = Pendulum("plant")
    plant.set("theta_start", 2.5)
    t = np.linspace(0.0, 10.0, 21)

    def slope(t, x):
        push = 3.0 * math.sin(2 * t) - 0.3 * x[1] - 2.0 * 9.81 * 1.5 * math.sin(x[0])
        return [x[1], push / (2.0 * 1.5**2)]

    expected = integrate.solve_ivp(slope, (0, 10), [2.5, 0.0], "Radau", t, rtol=1e-11, atol=1e-13)
    got = plant.reference(t, lambda t, x: {"torque": 3.0 * math.sin(2 * t)}, rtol=1e-12)
    np.testing.assert_allclose(got.x, expected.y.T, rtol=0, atol=2e-9)


def test_sundials_takes_inputs_as_expressions_with_jumps_between_pieces() -> None:
    def push(t, x):
        return {"a": ca.if_else(t < 0.5, 7.0, -11.0)}

    t = [0.0, 0.25, 0.5, 1.0]
    got = Cart("plant").reference(t, push, [0.5], method="CVODES", rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(got["v"], [0.0, 1.75, 3.5, -2.0], rtol=0, atol=1e-9)
    plant = Pendulum("plant")
    plant.set("theta_start", 2.5)
    exact = plant.reference(np.linspace(0, 10, 21), lambda t, x: {"torque": 3.0 * np.sin(2 * t)})
    got = plant.reference(
        np.linspace(0, 10, 21), lambda t, x: {"torque": 3.0 * ca.sin(2 * t)}, method="CVODES"
    )
    np.testing.assert_allclose(got.x, exact.x, rtol=0, atol=1e-6)
    with pytest.raises(InputError, match="inputs that are expressions of CasADi"):
        plant.reference([0, 1], lambda t, x: {"torque": 1.0 if t < 1 else 2.0}, method="CVODES")
    with pytest.raises(InputError, match="unknown input 'lift'"):
        plant.reference([0.0, 1.0], lambda t, x: {"lift": 1.0}, method="CVODES")


def test_reference_leaves_the_running_plant_alone() -> None:
    plant, other = running(Pendulum, theta_start=1.0), running(Pendulum, theta_start=1.0)
    for k in range(10):
        plant.reference([0.0, 0.5], lambda t, x: {"torque": 9.0})
        plant.linearise(np.ones(2), np.ones(1))
        plant.trim(np.zeros(2))
        assert drive(plant, k, k + 1) == drive(other, k, k + 1)


def test_an_integration_that_cannot_go_on_says_where() -> None:
    plant = Logistic("plant")
    plant.set("x_start", -0.1)
    with pytest.raises(ArithmeticError, match=r"integration stopped at t = 1\.7[0-9]*: "):
        plant.reference([0.0, 3.0])  # the solution has a pole at log(31) / 2 = 1.717


@pytest.mark.parametrize(("name", "hint"), [("forec", "did you mean 'force'"), ("mass", "known: force, gust"), ("place", "unknown input 'place'")])  # fmt: skip
def test_reference_takes_inputs_only(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=hint):
        Oscillator("plant").reference([0.0, 1.0], lambda t, x: {name: 1.0})


# ---------------------------------------------------------------------- linearisation and trim


def test_linearisation_of_a_linear_plant_is_itself() -> None:
    plant = Oscillator("plant")
    point = plant.linearise(np.random.default_rng(2).normal(size=4), np.ones(3))
    np.testing.assert_allclose(point.A, A, rtol=1e-15, atol=0)
    np.testing.assert_allclose(point.B, B, rtol=1e-15, atol=0)
    np.testing.assert_allclose(point.C, np.vstack([[40.0, 0, 0, 0], A[2:]]), rtol=1e-15)
    np.testing.assert_allclose(point.D, np.vstack([[0, 0, 0], B[2:]]), rtol=1e-15)
    assert point.x_names == ("place.a", "place.b", "speed.a", "speed.b")
    assert point.u_names == ("force.a", "force.b", "gust")
    assert point.y_names == ("spring", "acceleration.a", "acceleration.b")


@pytest.mark.parametrize(("theta", "omega", "torque"), [(0, 0, 0), (1.2, -3, 7), (math.pi, 1, -2)])
def test_linearisation_of_the_pendulum(theta: float, omega: float, torque: float) -> None:
    plant = Pendulum("plant")
    point = plant.linearise(np.array([theta, omega]), np.array([torque]))
    J = 2.0 * 1.5**2
    stiffness = -2.0 * 9.81 * 1.5 * math.cos(theta) / J
    np.testing.assert_allclose(point.A, [[0, 1], [stiffness, -0.3 / J]], rtol=1e-14)
    np.testing.assert_allclose(point.B, [[0], [1 / J]], rtol=1e-15)
    np.testing.assert_allclose(
        point.C, [[1.5 * math.cos(theta), 0], [-1.5 * math.sin(theta), 0], [0, torque]], rtol=1e-14
    )
    np.testing.assert_array_equal(point.D, [[0], [0], [omega]])


def test_linearisation_uses_the_inputs_that_are_set() -> None:
    plant = Pendulum("plant")
    plant.set("torque", 5.0)
    assert plant.linearise(np.zeros(2)).C[2, 1] == 5.0
    assert plant.derivatives(np.zeros(2))[1] == 5.0 / (2.0 * 1.5**2)


@pytest.mark.parametrize("torque", [0.0, 10.0, -25.0])
def test_trim_of_the_pendulum(torque: float) -> None:
    """sin(theta) = torque / (m g l): one below the horizontal, one above."""
    plant = Pendulum("plant")
    angle = math.asin(torque / (2.0 * 9.81 * 1.5))
    low = plant.trim(np.array([0.2, 0.5]), np.array([torque]))
    high = plant.trim(np.array([math.pi - 0.3 - angle, 0.1]), np.array([torque]))
    np.testing.assert_allclose(low, [angle, 0.0], atol=1e-12)
    np.testing.assert_allclose(high, [math.pi - angle, 0.0], atol=1e-12)
    plant.set("torque", torque)
    np.testing.assert_allclose(plant.trim(np.zeros(2)), low, atol=1e-12)


def test_trim_with_an_angle_that_is_held() -> None:
    plant = Pendulum("plant")
    torque = np.array([2.0 * 9.81 * 1.5 * math.sin(0.4)])
    guess = np.array([0.4, 3.0])
    got = plant.trim(guess, torque, hold=["theta"])
    assert got[0] == 0.4
    assert got[1] == pytest.approx(0.0, abs=1e-12)
    assert guess.tolist() == [0.4, 3.0]
    with pytest.raises(ArithmeticError, match="no trim found"):
        plant.trim(np.array([0.5, 0.0]), torque, hold=["theta"])


def test_trim_that_does_not_exist() -> None:
    plant = Pendulum("plant")
    too_much = np.array([2.0 * 9.81 * 1.5 * 1.01])
    with pytest.raises(ArithmeticError, match=r"no trim found: largest \|dx/dt\| is "):
        plant.trim(np.zeros(2), too_much)


def test_trim_holds_whole_ports_and_refuses_what_it_does_not_know() -> None:
    """Both masses held where a load keeps them: only the speeds are found."""
    plant = Oscillator("plant")
    place = np.array([0.1, 0.3])
    u = np.array([*(K @ place), 0.0])
    for hold in (["place"], ["place.a", "place.b"]):
        got = plant.trim(np.array([*place, 1.0, -1.0]), u, hold=hold)
        np.testing.assert_allclose(got, [*place, 0.0, 0.0], atol=1e-12)
        assert got[:2].tolist() == place.tolist()
    with pytest.raises(ArithmeticError, match="no trim found"):
        plant.trim(np.array([*place, 1.0, -1.0]), u * 1.1, hold=["place"])
    for name in ("palce", "place.c", "force"):
        with pytest.raises(InputError, match=f"plant: unknown state '{name}'"):
            plant.trim(np.zeros(4), u, hold=[name])


def test_trim_with_everything_held_only_checks() -> None:
    plant = Pendulum("plant")
    assert plant.trim(np.zeros(2), hold=["theta", "omega"]).tolist() == [0.0, 0.0]
    with pytest.raises(ArithmeticError, match="no trim found"):
        plant.trim(np.ones(2), hold=["theta", "omega"])
