"""Trained networks as components: closed forms, and the same bytes from every carrier."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import seatrial
from seatrial.errors import InputError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.system.system import Engine
from seatrial_kits.native.export import build_native_fmu

from .policies import LAYERS, PLAIN, network, ports, source, started, write

LINUX = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")
FORMULAS = {
    "identity": lambda x: x,
    "relu": lambda x: np.maximum(x, 0.0),
    "leaky_relu": lambda x: np.where(x > 0.0, x, 0.01 * x),
    "leaky_relu(0.2)": lambda x: np.where(x > 0.0, x, 0.2 * x),
    "elu": lambda x: np.where(x > 0.0, x, np.expm1(x)),
    "elu(0.5)": lambda x: np.where(x > 0.0, x, 0.5 * np.expm1(x)),
    "tanh": np.tanh,
    "sigmoid": lambda x: 1.0 / (1.0 + np.exp(-x)),
    "softplus": lambda x: np.logaddexp(0.0, x),
}
HEADING = """network = "net.npz"
period = "100 ms"
[inputs]
heading = "rad"
wanted = { unit = "deg" }
velocity = { unit = "m/s", axes = ["u", "v"] }
[outputs]
moment = "N.m"
force = "kN"
[[observe]]
value = "wrap(wanted - heading)"
range = ["-90 deg", "90 deg"]
[[observe]]
value = "sqrt(velocity.u * velocity.u + velocity.v * velocity.v)"
trained = ["1 m/s", "2 m/s"]
[[observe]]
value = "max(velocity.u, velocity.v, 1 m/s) / 1 m/s + sin(heading) * cos(heading) - abs(tan(heading))"
[[act]]
to = "force"
range = ["-500 N", "1500 N"]
[[act]]
to = "moment"
"""
SAME = {"W0": np.eye(3)[:2], "b0": [0.0, 0.0], "activations": ["identity"]}


def answer(path: Path, x: Any) -> list[float]:
    component = started(path)
    component.set("x", x)
    found: list[float] = component.get("y")
    return found


def test_one_layer_is_its_product(tmp_path: Path) -> None:
    assert answer(write(tmp_path), [1.0, 2.0, 4.0]) == [17.25, -4.0]


@pytest.mark.parametrize("name", FORMULAS)
def test_activations(name: str, tmp_path: Path) -> None:
    x = np.array([-800.0, -3.0, -0.1, 0.0, 0.1, 3.0, 800.0])
    arrays = {"W0": np.eye(7), "b0": np.zeros(7), "activations": [name]}
    with np.errstate(over="ignore"):
        expected = FORMULAS[name](x)
    assert answer(write(tmp_path, ports(7, 7), arrays), x) == pytest.approx(expected, rel=1e-14)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.integers(1, 9), min_size=2, max_size=5),
    st.lists(st.sampled_from(sorted(FORMULAS)), min_size=4, max_size=4),
    st.integers(0, 2**31),
)
def test_networks_are_those_of_numpy(
    tmp_path_factory: pytest.TempPathFactory, sizes: list[int], names: list[str], seed: int
) -> None:
    arrays = network(sizes, names[: len(sizes) - 1], seed)
    path = write(tmp_path_factory.mktemp("net"), ports(sizes[0], sizes[-1]), arrays)
    x = np.random.default_rng(seed).normal(size=sizes[0])
    expected = x
    for number, name in enumerate(names[: len(sizes) - 1]):
        expected = FORMULAS[name](arrays[f"W{number}"] @ expected + arrays[f"b{number}"])
    assert answer(path, x) == pytest.approx(expected, rel=1e-12, abs=1e-13)


def test_scales_of_the_file(tmp_path: Path) -> None:
    arrays = LAYERS | {
        "input_mean": [1.0, 2.0, 3.0],
        "input_scale": [2.0, 4.0, 0.5],
        "output_scale": [10.0, -1.0],
        "output_mean": [0.0, 5.0],
        "input_low": [0.0, 0.0, 0.0],
        "input_high": [1.0, 2.0, 3.0],
    }
    component = started(write(tmp_path, arrays=arrays))
    component.set("x", [3.0, -2.0, 3.5])
    assert component.get("y") == pytest.approx([22.5, 6.0], rel=1e-14)
    assert component.get("outside") == 3
    component.set("x", [1.0, 0.0, 3.0])
    assert component.get("inside") is True


def test_observations_and_actions_have_units_and_ranges(tmp_path: Path) -> None:
    component = started(write(tmp_path, HEADING, SAME))
    heading, wanted, u, v = 3.0, -100.0, 1.5, -0.5
    for name, value in (("heading", heading), ("wanted", wanted), ("velocity", [u, v])):
        component.set(name, value)
    error = math.remainder(math.radians(wanted) - heading, math.tau)
    share = max(-1.0, min(1.0, error / (math.pi / 2)))
    assert component.get("force") == pytest.approx(0.5 + share, rel=1e-12)
    assert component.get("moment") == pytest.approx(math.hypot(u, v), rel=1e-14)
    assert component.get("outside") == 0
    component.set("heading", 0.0)
    component.set("velocity", [0.5, 0.0])
    assert component.get("force") == -0.5  # limited to its range
    assert (component.get("inside"), component.get("outside")) == (False, 2)


def test_without_ranges_nothing_is_said_of_training(tmp_path: Path) -> None:
    names = source(write(tmp_path)).component_class().scalar_by_name
    assert "inside" not in names
    assert "outside" not in names


def test_it_acts_at_its_instants_and_holds_between(tmp_path: Path) -> None:
    component = started(write(tmp_path))
    component.set("x", [1.0, 0.0, 0.0])
    component.advance(0.0, 0.05)
    component.set("x", [2.0, 0.0, 0.0])
    assert component.get("y.p") == 1.25
    component.advance(0.05, 0.05)
    assert component.get("y.p") == 2.25


def test_without_a_period_it_follows_at_once(tmp_path: Path) -> None:
    component = started(write(tmp_path, PLAIN.replace('period = "100 ms"\n', "")))
    component.advance(0.0, 0.05)
    component.set("x", [2.0, 0.0, 0.0])
    assert component.get("y.p") == 2.25
    assert "period" not in type(component).scalar_by_name


def test_a_saved_state_goes_on_as_before(tmp_path: Path) -> None:
    component = started(write(tmp_path, ports(3, 2), network((3, 5, 2), ["tanh", "elu"], 3)))
    component.set("x", [0.1, 0.2, 0.3])
    component.advance(0.0, 0.1)
    before, once = component.get_state(), component.get("y")
    component.set("x", [3.0, 2.0, 1.0])
    component.advance(0.1, 0.1)
    assert component.get("y") != once
    component.set_state(before)
    assert component.get("y") == once


def test_terminals_and_frames(tmp_path: Path) -> None:
    text = PLAIN.replace('"c"] }', '"c"], frame = "b" }') + '[terminals]\nsensors = ["x"]\n'
    cls = source(write(tmp_path, text)).component_class()
    assert dict(cls.terminals["sensors"].members) == {"x": "x"}
    assert cls.ports["x"].frame == "b"


RIG = """step = "50 ms"
[components]
policy = { fmu = "policy.toml" }
plant = { fmu = "plants.py:Plant" }
[connections]
"policy.y" = "plant.force"
"plant.state" = "policy.x"
"""
PLANT = """
from seatrial.model.component import Component, Input, Output


class Plant(Component):
    \"\"\"Three integrators.\"\"\"

    force = Input("N", "force", axes=("p", "q"))
    state = Output("m", "state", axes=("a", "b", "c"))

    def start(self, t):
        self._x = (0.3, -0.2, 0.1)

    def step(self, t, h):
        p, q = self.force
        a, b, c = self._x
        self._x = (a + h * (q - 0.1 * a), b + h * (p - b), c + h * (a - c))

    def outputs(self, t):
        self.state = self._x
"""


def record(folder: Path, engine: Engine, steps: int = 40) -> list[str]:
    with seatrial.Simulation(folder / "rig.toml", engine=engine) as simulation:
        found = []
        for _ in range(steps):
            simulation.step()
            found += [float(simulation.get(f"policy.y.{axis}")).hex() for axis in "pq"]
    return found


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("period", ['period = "100 ms"\n', ""])
def test_the_same_bytes_from_every_carrier(period: str, tmp_path: Path) -> None:
    names = ["tanh", "sigmoid", "softplus", "leaky_relu(0.3)", "elu"]
    arrays = network((3, 20, 4, 5, 3, 2), names, 5) | {
        "input_low": [0.0] * 3,
        "input_high": [1.0] * 3,
        "output_low": [-100.0, -100.0],
        "output_high": [100.0, 5.0],
    }
    write(tmp_path, PLAIN.replace('period = "100 ms"\n', period), arrays)
    (tmp_path / "plants.py").write_text(PLANT, "utf-8")
    (tmp_path / "rig.toml").write_text(RIG, "utf-8")
    direct = record(tmp_path, "direct")
    assert len(set(direct)) > 20
    assert record(tmp_path, "native") == direct
    assert record(tmp_path, "fmu") == direct


@LINUX
@pytest.mark.long
@settings(max_examples=6, deadline=None)
@given(
    st.lists(st.integers(1, 40), min_size=2, max_size=4),
    st.lists(st.sampled_from(sorted(FORMULAS)), min_size=3, max_size=3),
    st.integers(0, 2**31),
)
def test_c_is_the_python(
    tmp_path_factory: pytest.TempPathFactory, sizes: list[int], names: list[str], seed: int
) -> None:
    """Building compares both over random inputs, to the last bit, and refuses a difference."""
    folder = tmp_path_factory.mktemp("net")
    path = write(folder, ports(sizes[0], sizes[-1]), network(sizes, names[: len(sizes) - 1], seed))
    build_native_fmu(source(path), folder / "net.fmu", (HERE,), None, library_here)


@LINUX
def test_observations_in_c_are_those_of_python(tmp_path: Path) -> None:
    text = HEADING.replace(
        '"max(',
        '"atan2(velocity.u, velocity.v) / 1 rad + min(velocity.u, velocity.v) / 1 m/s + max(',
    )
    build_native_fmu(
        source(write(tmp_path, text, SAME)), tmp_path / "a.fmu", (HERE,), None, library_here
    )


@LINUX
@pytest.mark.slow
def test_a_large_network_has_c(tmp_path: Path) -> None:
    path = write(tmp_path, ports(17, 2), network((17, 256, 256, 2), ["relu", "relu", "tanh"], 1))
    build_native_fmu(source(path), tmp_path / "net.fmu", (HERE,), None, library_here)


@LINUX
@pytest.mark.slow
def test_copies_in_a_batch_are_simulations(tmp_path: Path) -> None:
    write(tmp_path, arrays=network((3, 8, 2), ["tanh", "identity"], 2))
    (tmp_path / "plants.py").write_text(PLANT, "utf-8")
    (tmp_path / "rig.toml").write_text(RIG, "utf-8")
    direct = record(tmp_path, "direct", 20)
    with seatrial.Batch(tmp_path / "rig.toml", 2) as batch:
        found = []
        for _ in range(20):
            batch.step(1)
            found += [float(batch.get(f"policy.y.{axis}")[0]).hex() for axis in "pq"]
    assert found == direct


def test_units_of_connections_are_checked(tmp_path: Path) -> None:
    write(tmp_path, PLAIN.replace('unit = "N"', 'unit = "Pa"'))
    (tmp_path / "plants.py").write_text(PLANT, "utf-8")
    (tmp_path / "rig.toml").write_text(RIG, "utf-8")
    with pytest.raises(InputError, match=r"'Pa'.*'N'"):
        seatrial.Simulation(tmp_path / "rig.toml", engine="direct")
