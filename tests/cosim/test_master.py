"""The master against closed forms: delays, loops, rates, units, overrides."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.model.faults.operators import Bias, Operator
from seatrial.sim.compiled.rows import Rows
from seatrial.sim.fault_schedule import Fault
from seatrial.sim.injected import Acting

from .conftest import Bench, value

LENGTH = 10
ADDERS = 'ramp = { fmu = "users.py:Ramp" }\n' + "\n".join(
    f'a{i} = {{ fmu = "users.py:Add" }}' for i in range(LENGTH)
)
# Declared back to front: the order of the file must not matter.
CHAINED = "\n".join(
    f'"{"ramp.y" if i == 0 else f"a{i - 1}.y"}" = "a{i}.u"' for i in reversed(range(LENGTH))
)


def test_feedthrough_adds_no_delay(bench: Bench) -> None:
    master = bench.master(ADDERS, CHAINED)
    for k in range(20):
        assert value(master, f"a{LENGTH - 1}.y") == k / 10 + LENGTH
        master.step()


def test_plain_jacobi_delays_each_hop_by_one_step(bench: Bench) -> None:
    top = 'step = "100 ms"\nalgorithm = "plain-jacobi"'
    master = bench.master(ADDERS, CHAINED, top=top)
    for _ in range(30):
        master.step()
    # Hop i shows the ramp of i + 1 steps ago.
    for i in range(LENGTH):
        assert value(master, f"a{i}.y") == pytest.approx((30 - i - 1) / 10 + i + 1, abs=1e-14)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("every", [1, 4])
@pytest.mark.parametrize("names", [["ramp.y"], ["a0.y", "ramp.y"]])
def test_a_block_of_steps_leaves_the_points_in_between(
    bench: Bench, names: list[str], every: int
) -> None:
    master = bench.master(ADDERS, CHAINED)
    rows = Rows([master.names.index(tuple(name.split("."))) for name in names], every)
    own = {"ramp.y": 0.0, "a0.y": 1.0}
    # The bias of the ramp acts on its reader within the block, from 0.5 s to 1.2 s.
    bias = [("ramp", "y", Bias(10.0))]
    master.faults.add(Fault("bias", 500_000_000, 1_200_000_000, 0, lambda _: bias))
    for begun, count in ((0, 20), (20, 1), (21, 9)):
        assert master.advance(count, rows) == count
        assert master.steps == begun + count
        between = [k for k in range(begun + 1, begun + count) if k % every == 0]
        first, table = rows.taken()
        assert not between or first == between[0]
        faulty = [10.0 * (5 <= k < 12) for k in between]
        expected = [
            [k / 10 + own[name] + on for name in names]
            for k, on in zip(between, faulty, strict=True)
        ]
        np.testing.assert_allclose(table, np.reshape(expected, (-1, len(names))), atol=1e-12)
        assert not len(rows.taken()[1])


def test_a_block_ends_where_a_component_asks_for_the_end(bench: Bench) -> None:
    master = bench.master('ramp = { fmu = "users.py:Ramp" }', "")
    ramp = master.system.parts["ramp"].instance

    def ends(_: object) -> list[tuple[str, str, Operator]]:
        ramp.ended_at = 0.7
        return []

    master.faults.add(Fault("end", 700_000_000, None, 0, ends))
    assert master.advance(0) == 1
    assert master.advance(20) == 6
    assert master.ended() == ["ramp"]
    assert master.advance(20) == 1


def test_initial_loop_is_solved(bench: Bench) -> None:
    master = bench.master(
        'a = { fmu = "users.py:Scale" }\nb = { fmu = "users.py:Scale", set = { gain = -0.4 } }',
        '"a.y" = "b.u"\n"b.y" = "a.u"',
    )
    # y_a = 0.5 y_b + 1, y_b = -0.4 y_a + 1
    assert value(master, "a.y") == pytest.approx(1.25, abs=1e-11)
    assert value(master, "b.y") == pytest.approx(0.5, abs=1e-11)
    master.step()
    assert value(master, "a.y") == pytest.approx(1.25, abs=1e-11)


def test_loop_without_a_solution_names_its_connections(bench: Bench) -> None:
    with pytest.raises(SimulationError, match=r"loop through a\.y, b\.y does not settle"):
        bench.master(
            'a = { fmu = "users.py:Scale", set = { gain = 2.0, bias = 1.0 } }\n'
            'b = { fmu = "users.py:Scale", set = { gain = 0.5, bias = 1.0 } }',
            '"a.y" = "b.u"\n"b.y" = "a.u"',
        )


def test_slow_component_steps_at_its_own_rate(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nfast = { fmu = "users.py:Sum" }\n'
        'slow = { fmu = "users.py:Sum", step = "500 ms" }',
        '"ramp.y" = ["fast.u", "slow.u"]',
    )
    fast, slow = [], []
    for _ in range(20):
        master.step()
        fast.append(value(master, "fast.x"))
        slow.append(value(master, "slow.x"))
    assert fast[-1] == pytest.approx(0.1 * sum(k / 10 for k in range(20)), abs=1e-12)
    held = [0.0] * 4 + [0.0] * 5 + [0.25] * 5 + [0.75] * 5 + [1.5]
    assert slow == pytest.approx(held, abs=1e-12)


def test_a_rig_inside_has_a_step_for_its_parts(bench: Bench) -> None:
    """But for those that say one, in rigs inside it too."""
    (bench.folder / "part.toml").write_text(
        '[components]\nown = { fmu = "users.py:Ramp", step = "300 ms" }\n'
        'sum = { fmu = "users.py:Sum" }\n[shows]\nu = "sum.u"\n',
        "utf-8",
    )
    (bench.folder / "half.toml").write_text(
        '[components]\npart = { rig = "part.toml" }\n[shows]\nu = "part.u"\n', "utf-8"
    )
    parts = bench.system(
        'ramp = { fmu = "users.py:Ramp" }\nhalf = { rig = "half.toml", step = "500 ms" }\n'
        'part = { rig = "part.toml" }',
        '"ramp.y" = ["half.u", "part.u"]',
    ).parts
    every = {name: part.every for name, part in parts.items() if name.endswith("sum")}
    assert every == {"half.part.sum": 5, "part.sum": 1}


def test_a_step_of_a_rig_inside_that_does_not_fit_says_where_it_is(tmp_path: Path) -> None:
    bench = Bench(tmp_path, "direct")
    (bench.folder / "part.toml").write_text(
        '[components]\nsum = { fmu = "users.py:Sum" }\n', "utf-8"
    )
    with pytest.raises(InputError, match=r"rig\.toml: components\.half\.step: '50 ms' is not"):
        bench.system('half = { rig = "part.toml", step = "50 ms" }')


def test_sampled_component_keeps_its_own_instants(bench: Bench) -> None:
    """Period 0.15 s in steps of 0.1 s: instants between the steps see the held input."""
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nclock = { fmu = "users.py:Clock", set = { period = 0.15 } }',
        '"ramp.y" = "clock.u"',
    )
    seen = []
    for _ in range(10):
        master.step()
        seen.append((value(master, "clock.y"), value(master, "clock.k")))
    # instants 0, 0.15, 0.3, 0.45, ...: at 0.3 the fresh value, at 0.15 the one held from 0.1
    expected = [(0.0, 1), (0.1, 2), (0.3, 2), (0.3, 3), (0.4, 4), (0.6, 4), (0.6, 5), (0.7, 6), (0.9, 6), (0.9, 7)]  # fmt: skip
    assert [y for y, _ in seen] == pytest.approx([y for y, _ in expected], abs=1e-15)
    assert [k for _, k in seen] == [k for _, k in expected]


def test_units_are_converted_on_the_connection(bench: Bench) -> None:
    master = bench.master(
        'turn = { fmu = "users.py:Turn" }\nsum = { fmu = "users.py:Sum" }',
        '"turn.a" = "sum.angle"\n"turn.flag" = "sum.on"',
    )
    assert value(master, "sum.seen") == pytest.approx(math.pi / 2, rel=1e-15)
    for _ in range(9):
        master.step()
    assert value(master, "sum.seen") == pytest.approx(math.radians(99.0), rel=1e-15)
    assert value(master, "turn.flag") is True
    assert value(master, "turn.text") == 'at "0.90", é'


def test_override_and_release_of_outputs_and_inputs(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nadd = { fmu = "users.py:Add" }\nsum = { fmu = "users.py:Sum" }',
        '"ramp.y" = ["add.u", "sum.u"]',
    )
    master.override("ramp", "y", 5.0)
    assert (value(master, "ramp.y"), value(master, "add.y")) == (5.0, 6.0)
    master.step()
    assert (value(master, "ramp.y"), value(master, "sum.x")) == (5.0, 0.5)
    master.release("ramp", "y")
    assert (value(master, "ramp.y"), value(master, "add.y")) == (0.1, 1.1)
    master.override("add", "u", -1.0)
    master.step()
    assert (value(master, "ramp.y"), value(master, "add.y")) == (0.2, 0.0)
    master.release("add", "u")
    assert value(master, "add.y") == 1.2
    master.set("sum", ["rate"], [100.0])
    before = value(master, "sum.x")
    master.step()
    assert value(master, "sum.x") == pytest.approx(before + 100.0 * 0.1 * 0.2, abs=1e-12)


def test_a_bias_is_added_until_it_is_released(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nadd = { fmu = "users.py:Add" }\nsum = { fmu = "users.py:Sum" }',
        '"ramp.y" = ["add.u", "sum.u"]',
    )
    for number, (name, bias) in enumerate({"ramp.y": 5.0, "add.u": 0.25}.items()):
        component, port = name.split(".")
        master.inject(component, port, Acting(f"{number}", Bias(bias), master.time_ns))
    assert (value(master, "ramp.y"), value(master, "add.y")) == (5.0, 6.25)
    state = master.save()
    for _ in range(2):
        master.step()
    assert (value(master, "ramp.y"), value(master, "add.y")) == (5.2, 6.45)
    assert value(master, "sum.x") == pytest.approx(0.1 * (5.0 + 5.1), rel=1e-15)
    master.clear("0")
    assert (value(master, "ramp.y"), value(master, "add.y")) == (0.2, 1.45)
    master.override("add", "u", -1.0)  # after the bias
    assert value(master, "add.y") == 0.0
    master.restore(state)
    assert (value(master, "ramp.y"), value(master, "add.y")) == (5.0, 6.25)
    master.step()
    assert (value(master, "ramp.y"), value(master, "add.y")) == (5.1, 6.35)


def test_release_between_the_steps_of_a_slow_component_shows_no_future(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp", step = "500 ms" }\nadd = { fmu = "users.py:Add" }',
        '"ramp.y" = "add.u"',
    )
    for _ in range(6):
        master.step()
    master.override("ramp", "y", 7.0)
    master.step()
    assert value(master, "add.y") == 8.0
    master.release("ramp", "y")
    assert (value(master, "ramp.y"), value(master, "add.y")) == (0.5, 1.5)


@pytest.mark.parametrize("how", ["raise", "nan"])
def test_a_failing_component_ends_the_run_with_its_name(bench: Bench, how: str) -> None:
    master = bench.master(f'boat = {{ fmu = "users.py:Bad", set = {{ how = "{how}" }} }}')
    with pytest.raises(SimulationError, match="boat") as error:
        for _ in range(10):
            master.step()
    assert master.time == 0.5
    assert {"raise": "the boat has sunk", "nan": "output y is nan"}[how] in str(error.value)


@pytest.mark.parametrize("as_nan", [0, 1])
def test_a_failure_while_outputs_are_read_again_is_no_value(bench: Bench, as_nan: int) -> None:
    master = bench.master(
        f'ramp = {{ fmu = "users.py:Ramp" }}\ninverse = {{ fmu = "users.py:Inverse", set = {{ as_nan = {as_nan} }} }}',
        '"ramp.y" = "inverse.u"',
    )
    for _ in range(4):
        master.step()
    with pytest.raises(SimulationError, match="inverse") as error:
        master.step()
    assert ("nan" if as_nan else "ZeroDivisionError") in str(error.value)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("big", "2147483648"),
        ("nul", "no C text"),
        ("surrogate", "no C text"),
        ("exit", "SystemExit"),
    ],
)
def test_what_fmi_cannot_carry_fails_alike(bench: Bench, how: str, reason: str) -> None:
    master = bench.master(f'odd = {{ fmu = "users.py:Odd", set = {{ how = "{how}" }} }}')
    with pytest.raises(SimulationError, match="odd") as error:
        master.step()
    assert reason in str(error.value)


def test_an_override_is_in_the_unit_of_its_input(bench: Bench) -> None:
    master = bench.master(
        'c = { fmu = "users.py:Celsius" }\nk = { fmu = "users.py:Kelvin" }',
        '"c.y" = "k.k"\n"c.n" = "k.n"',
    )
    assert value(master, "k.z") == 293.15
    assert repr(value(master, "k.r")) == "3.0"
    master.override("k", "k", 303.15)
    assert value(master, "k.z") == 303.15
    master.release("k", "k")
    assert value(master, "k.z") == 293.15


def test_an_input_that_is_set_acts_at_once(bench: Bench) -> None:
    master = bench.master(
        'a = { fmu = "users.py:Add" }\nb = { fmu = "users.py:Add" }', '"a.y" = "b.u"'
    )
    master.set("a", ["u"], [10.0])
    assert (value(master, "a.y"), value(master, "b.y")) == (11.0, 12.0)


def test_a_tunable_parameter_takes_what_a_connection_brings(bench: Bench) -> None:
    """x' = rate u with rate = 2 t, u = t, by explicit Euler: x_n = 2 h^3 times the sum of k^2."""
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nsum = { fmu = "users.py:Sum" }',
        '"ramp.y" = ["sum.u", { to = "sum.rate", factor = 2, convert = false }]',
    )
    for n in range(20):
        squares = (n - 1) * n * (2 * n - 1) / 6
        assert value(master, "sum.x") == pytest.approx(2e-3 * squares, abs=1e-12)
        master.step()


def test_a_tunable_parameter_on_a_connection_keeps_to_its_limits(bench: Bench) -> None:
    master = bench.master(
        'ramp = { fmu = "users.py:Ramp" }\nlimited = { fmu = "users.py:Limited" }',
        '"ramp.y" = "limited.width"',
    )
    with pytest.raises(SimulationError, match=r"limited\.width is 0\.6.*at most 0\.55"):
        for _ in range(10):
            master.step()


@pytest.mark.parametrize(
    ("components", "connections", "message"),
    [
        ('a = { fmu = "users.py:Add" }', '"a.y" = "b.u"', "unknown component 'b'"),
        ('a = { fmu = "users.py:Add" }', '"a.z" = "a.u"', "unknown output 'z'"),
        (
            'a = { fmu = "users.py:Add" }',
            '"a.u" = "a.y"',
            "a.u is input, output is needed",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\ns = { fmu = "users.py:Scale" }',
            '"r.y" = { to = "s.gain", convert = false }',
            "s.gain is fixed parameter, input or tunable parameter is needed",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\ns = { fmu = "users.py:Sum" }',
            '"r.y" = "s.rat"',
            "unknown input or tunable parameter 'rat'; did you mean 'rate'",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\ns = { fmu = "users.py:Sum", set = { rate = 2 } }',
            '"r.y" = { to = "s.rate", convert = false }',
            "s.rate is fed by r.y",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\ns = { fmu = "users.py:Sum" }',
            '"r.y" = "s.angle"',
            "unit 'm' cannot be converted to 'rad'",
        ),
        (
            't = { fmu = "users.py:Turn" }\ns = { fmu = "users.py:Sum" }',
            '"t.text" = "s.u"',
            "text is str, u is float",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\nq = { fmu = "users.py:Ramp" }\na = { fmu = "users.py:Add" }',
            '"r.y" = "a.u"\n"q.y" = "a.u"',
            "already fed by r.y",
        ),
        (
            'r = { fmu = "users.py:Ramp" }\na = { fmu = "users.py:Add", set = { u = 3 } }',
            '"r.y" = "a.u"',
            "a.u is fed by r.y",
        ),
        ('a = { fmu = "users.py:Odd", set = { how = 3 } }', "", "a text is needed"),
        ('a = { fmu = "users.py:Add", step = "150 ms" }', "", "not a multiple"),
        ('a = { fmu = "users.py:Ad" }', "", "did you mean 'Add'"),
        ('a = { fmu = "users.py:Add", set = { gain = 1 } }', "", "unknown port 'gain'"),
        ('a = { fmu = "users.py:Add", set = { y = 1 } }', "", "output and cannot be set"),
        ('a = { fmu = "users.py:Scale", set = { bias = "3 kg" } }', "", "'kg' cannot be converted"),
        ('a = { fmu = "users.py:Scale", set = { bias = [1, 2] } }', "", "1 values are needed"),
        ('a = { fmu = "users.py:Scale", set = { bias = "plenty" } }', "", "not a quantity"),
        ('a = { fmu = "users.py:Scale", parameters = "hydrone" }', "", "component table"),
        ('a = { fmu = "users.py:Scale", profile = "sensors.gnss" }', "", "names no profile"),
        ('"a b" = { fmu = "users.py:Scale" }', "", "letters, digits"),
        ('a = { fmuu = "users.py:Scale" }', "", "did you mean 'fmu'"),
    ],
)
def test_mistakes_in_a_rig_are_named(
    direct, components: str, connections: str, message: str
) -> None:
    with pytest.raises(InputError, match=message) as error:
        direct.system(components, connections)
    assert "rig.toml" in str(error.value)


@pytest.mark.parametrize(
    ("top", "message"),
    [
        ('step = "10"', "has no unit"),
        ('step = "10 kg"', "cannot be converted to 's'"),
        ('step = "0 ms"', "must be positive"),
        ('step = "10 ms"\nalgorithm = "jakobi"', "algorithm"),
        ('stepp = "10 ms"', "did you mean 'step'"),
        ('step = "10 ms', r"line 1"),
    ],
)
def test_mistakes_at_the_top_of_a_rig_are_named(direct, top: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        direct.system("", "", top=top)


def test_values_that_a_component_refuses_are_named(bench: Bench) -> None:
    with pytest.raises(SimulationError, match="unknown value of how 'explode'"):
        bench.master('boat = { fmu = "users.py:Bad", set = { how = "explode" } }')


def test_unconnected_inputs_are_reported(direct) -> None:
    system = direct.system(
        'ramp = { fmu = "users.py:Ramp" }\nsum = { fmu = "users.py:Sum", set = { on = true } }',
        '"ramp.y" = "sum.u"',
    )
    assert system.unconnected_inputs() == ["sum.angle"]


def test_optional_inputs_are_not_among_the_unconnected_ones(bench: Bench) -> None:
    system = bench.master('gnss = { fmu = "gnss" }').system
    assert system.parts["gnss"].instance.variables["fault"].optional
    assert system.unconnected_inputs() == [
        "gnss.position", "gnss.attitude", "gnss.velocity", "gnss.rates"
    ]  # fmt: skip
