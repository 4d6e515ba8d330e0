"""The algorithms against closed forms: delays, orders of convergence, divergence, discards."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.errors import InputError, SimulationError
from seatrial.sim import rollback
from seatrial.sim.master import Master

from .conftest import Bench, value

TWO_BODIES = """
hull      = { fmu = "bodies.py:Body", set = { max_step = "1 ms" } }
appendage = { fmu = "bodies.py:Appendage", set = { max_step = "1 ms" } }
"""
BODY_CONNECTIONS = """
"hull.x" = "appendage.x_hull"
"hull.v" = "appendage.v_hull"
"appendage.force" = "hull.force"
"""


def top(algorithm: str, step: float = 0.1, more: str = "") -> str:
    return f'step = "{step!r} s"\nalgorithm = "{algorithm}"\n{more}'


def exact_two_bodies(t: float) -> float:
    """Position of the hull: 100 kg with 8 kg on a spring and damper, matrix exponential."""
    M, m, k, c, d = 100.0, 8.0, 400.0, 12.0, 30.0
    A = np.array(
        [
            [0, 1, 0, 0],
            [-k / M, -(c + d) / M, k / M, c / M],
            [0, 0, 0, 1],
            [k / m, c / m, -k / m, -c / m],
        ]
    )
    return float((expm(A * t) @ [1.0, 0.0, 0.0, 0.0])[0])


def errors(bench: Bench, algorithm: str, more: str = "") -> list[float]:
    """Error of the hull's position at 2 s for steps of 40, 20, 10, 5 ms."""
    found = []
    for step in (0.04, 0.02, 0.01, 0.005):
        master = bench.master(TWO_BODIES, BODY_CONNECTIONS, top=top(algorithm, step, more))
        for _ in range(round(2.0 / step)):
            master.step()
        found.append(abs(value(master, "hull.x") - exact_two_bodies(2.0)))
    return found


@pytest.mark.parametrize(
    ("algorithm", "more", "order"),
    [
        ("plain-jacobi", "", 1.0),
        ("jacobi", "", 1.0),
        ("gauss-seidel", "", 1.0),
        ("extrapolated", "", 2.0),
        ("iterated", "iteration = { count = 2, tolerance = 1e-12 }", 2.0),
        pytest.param(
            "iterated",
            "iteration = { count = 4, tolerance = 1e-12 }",
            2.0,
            marks=pytest.mark.interop,
        ),
    ],
)
def test_orders_of_convergence_on_two_bodies(
    direct: Bench, algorithm: str, more: str, order: float
) -> None:
    found = errors(direct, algorithm, more)
    observed = [math.log2(a / b) for a, b in itertools.pairwise(found)]
    assert observed[-1] == pytest.approx(order, abs=0.05)
    assert observed == pytest.approx([order] * 3, abs=0.25)


@pytest.mark.interop
def test_second_order_is_worth_it(direct: Bench) -> None:
    """At 10 ms extrapolation is some fifty times better than held inputs, iteration more."""
    held = errors(direct, "jacobi")[2]
    assert errors(direct, "extrapolated")[2] < held / 20
    iterated = errors(direct, "iterated", "iteration = { count = 2, tolerance = 1e-12 }")[2]
    assert iterated < held / 100


@pytest.mark.parametrize(
    ("algorithm", "order", "exact"),
    [
        ("jacobi", 1.0, lambda h, n: (1 - h) ** n),
        ("plain-jacobi", 1.0, lambda h, n: (1 - h) ** n),
        ("gauss-seidel", 1.0, lambda h, n: (1 - h) ** n),
        # x+ = x - h (3 x - x before) / 2 after a first held step: Adams-Bashforth
        ("extrapolated", 2.0, None),
        # trapezoidal rule, once it has settled
        ("iterated", 2.0, lambda h, n: ((1 - h / 2) / (1 + h / 2)) ** n),
    ],
)
def test_dahlquist(direct: Bench, algorithm: str, order: float, exact) -> None:
    """x' = -x through a connection from its own output to its own input."""
    more = "iteration = { count = 60, tolerance = 1e-15 }" if algorithm == "iterated" else ""
    found = []
    for n in (50, 100):
        h = 1.0 / n
        master = direct.master(
            'decay = { fmu = "bodies.py:Decay" }',
            '"decay.x" = "decay.u"',
            top=top(algorithm, h, more),
        )
        for _ in range(n):
            master.step()
        found.append(value(master, "decay.x"))
        if exact is not None:
            assert found[-1] == pytest.approx(exact(h, n), rel=1e-12)
    observed = math.log2(abs(found[0] - math.exp(-1)) / abs(found[1] - math.exp(-1)))
    assert observed == pytest.approx(order, abs=0.05)


ADDERS = 'a0 = { fmu = "bodies.py:Counter" }\n' + "\n".join(
    f'a{i} = {{ fmu = "bodies.py:StepAdd" }}' for i in range(9, 0, -1)
)
ADDER_CONNECTIONS = "\n".join(f'"a{i - 1}.y" = "a{i}.u"' for i in range(1, 10))


@pytest.mark.parametrize(
    ("algorithm", "delay"), [("jacobi", 1), ("plain-jacobi", 1), ("gauss-seidel", 0)]
)
def test_adder_chain_delays_each_hop_by_a_step_or_not_at_all(
    bench: Bench, algorithm: str, delay: int
) -> None:
    """Ten components that add in their steps, declared back to front."""
    master = bench.master(ADDERS, ADDER_CONNECTIONS, top=top(algorithm))
    for _ in range(20):
        master.step()
    for i in range(10):
        assert value(master, f"a{i}.y") == 20 - i * delay + i


def test_gauss_seidel_steps_a_slow_component_when_its_interval_ends(bench: Bench) -> None:
    master = bench.master(
        'slow = { fmu = "bodies.py:StepAdd", step = "500 ms" }\ncount = { fmu = "bodies.py:Counter" }',
        '"count.y" = "slow.u"',
        top=top("gauss-seidel"),
    )
    seen = []
    for _ in range(11):
        master.step()
        seen.append(value(master, "slow.y"))
    assert seen == [0.0] * 4 + [6.0] * 5 + [11.0] * 2


def test_sampled_signals_are_not_extrapolated(bench: Bench) -> None:
    """What a sampled component reads and gives is held; a continuous input is carried on."""
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nclock = { fmu = "users.py:Clock", set = { period = 0.1 } }\n'
        'through = { fmu = "users.py:Sum" }\nsampled = { fmu = "users.py:Sum" }',
        '"ramp.y" = ["clock.u", "through.u"]\n"clock.y" = "sampled.u"',
        top=top("extrapolated"),
    )
    for _ in range(10):
        master.step()
    assert value(master, "clock.y") == 1.0
    assert value(master, "sampled.x") == pytest.approx(0.1 * 4.5, abs=1e-12)
    # A ramp is extrapolated exactly from the second step on; the first one holds zero.
    assert value(master, "through.x") == pytest.approx(0.5 - 0.005, abs=1e-12)


def test_an_override_is_not_extrapolated(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nsum = { fmu = "users.py:Sum" }',
        '"ramp.y" = "sum.u"',
        top=top("extrapolated"),
    )
    for _ in range(3):
        master.step()
    before = value(master, "sum.x")
    master.override("ramp", "y", 50.0)
    master.step()
    master.step()
    assert value(master, "sum.x") == pytest.approx(before + 2 * 0.1 * 50.0, abs=1e-12)


# ---------------------------------------------------------------------- divergence


def added_mass(bench: Bench, ratio: float, top_lines: str, kinds: str = "Rigid AddedMass"):
    body, water = kinds.split()
    return bench.master(
        f'body = {{ fmu = "bodies.py:{body}" }}\n'
        f'water = {{ fmu = "bodies.py:{water}", set = {{ mass = {ratio} }} }}',
        '"body.a" = "water.a"\n"water.force" = "body.force"',
        top=top_lines,
    )


@pytest.mark.parametrize("algorithm", ["jacobi", "plain-jacobi", "gauss-seidel"])
def test_added_mass_beyond_the_mass_diverges_with_a_name(bench: Bench, algorithm: str) -> None:
    master = added_mass(bench, 1.5, top(algorithm))
    with pytest.raises(
        SimulationError,
        match=r"diverges at t = .* the connection (body\.a -> water\.a|water\.force -> body\.force)",
    ):
        for _ in range(1000):
            master.step()
    calm = added_mass(bench, 0.5, top(algorithm))
    for _ in range(200):
        calm.step()
    assert value(calm, "body.a") == pytest.approx(1 / 1.5, rel=1e-9)


def test_jumps_of_a_value_that_is_held_for_steps_are_no_divergence(direct: Bench) -> None:
    """Whatever a controller asks every seven steps, the exchange between steps does not swing."""
    master = direct.master(
        'jumps = { fmu = "bodies.py:Jumps", set = { period = 0.7 } }\n'
        'water = { fmu = "bodies.py:Water" }\nbody = { fmu = "bodies.py:Rigid" }',
        '"jumps.y" = "water.a"\n"water.force" = "body.force"',
    )
    for _ in range(150):
        master.step()
    assert value(master, "jumps.y") == pytest.approx(-1e9)


@pytest.mark.parametrize("slow", ["body", "water"])
@pytest.mark.parametrize("algorithm", ["jacobi", "plain-jacobi", "gauss-seidel", "extrapolated"])
def test_a_slow_component_diverges_with_a_name_too(
    direct: Bench, algorithm: str, slow: str
) -> None:
    """Its values change every five steps only; 1.2^200 is no quantity, but not beyond 1e20 either."""
    step = {name: ', step = "500 ms"' if name == slow else "" for name in ("body", "water")}
    master = direct.master(
        f'body = {{ fmu = "bodies.py:Rigid"{step["body"]} }}\n'
        f'water = {{ fmu = "bodies.py:AddedMass", set = {{ mass = 1.2 }}{step["water"]} }}',
        '"body.a" = "water.a"\n"water.force" = "body.force"',
        top=top(algorithm),
    )
    with pytest.raises(
        SimulationError, match=r"diverges at t = .* the connection .* swings from step"
    ):
        for _ in range(1000):
            master.step()


PHASES = 12


@pytest.mark.interop
@pytest.mark.parametrize(
    "period", [8.0, *(pytest.param(p, marks=pytest.mark.interop) for p in (16.0, 20.0, 32.0))]
)
def test_growing_oscillations_that_a_step_resolves_are_no_divergence(
    direct: Bench, period: float
) -> None:
    """Also if each block of steps begins at the same phase, whichever it is."""
    for phase in range(PHASES):
        master = direct.master(
            f'wave = {{ fmu = "bodies.py:Wave", set = {{ period = {period}, '
            f'phase = {phase * math.tau / PHASES}, growth = 0.1 }} }}\nsum = {{ fmu = "users.py:Sum" }}',
            '"wave.y" = "sum.u"',
        )
        for _ in range(150):
            master.step()


@pytest.mark.interop
def test_noise_that_is_switched_on_is_no_divergence(direct: Bench) -> None:
    for seed in range(20):
        master = direct.master(
            f'noise = {{ fmu = "bodies.py:Switched", set = {{ seed = {float(seed)} }} }}\n'
            'sum = { fmu = "users.py:Sum" }',
            '"noise.y" = "sum.u"',
        )
        for _ in range(100):
            master.step()


def test_iteration_sees_its_contraction_factor(bench: Bench) -> None:
    # Each pass multiplies the change by sqrt(m_a / M) / 2: inputs held are means of both ends.
    settings = "iteration = { count = 100, tolerance = 1e-10 }"
    with pytest.raises(
        SimulationError,
        match=r"iteration diverges at t = 0\.1 s on the connection .* contraction factor is",
    ):
        added_mass(bench, 8.0, top("iterated", more=settings)).step()
    master = added_mass(bench, 0.95, top("iterated", more=settings))
    for _ in range(5):
        master.step()
    relaxed = "iteration = { count = 200, tolerance = 1e-10, relaxation = 0.3 }"
    calm = added_mass(bench, 8.0, top("iterated", more=relaxed))
    for _ in range(5):
        calm.step()


def test_added_mass_at_once_is_solved_with_relaxation_or_refused(bench: Bench) -> None:
    for ratio in (0.5, 1.05, 5.0):
        master = added_mass(bench, ratio, top("jacobi"), "Accelerated Water")
        assert value(master, "body.a") == pytest.approx(1 / (1 + ratio), rel=1e-10)
        master.step()
        assert value(master, "body.a") == pytest.approx(1 / (1 + ratio), rel=1e-10)
    with pytest.raises(
        SimulationError, match=r"loop through .*body\.a.* does not settle: each repetition"
    ):
        added_mass(bench, -1.0, top("jacobi"), "Accelerated Water")


def test_a_signal_beyond_a_thousand_nominals_is_named(bench: Bench) -> None:
    master = bench.master('a = { fmu = "bodies.py:Nominal" }', '"a.y" = "a.u"')
    with pytest.raises(
        SimulationError,
        match=r"the connection a\.y -> a\.u carries 2048, more than 1000 times its nominal value 2",
    ):
        for _ in range(20):
            master.step()
    assert master.steps == 10


# ---------------------------------------------------------------------- discarded steps

COARSE = 'ramp = { fmu = "users.py:Ramp" }\ncoarse = { fmu = "bodies.py:Coarse" }'


@pytest.mark.parametrize(
    "algorithm", ["jacobi", "plain-jacobi", "gauss-seidel", "extrapolated", "iterated"]
)
def test_a_discarded_step_is_taken_in_smaller_ones(bench: Bench, algorithm: str) -> None:
    master = bench.master(COARSE, '"ramp.y" = "coarse.u"', top=top(algorithm))
    for _ in range(10):
        master.step()
    assert master.time == 1.0
    # Four whole steps, then six in quarters: Coarse takes at most 30 ms.
    assert value(master, "coarse.taken") == 4 + 6 * 4
    assert value(master, "ramp.y") == 1.0
    assert "6 of 10 steps were discarded" in master.notes()[0]
    if algorithm == "jacobi":
        whole = 0.1 * sum(k / 10 for k in range(4))
        quarters = 0.025 * sum(0.4 + k / 40 for k in range(24))
        assert value(master, "coarse.x") == pytest.approx(whole + quarters, abs=1e-12)


@pytest.mark.interop
@pytest.mark.parametrize(
    ("algorithm", "more"),
    [
        ("jacobi", ""),
        ("plain-jacobi", ""),
        ("gauss-seidel", ""),
        ("extrapolated", ""),
        ("iterated", "iteration = { count = 1, tolerance = 1e-15 }"),
    ],
)
def test_what_comes_out_does_not_depend_on_where_the_states_were_saved(
    direct: Bench, monkeypatch: pytest.MonkeyPatch, algorithm: str, more: str
) -> None:
    """Every signal and note, at every step, of two bodies beside a component that discards."""
    components = TWO_BODIES + COARSE.replace(
        'bodies.py:Coarse" }', 'bodies.py:Coarse", set = { after = "0.3 s", limit = "6 ms" } }'
    )
    seen = []
    for between in (1, 7, 250):
        monkeypatch.setattr(rollback, "_STEPS_BETWEEN", between)
        master = direct.master(
            components, BODY_CONNECTIONS + '"ramp.y" = "coarse.u"', top=top(algorithm, 0.01, more)
        )
        rows = []
        for _ in range(40):
            master.step()
            rows.append(list(master.signals))
        seen.append((rows, master.notes()))
    assert seen[0] == seen[1] == seen[2]
    assert "10 of 40 steps were discarded" in seen[0][1][0]


def test_a_late_discard_runs_the_steps_before_again(bench: Bench) -> None:
    """Checkpoints are far apart; what comes out must not depend on them."""
    components = COARSE.replace(
        'bodies.py:Coarse" }', 'bodies.py:Coarse", set = { after = "6.15 s", limit = "6 ms" } }'
    )
    master = bench.master(components, '"ramp.y" = "coarse.u"', top=top("jacobi", 0.01))
    for k in range(620):
        if k == 300:
            master.override("ramp", "y", 1.0)
        if k == 310:
            master.release("ramp", "y")
        master.step()
    held = [1.0 if 300 <= k < 310 else k / 100 for k in range(615)]
    halves = [6.15 + k / 200 for k in range(10)]
    expected = 0.01 * sum(held) + 0.005 * sum(halves)
    assert value(master, "coarse.x") == pytest.approx(expected, abs=1e-9)
    assert value(master, "coarse.taken") == 615 + 10


def test_a_step_that_no_size_helps_ends_the_run(bench: Bench) -> None:
    master = bench.master('coarse = { fmu = "bodies.py:Coarse", set = { limit = 0.0 } }')
    for _ in range(4):
        master.step()
    with pytest.raises(
        SimulationError, match=r"(?s)coarse: .*is too long.*in steps down to 0\.0015625 s"
    ):
        master.step()


@pytest.mark.parametrize(
    ("other", "why"),
    [
        ('{ fmu = "bodies.py:Stubborn" }', "other cannot save and restore its state"),
        ('{ fmu = "bodies.py:Opaque" }', "other"),
        ('{ fmu = "users.py:Ramp", step = "200 ms" }', "other has a step of its own"),
    ],
)
def test_a_discarded_step_ends_the_run_if_somebody_cannot_roll_back(
    bench: Bench, other: str, why: str
) -> None:
    master = bench.master(f'coarse = {{ fmu = "bodies.py:Coarse" }}\nother = {other}')
    for _ in range(4):
        master.step()
    with pytest.raises(
        SimulationError, match=rf"(?s)is too long.*not tried in smaller steps: .*{why}"
    ):
        master.step()


@pytest.mark.parametrize(
    ("other", "why"),
    [
        ('{ fmu = "bodies.py:Stubborn" }', "other cannot save and restore its state"),
        ('{ fmu = "users.py:Ramp", step = "200 ms" }', "other has a step of its own"),
    ],
)
def test_iteration_refuses_who_cannot_take_part(bench: Bench, other: str, why: str) -> None:
    with pytest.raises(InputError, match=rf'algorithm = "iterated": {why}'):
        bench.master(f"other = {other}", top=top("iterated"))


def test_steps_that_do_not_settle_are_noted(bench: Bench) -> None:
    settings = "iteration = { count = 1, tolerance = 1e-12 }"
    master = bench.master(TWO_BODIES, BODY_CONNECTIONS, top=top("iterated", 0.04, settings))
    for _ in range(10):
        master.step()
    assert master.notes() == [
        "10 of 10 steps ended after the last repetition with changes above the tolerance of the iteration"
    ]


# ---------------------------------------------------------------------- loops of feed-through


def ring(gain: float, count: int, turn: int, kind: str = "users.py:Scale") -> tuple[str, str]:
    """A loop of equal gains around which a signal is multiplied by ``gain``; bias 1 in the first."""
    each = abs(gain) ** (1 / count)
    lines = [
        f'c{i} = {{ fmu = "{kind}", set = {{ gain = {math.copysign(each, gain) if i == 0 else each!r}, '
        f"bias = {float(i == 0)} }} }}"
        for i in range(count)
    ]
    connections = "\n".join(f'"c{i}.y" = "c{(i + 1) % count}.u"' for i in range(count))
    return "\n".join(lines[::turn]), connections


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    "count", [1, 2, *(pytest.param(n, marks=pytest.mark.interop) for n in (6, 20))]
)
@pytest.mark.parametrize("gain", [0.5, 0.9, 0.99, -0.5, -0.95, -1.05, -5.0, -25.0, 3.0])
def test_a_loop_settles_whatever_its_gain_and_order_of_declaration(
    direct: Bench, gain: float, count: int, turn: int
) -> None:
    """y = gain y + 1 around the loop."""
    master = Master(direct.system(*ring(gain, count, turn)))
    master.initialise()
    assert value(master, "c0.y") == pytest.approx(1 / (1 - gain), rel=1e-9)
    master.step()
    assert value(master, "c0.y") == pytest.approx(1 / (1 - gain), rel=1e-9)


def test_a_loop_of_vectors_settles(direct: Bench) -> None:
    """Two loops that share components, strongly coupled: a = 0.9 b + 1, b = 0.9 c, c = a - 3 b / 10."""
    master = Master(
        direct.system(
            'a = { fmu = "bodies.py:Blend", set = { bias = 1.0, first = 0.9, second = 0.0 } }\n'
            'b = { fmu = "bodies.py:Blend", set = { bias = 0.0, first = 0.9, second = 0.0 } }\n'
            'c = { fmu = "bodies.py:Blend", set = { bias = 0.0, first = 1.2, second = -0.3 } }',
            '"b.y" = ["a.u", "c.w"]\n"c.y" = "b.u"\n"a.y" = "c.u"',
        )
    )
    master.initialise()
    matrix = np.array([[1, -0.9, 0], [0, 1, -0.9], [-1.2, 0.3, 1]])
    exact = np.linalg.solve(matrix, [1.0, 0.0, 0.0])
    assert [value(master, f"{n}.y") for n in "abc"] == pytest.approx(list(exact), rel=1e-9)


LOOPS = '''

class Square(Component):
    """y = u^2 + c, at once."""

    c = Parameter(0.0, "m", "c")
    u = Input("m", "input")
    y = Output("m", "output")
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = self.u * self.u + self.c


class Flip(Component):
    """The other one, at once."""

    u = Input("1", "input", type=bool)
    y = Output("1", "output", type=bool)
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = not self.u


class Next(Component):
    """One more, at once."""

    u = Input("1", "input", type=int)
    y = Output("1", "output", type=int)
    feedthrough = {"y": ("u",)}

    def outputs(self, t):
        self.y = self.u + 1
'''


@pytest.mark.parametrize(
    ("kind", "given"),
    [("Square", "c = 1.0"), ("Blend", "first = 1.0, bias = 1.0"), ("Flip", ""), ("Next", "")],
)
def test_a_loop_without_a_solution_is_named(bench: Bench, kind: str, given: str) -> None:
    """x = x^2 + 1, x = x + 1, x = not x, n = n + 1."""
    with (bench.folder / "bodies.py").open("a", encoding="utf-8") as file:
        file.write(LOOPS)
    parts = f'a = {{ fmu = "bodies.py:{kind}", set = {{ {given} }} }}'
    with pytest.raises(SimulationError, match=r"the loop through a\.y does not settle"):
        bench.master(parts, '"a.y" = "a.u"')


def test_one_of_two_solutions_is_one(bench: Bench) -> None:
    """x = x^2 - 6 has -2 and 3, and iteration is repelled by both."""
    with (bench.folder / "bodies.py").open("a", encoding="utf-8") as file:
        file.write(LOOPS)
    parts = 'a = { fmu = "bodies.py:Square", set = { c = -6.0 } }'
    found = value(bench.master(parts, '"a.y" = "a.u"'), "a.y")
    assert min(abs(found + 2.0), abs(found - 3.0)) < 1e-10


def test_coupled_loops_that_repel_settle(bench: Bench) -> None:
    """a = 2 a + 3 b + 1, b = 2 b - 4 a + 2: eigenvalues 2 +- 3.46 i."""
    part = '{{ fmu = "bodies.py:Blend", set = {{ first = {}, second = {}, bias = {} }} }}'
    parts = f"a = {part.format(2.0, 3.0, 1.0)}\nb = {part.format(-4.0, 2.0, 2.0)}"
    master = bench.master(parts, '"a.y" = ["a.u", "b.u"]\n"b.y" = ["a.w", "b.w"]')
    exact = np.linalg.solve([[-1.0, -3.0], [4.0, -1.0]], [1.0, 2.0])
    assert [value(master, f"{n}.y") for n in "ab"] == pytest.approx(list(exact), abs=1e-10)


def test_nominal_values_do_not_stop_an_iteration_that_relaxation_saves(direct: Bench) -> None:
    """On its way without relaxation a = 1 - 25 a goes beyond 1000 times the nominal value 1."""
    master = Master(direct.system(*ring(-25.0, 2, 1, "bodies.py:Usual")))
    master.initialise()
    assert value(master, "c0.y") == pytest.approx(1 / 26, rel=1e-9)
