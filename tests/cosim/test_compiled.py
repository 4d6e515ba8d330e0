"""The master in C against the one in Python: the same bits, messages and ends, on random graphs."""

from __future__ import annotations

import math
import random
import struct
from pathlib import Path
from typing import Any

import pytest

import seatrial.sim.master
from seatrial.errors import SimulationError
from seatrial.fmi import on_demand
from seatrial.sim.compiled import library
from seatrial.sim.compiled.rows import Rows
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig

from ..fmi.native import build_native_fmu, changed
from . import bodies

ALGORITHMS = ("jacobi", "plain-jacobi", "gauss-seidel", "extrapolated")
STEPS = 60
REALS = ("x", "y", "p[1]", "p[2]")
TROUBLES = ("nan", "discard", "error", "fatal", "warning", "negative", "beyond")


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("slaves")
    build_native_fmu("fmi2", folder)
    (folder / "bodies.py").write_text(bodies.TEXT, "utf-8")
    return folder


class Graph:
    """A rig of slaves in C, connected at random: loops, own steps, conversions, all types."""

    def __init__(self, seed: int, *, gain: float, texts: bool = False) -> None:
        draw = self.draw = random.Random(seed)
        names = [f"s{i}" for i in range(draw.randint(2, 7))]
        self.set: dict[str, dict[str, str]] = {}
        self.steps = {name: draw.choice((10, 10, 10, 20, 30)) for name in names}
        for name in names:
            self.set[name] = {
                "k": repr(draw.uniform(0.1, 5.0)),
                "gain": repr(draw.uniform(-gain, gain)),
                "u": "1.0",
            }
        self.connections = []
        for i, name in enumerate(names):
            for port in ("u", "q[1]", "q[2]"):
                self._connect(names, REALS, f"{name}.{port}", 0.7, converted=True)
            before = names[:i]  # a loop of these would hold no value
            self._connect(before, ("echo",), f"{name}.speed", 0.3)
            self._connect(before, ("j", "never_back"), f"{name}.i", 0.5)
            self._connect(before, ("mode",), f"{name}.mode_in", 0.5)
            self._connect(before, ("c",), f"{name}.b", 0.5)
            if texts:
                self._connect(before, ("r",), f"{name}.s", 0.5)
                self.set[name]["s"] = f'"{name}"'

    def _connect(
        self,
        names: list[str],
        outputs: tuple[str, ...],
        to: str,
        odds: float,
        *,
        converted: bool = False,
    ) -> None:
        if not names or self.draw.random() > odds:
            return
        source, options = f"{self.draw.choice(names)}.{self.draw.choice(outputs)}", ""
        if converted and self.draw.random() < 0.3:
            options = f", factor = {self.draw.uniform(0.5, 1.0)!r}, offset = 0.25"
        self.connections.append((source, f'{{ to = "{to}"{options} }}', to))

    def written(self, algorithm: str) -> str:
        fed = {to for _, _, to in self.connections}
        lines = ['step = "10 ms"', f'algorithm = "{algorithm}"', "[components]"]
        for name, values in self.set.items():
            free = {n: v for n, v in values.items() if f"{name}.{n}" not in fed}
            given = ", ".join(f"{n} = {v}" for n, v in free.items())
            own = f', step = "{self.steps[name]} ms"'
            lines.append(f'{name} = {{ fmu = "fmi2.fmu", set = {{ {given} }}{own} }}')
        lines.append("[connections]")
        by_source: dict[str, list[str]] = {}
        for source, target, _ in self.connections:
            by_source.setdefault(source, []).append(target)
        lines += [f'"{source}" = [{", ".join(t)}]' for source, t in by_source.items()]
        return "\n".join(lines) + "\n"


def bits(values: list[Any]) -> list[Any]:
    return [struct.pack("d", v) if isinstance(v, float) else (type(v), v) for v in values]


def run(path: Path, *, compiled: bool, block: int = 1000, steps: int = STEPS) -> dict[str, Any]:
    """Return all that is seen of a run: every point, how it ended, what was said."""
    with pytest.MonkeyPatch.context() as patch:
        if not compiled:
            patch.setattr(seatrial.sim.master, "is_compiled", lambda _system: False)
        system = assemble(load_rig(str(path)))
        seen: dict[str, Any] = {"points": [], "error": None}
        try:
            master = Master(system)
            try:
                master.initialise()
            except SimulationError as error:
                return seen | {"error": (type(error).__name__, str(error))}
            assert (master._compiled is not None) == compiled
            places = [i for i, v in enumerate(master.signals) if not isinstance(v, (str, bytes))]
            kinds = [type(master.signals[i]) for i in places]
            rows = Rows(places, 1)
            try:
                while master.steps < steps and not master.ended():
                    seen["points"].append(bits([master.signals[i] for i in places]))
                    rows.taken()
                    try:
                        master.advance(min(block, steps - master.steps), rows)
                    finally:
                        for row in rows.taken()[1].tolist():
                            found = [kind(v) for kind, v in zip(kinds, row, strict=True)]
                            seen["points"].append(bits(found))
            except SimulationError as error:
                seen["error"] = type(error).__name__, str(error)
            seen |= {
                "steps": master.steps,
                "signals": bits(list(master.signals)),
                "ends": master.end_notes(),
                "notes": master.notes(),
                "counts": {name: of.count for name, of in master.step_times.items()},
            }
        finally:
            system.free()
    return seen


def equal(path: Path, text: str, **options: Any) -> dict[str, Any]:
    path.write_text(text, "utf-8")
    found = run(path, compiled=True, **options)
    assert found == run(path, compiled=False, **options)
    return found


def called_from_c(path: Path) -> set[tuple[str, str]]:
    """Return components and functions of them that C calls."""
    system = assemble(load_rig(str(path)))
    try:
        master = Master(system)
        master.initialise()
        assert master._compiled is not None
        return {(fmu.name, call) for fmu, call in master._compiled._program.asked.values()}
    finally:
        system.free()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("seed", range(12))
def test_random_graphs_have_the_same_bits(fmus: Path, algorithm: str, seed: int) -> None:
    graph = Graph(seed, gain=0.7, texts=seed % 3 == 0)
    equal(fmus / f"{algorithm}-{seed}.toml", graph.written(algorithm), block=1 + 50 * (seed % 2))


@pytest.mark.parametrize("seed", range(100, 108))
def test_loops_that_hardly_settle_or_do_not(fmus: Path, seed: int) -> None:
    equal(fmus / f"loops-{seed}.toml", Graph(seed, gain=1.6).written("jacobi"))


@pytest.mark.parametrize("trouble", TROUBLES)
@pytest.mark.parametrize("algorithm", ["jacobi", "gauss-seidel", "extrapolated"])
def test_troubles_end_alike(fmus: Path, algorithm: str, trouble: str) -> None:
    graph = Graph(len(trouble), gain=0.5)
    graph.steps = dict.fromkeys(graph.steps, 10)
    graph.set["s1"] |= {"trouble": f'"{trouble}"', "trouble_time": "0.305"}
    found = equal(fmus / f"{algorithm}-{trouble}.toml", graph.written(algorithm))
    assert (found["error"] is None) == (trouble == "warning")
    assert found["steps"] == (STEPS if trouble == "warning" else 30)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_an_fmu_ends_the_simulation(fmus: Path, algorithm: str) -> None:
    graph = Graph(4, gain=0.5)
    graph.set["s1"] |= {"trouble": '"end"', "trouble_time": "0.305"}
    found = equal(fmus / f"{algorithm}-end.toml", graph.written(algorithm))
    assert found["error"] is None
    assert len(found["ends"]) == 1
    assert found["steps"] < STEPS


def test_discarded_steps_are_repeated_in_smaller_ones(fmus: Path) -> None:
    graph = Graph(3, gain=0.5)
    graph.steps = dict.fromkeys(graph.steps, 10)
    graph.set["s0"]["largest_step"] = "4e-3"
    found = equal(fmus / "split.toml", graph.written("jacobi"), steps=12)
    assert found["error"] is None
    assert "12 of 12 steps were discarded" in found["notes"][0]


def test_a_value_beyond_any_quantity_is_named(fmus: Path) -> None:
    text = """
step = "10 ms"
[components]
a = { fmu = "fmi2.fmu", set = { k = 1000.0, internal_step = 0.01 } }
b = { fmu = "fmi2.fmu" }
[connections]
"a.x" = "b.u"
"""
    found = equal(fmus / "excess.toml", text)  # x is multiplied by -9 in each step
    assert "a.x -> b.u carries -1.09419e+20, beyond any quantity" in found["error"][1]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_components_in_python_take_part(fmus: Path, algorithm: str) -> None:
    text = f"""
step = "10 ms"
algorithm = "{algorithm}"
[components]
a = {{ fmu = "fmi2.fmu", set = {{ gain = 0.5 }} }}
decay = {{ fmu = "bodies.py:Decay" }}
blend = {{ fmu = "bodies.py:Blend", set = {{ second = 0.3 }} }}
b = {{ fmu = "fmi2.fmu", set = {{ gain = -0.4 }}, step = "20 ms" }}
sum = {{ sum = {{ inputs = 2 }} }}
[connections]
"a.y" = ["decay.u", "sum.in[0]"]
"decay.x" = ["a.u", "b.u"]
"b.y" = ["blend.u", "sum.in[1]"]
"blend.y" = ["b.q[1]", "a.q[2]"]
"sum.out" = "blend.w"
"a.j" = {{ to = "b.i", mapping = [[0, 7], [14, 2]] }}
"b.never_back" = "a.i"
"""
    assert equal(fmus / f"mixed-{algorithm}.toml", text)["error"] is None


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_sums_are_taken_in_c(fmus: Path, algorithm: str) -> None:
    """Numbers and vectors, in a chain and in a loop: C sets and reads them."""
    text = f"""
step = "10 ms"
algorithm = "{algorithm}"
[components]
a = {{ fmu = "fmi2.fmu", set = {{ gain = 0.3, k = 0.7 }} }}
b = {{ fmu = "fmi2.fmu", set = {{ gain = -0.4 }}, step = "20 ms" }}
total = {{ sum = {{ inputs = 3 }} }}
forces = {{ sum = {{ inputs = 2, dimension = 2 }} }}
[connections]
"a.y" = ["total.in[0]", "forces.in[0][0]"]
"b.y" = [{{ to = "total.in[1]", factor = 0.3, offset = 0.2 }}, "forces.in[1][1]"]
"total.out" = ["a.u", "forces.in[1][0]"]
"a.x" = "forces.in[0][1]"
"forces.out[0]" = "b.u"
"forces.out[1]" = "b.q[1]"
"""
    path = fmus / f"sums-{algorithm}.toml"
    assert equal(path, text)["error"] is None
    asked = called_from_c(path)
    assert {(n, c) for n in ("total", "forces") for c in ("SetReal", "GetReal")} <= asked


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_fmus_of_fmi_3_are_called_from_c(fmus: Path, algorithm: str) -> None:
    """Numbers and whole arrays; early returns, the end; their texts and other types by Python."""
    own = fmus / "three"
    own.mkdir(exist_ok=True)
    path = own / f"{algorithm}.toml"
    build_native_fmu("fmi2", own)
    clock = '    <Clock name="tick" valueReference="300" causality="local" intervalVariability="triggered"/>'
    changed(
        build_native_fmu("fmi3", own), own / "plain.fmu", (' hasEventMode="true"', ""), (clock, "")
    )
    text = f"""
step = "10 ms"
algorithm = "{algorithm}"
[components]
a = {{ fmu = "plain.fmu", set = {{ longest_step = 0.004, end_time = 0.333 }} }}
b = {{ fmu = "plain.fmu", set = {{ gain = 0.4, k = 0.7 }}, step = "20 ms" }}
c = {{ fmu = "fmi2.fmu", set = {{ gain = 0.4 }} }}
[connections]
"a.x" = ["c.u", "b.in_Float64[1]"]
"c.y" = {{ to = "b.in_Float64[2]", factor = 2.0 }}
"c.x" = ["b.in_Float64[3]", "a.in_Float64[2]"]
"b.out_Float64[3]" = "c.q[1]"
"a.steps" = ["b.in_Int32[1]", "b.in_Int32[2]", "b.in_Int32[3]", "a.in_Int16[2]"]
"c.c" = ["b.in_Boolean[1]", "b.in_Boolean[2]", "b.in_Boolean[3]"]
"""
    found = equal(path, text)
    assert found["error"] is None
    assert found["ends"]
    assert found["steps"] == 34
    asked = called_from_c(path)
    calls = ("SetReal", "SetInteger", "SetBoolean", "DoStep", "GetReal", "GetBoolean")
    assert {("b", call) for call in calls} <= asked
    assert ("a", "SetReal") not in asked  # of an array that is set in part
    assert ("a", "SetInteger") not in asked  # of a type that C does not call


def test_an_oscillation_that_grows_is_found_at_the_same_step(fmus: Path) -> None:
    text = """
step = "10 ms"
algorithm = "plain-jacobi"
[components]
a = { fmu = "fmi2.fmu", set = { gain = -1.3 } }
[connections]
"a.y" = { to = "a.u", offset = 1e-3 }
"""
    found = equal(fmus / "growing.toml", text, steps=200)
    assert "swings from step to step" in found["error"][1]


def test_changes_from_outside_count_at_once_and_states_come_back(fmus: Path) -> None:
    graph = Graph(5, gain=0.6)
    (fmus / "set.toml").write_text(graph.written("extrapolated"), "utf-8")
    component, _, port = graph.connections[0][0].partition(".")

    def signals(compiled: bool) -> list[list[Any]]:
        with pytest.MonkeyPatch.context() as patch:
            if not compiled:
                patch.setattr(seatrial.sim.master, "is_compiled", lambda _system: False)
            system = assemble(load_rig(str(fmus / "set.toml")))
            try:
                master, found = Master(system), []
                master.initialise()

                def on(steps: int) -> None:
                    goal = master.steps + steps
                    while master.steps < goal:
                        master.advance(goal - master.steps)
                    found.append(bits(list(master.signals)))

                on(20)
                master.set("s0", ["gain"], [0.3])
                on(7)
                saved = master.save()
                master.override(component, port, 2.5)
                on(8)
                master.release(component, port)
                on(9)
                master.restore(saved)
                on(17)
                master.free(saved)
                return found
            finally:
                system.free()

    found = signals(compiled=True)
    assert found == signals(compiled=False)
    assert len({str(each) for each in found}) >= len(found) - 1


def test_without_a_compiler_python_steps(fmus: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(on_demand, "compilers_of", list)
    monkeypatch.setenv("SEATRIAL_CACHE", str(fmus / "empty"))
    library.library.cache_clear()
    try:
        (fmus / "alone.toml").write_text('step = "10 ms"\n[components]\na = { fmu = "fmi2.fmu" }\n')
        system = assemble(load_rig(str(fmus / "alone.toml")))
        master = Master(system)
        master.initialise()
        assert master._compiled is None
        master.step()
        x = master.signals[master.names.index(("a", "x"))]
        assert x == pytest.approx(math.exp(-0.01), rel=1e-14)
        system.free()
    finally:
        library.library.cache_clear()
