"""Sampled and memoryless components as native FMUs: the numbers of Python to the bit."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import pytest
from fmpy.validation import validate_fmu

import seatrial
from seatrial.errors import InputError, SimulationError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.components.source import find_source
from seatrial.model.component import Component, Input, Noise, Output, Parameter
from seatrial.model.faults.text import FAILURES, fault_text
from seatrial.model.plant import Plant
from seatrial.model.sampled import Sampled
from seatrial_kits.native.carriers import why_python
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.native.tables import is_built_in
from tests.fmi.native_slave import Slave
from tests.fmi.native_slave3 import Slave3
from tests.interop.native_fmus import moved, start_values

pytestmark = pytest.mark.skipif(HERE != "linux64", reason="loads libraries of Linux")

QUICK = ("gnss", "station-keeping", "thruster")
IN_FMI_3 = (*QUICK, "guidance", "imu", "wind")
LINKS = (
    "seatrial.links.",
    *(
        f"seatrial_kits.{kit}."
        for kit in ("arduino", "ardupilot", "can", "gprs", "mavlink", "nmea", "px4")
    ),
    *(f"seatrial_kits.videoray.{name}" for name in ("m5_thrusters", "player", "rov", "topside")),
)
CANDIDATES = [
    name
    for name in components().names()
    if not issubclass(component_class(name), Plant)
    and not component_class(name).__module__.startswith(LINKS)
]
STEPS = (0.01, 0.025, 0.004, 0.1)


def built(name: str, folder: Path, values: Any = None, version: int = 2) -> Path:
    source = find_source(name, Path.cwd())
    path = folder / f"{source.stem}.fmu"
    return build_native_fmu(source, path, (HERE,), values, library_here, version)


def faults_of(cls: type[Component]) -> list[str]:
    """Return texts of every fault that a device can have."""
    found = ["none", *FAILURES]
    for port in getattr(cls, "measured", ()):
        of = port.name
        found += [
            fault_text("bias", of, {"value": [0.25] * port.size}, 1.0, 2.0),
            fault_text("noise", of, {"value": [0.5]}, 0.5),
            fault_text("drift", of, {"rate": [0.1]}, 1.0),
            fault_text("scale", of, {"factor": [1.5]}, 0.5, 1.0),
            fault_text("deviation", of, {"coefficients": [0.1, 0.2, 0.3, 0.4, 0.5]}, 1.0),
        ]
    return found


class Pair:
    """A component in Python and its native FMU, which get the same."""

    def __init__(self, name: str, folder: Path, values: dict[str, Any], version: int = 2) -> None:
        self.python = component_class(name)("x")
        for port, value in values.items():
            self.python.set(port, value)
        self.slave = (Slave3 if version == 3 else Slave)(
            built(name, folder, values, version), folder
        )
        self.faults = faults_of(type(self.python))
        self.values = values
        fmu = self.slave.fmu
        self.setters = {
            float: fmu.setReal,
            int: fmu.setInteger,
            bool: fmu.setBoolean,
            str: fmu.setString,
        }
        self.getters = {float: fmu.getReal, int: fmu.getInteger, bool: fmu.getBoolean}
        self.drawn = random.Random(name)
        self.time = 0.0

    def begin(self) -> None:
        self.python.setup(0.0)
        self.python.initialise()
        self.python.begin()
        self.slave.begin()

    def feed(self, k: int) -> None:
        """Give both the same random inputs."""
        for scalar in self.python.scalars:
            port = scalar.port
            if port.kind != "input" or (port.type is str and k % 13):
                continue
            value = self._value(port, k, scalar.index)
            self.python.write([scalar.reference], [value], port.type)
            self.setters[port.type]([scalar.reference], [value])

    def _value(self, port: Any, k: int, index: int) -> Any:
        kind = port.type
        if kind is float:
            return moved(self.drawn, port.start[index])
        if kind is int:
            return self.drawn.randrange(3)
        if kind is bool:
            first = self.values.get(port.name, True)
            return first if k < 40 else self.drawn.random() < 0.7
        return self.drawn.choice(self.faults if port.role == "fault" else port.choices)

    def step(self, h: float) -> None:
        self.python.advance(self.time, h)
        self.slave.fmu.doStep(self.time, h)
        self.time = self.python.now

    def outputs(self) -> list[str]:
        """Return the outputs, which are equal."""
        found = []
        for kind, get in self.getters.items():
            outputs = [
                s.reference
                for s in self.python.scalars
                if s.port.kind == "output" and s.port.type is kind
            ]
            if outputs:
                python = [float(v).hex() for v in self.python.read(outputs, kind)]
                assert [float(v).hex() for v in get(outputs)] == python
                found += python
        return found


@pytest.mark.sampled(25)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "version"),
    [
        *(
            (n, 2) if n in QUICK else pytest.param(n, 2, marks=pytest.mark.interop)
            for n in CANDIDATES
        ),
        *(
            pytest.param(n, 3, marks=pytest.mark.interop if n in IN_FMI_3 else pytest.mark.long)
            for n in CANDIDATES
        ),
    ],
)
def test_same_numbers_to_the_bit(name: str, version: int, tmp_path: Path) -> None:
    """Random inputs, faults and steps; saved and restored states; a run anew."""
    why = why_python(component_class(name))
    if why and name not in QUICK:
        pytest.skip(why)
    pair = Pair(name, tmp_path, start_values(name), version)
    assert validate_fmu(str(next(tmp_path.glob("*.fmu")))) == []
    pair.begin()
    seen, kept = set(), None
    for k in range(300):
        pair.feed(k)
        pair.outputs()
        pair.step(STEPS[k % 4])
        seen.add(tuple(pair.outputs()))
        if k == 150:
            kept = (pair.slave.serialized(), pair.python.get_state(), pair.drawn.getstate())
            begun = pair.time
    last = pair.outputs()
    assert kept is not None
    pair.slave.restore(kept[0])
    pair.python.set_state(kept[1])
    pair.drawn.setstate(kept[2])
    pair.time = begun
    for k in range(151, 300):
        pair.feed(k)
        pair.step(STEPS[k % 4])
    assert pair.outputs() == last
    assert len(seen) > 1


@pytest.mark.slow
def test_parameters_are_numbers_of_the_run(tmp_path: Path) -> None:
    """One FMU, another compass: numbers are set by whoever runs it."""
    pair = Pair("compass", tmp_path, {})
    for port, value in {"variation": 0.1, "delay": 0.03, "seed": 12.0, "dropout": 0.5}.items():
        pair.python.set(port, value)
        pair.slave.fmu.setReal([pair.slave.reference[port]], [value])
    pair.begin()
    for k in range(100):
        pair.feed(k)
        pair.step(0.02)
        pair.outputs()


class Figures(Component):
    """What Python's library does in its own way."""

    x = Input("1", "numbers", axes="abcd", start=1.0)
    y = Output("1", "what is made of them", axes="abcdefgh")

    def outputs(self, t: float) -> None:
        a, b, c, d = self.x
        whole, rest = divmod(a, b)
        plane, space = math.hypot(a, b), math.hypot(a, b, c, d)
        self.y = (
            plane,
            space,
            sum(self.x),
            a % b,
            a // b + whole,
            rest,
            round(d),
            math.dist((a, b), (c, d)),
        )


@pytest.mark.slow
def test_norms_and_sums_are_those_of_this_python(tmp_path: Path) -> None:
    """Numbers of all sizes, in which each rounding error shows."""
    slave = Slave(built(f"{__file__}:Figures", tmp_path), tmp_path)
    slave.begin()
    inputs = [slave.reference[f"x.{axis}"] for axis in "abcd"]
    outputs = [slave.reference[f"y.{axis}"] for axis in "abcdefgh"]
    draw, python = random.Random(1), Figures("x")
    python.setup(0.0)
    python.set("x", [1.0, 1.0, 1.0, 1.0])
    python.initialise()
    for _ in range(5000):
        x = [draw.uniform(-1.0, 1.0) * 10.0 ** draw.randrange(-3, 4) for _ in range(4)]
        slave.fmu.setReal(inputs, x)
        python.set("x", x)
        found = slave.fmu.getReal(outputs)
        assert [v.hex() for v in found] == [v.hex() for v in python.get("y")]


class Dice(Noise, Sampled):
    """Draws from one generator in several places, also where it is passed on."""

    x = Output("1", "what was drawn", axes="abcdef")

    def sample(self, t: float, k: int) -> None:
        generator = self.generator(k)
        first = generator.random() if k % 3 else 0.0
        second = float(self._thrown(generator))
        third = float(self._thrown(generator))
        fourth, fifth = generator.standard_normal(2).tolist()
        self.x = first, second, third, fourth, fifth, float(generator.integers(0, 7_000_000))

    def _thrown(self, generator: Any) -> int:
        return int(generator.integers(-3, 4))


@pytest.mark.slow
def test_one_generator_is_drawn_from_in_several_places(tmp_path: Path) -> None:
    slave = Slave(built(f"{__file__}:Dice", tmp_path), tmp_path)
    slave.begin()
    outputs = [slave.reference[f"x.{axis}"] for axis in "abcdef"]
    python = Dice("x")
    python.setup(0.0)
    python.initialise()
    python.begin()
    seen = set()
    for k in range(2000):
        found = slave.fmu.getReal(outputs)
        assert found == list(python.get("x"))
        seen.add(found[1])
        slave.fmu.doStep(python.now, 0.1)
        python.advance(0.1 * k, 0.1)
    assert seen == {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0}


class Giver(Dice):
    """Hands out a generator that it has drawn from."""

    def sample(self, t: float, k: int) -> None:
        self.x = [self._begun(k).random()] * 6

    def _begun(self, k: int) -> Any:
        generator = self.generator(k)
        generator.random()
        return generator


def test_a_generator_that_is_returned_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a generator that Giver\._begun has drawn from"):
        built(f"{__file__}:Giver", tmp_path)


class Doubler(Sampled):
    """Doubles its input, and refuses what is too large."""

    limit = Parameter(1.0, "V", "largest input", min=0.0)
    u = Input("V", "input")
    y = Output("V", "twice that")

    def sample(self, t: float, k: int) -> None:
        if self.u > self.limit:
            raise InputError(f"{self.name}.u is {self.u!r} V, allowed {self.limit:.1f} V")
        self.y = 2.0 * self.u


class Ahead(Doubler):
    """Has a clock of its own."""

    def advance(self, t: float, h: float, *, publish: bool = True) -> None:
        super().advance(t + h, h, publish=publish)


class Opener(Sampled):
    """Does what no C can."""

    y = Output("V", "length of a file")

    def sample(self, t: float, k: int) -> None:
        with open("x") as file:
            self.y = len(file.read())


@pytest.mark.slow
def test_a_component_of_ones_own(tmp_path: Path) -> None:
    path = built(f"{__file__}:Doubler", tmp_path)
    slave = Slave(path, tmp_path)
    slave.fmu.setReal([slave.reference["u"]], [0.75])
    slave.begin()
    assert slave.fmu.getReal([slave.reference["y"]]) == [1.5]
    slave.fmu.setReal([slave.reference["u"]], [1.25])
    with pytest.raises(Exception, match="fmi2GetReal"):
        slave.fmu.getReal([slave.reference["y"]])
    assert slave.messages == ["x.u is 1.25 V, allowed 1.0 V"]
    python = Doubler("x")
    python.set("u", 1.25)
    python.setup(0.0)
    with pytest.raises((InputError, SimulationError), match=r"x\.u is 1\.25 V, allowed 1\.0 V"):
        python.initialise()


def test_another_way_to_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be native: it overrides advance"):
        built(f"{__file__}:Ahead", tmp_path)


class Shared(Sampled):
    """Changes a list that has two names."""

    y = Output("V", "first of a list")

    def reset(self, t: float) -> None:
        self._one = [0.0, 1.0]
        self._other = self._one

    def sample(self, t: float, k: int) -> None:
        self.y = self._other[0]

    def update(self, t: float, k: int) -> None:
        self._one[0] += 1.0


def test_a_list_with_two_names_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"\(Shared\.update\): a change of an item where it is"):
        built(f"{__file__}:Shared", tmp_path)


def test_what_has_no_c_is_named_with_its_line(tmp_path: Path) -> None:
    line = next(
        n
        for n, text in enumerate(Path(__file__).read_text().splitlines(), 1)
        if "with open(" in text
    )
    with pytest.raises(
        InputError, match=rf"{Path(__file__).name}:{line} \(Opener.sample\): .*With"
    ):
        built(f"{__file__}:Opener", tmp_path)
    assert list(tmp_path.iterdir()) == []


def _values(rig: str, engine: str, steps: int, **settings: Any) -> list[list[float]]:
    with seatrial.Simulation(rig, engine=engine, **settings) as simulation:
        rows = []
        for _ in range(steps):
            simulation.step()
            rows.append([float(simulation.get(name)) for name in simulation.signals])
        return rows


@pytest.mark.long
@pytest.mark.interop
@pytest.mark.parametrize("rig", ["landing", "thruster-ship", "mariner-pd"])
def test_a_rig_runs_in_c_where_it_can(rig: str) -> None:
    assert _values(rig, "native", 500) == _values(rig, "direct", 500)


def test_an_engine_that_there_is_not() -> None:
    with pytest.raises(InputError, match="engine"):
        seatrial.Simulation("landing", engine="nativ")


def test_built_in_are_texts_and_surroundings() -> None:
    gnss, wind = component_class("gnss"), component_class("wind")
    assert is_built_in(gnss, gnss.ports["reception"])
    assert not is_built_in(gnss, gnss.ports["seed"])
    assert not is_built_in(gnss, gnss.ports["fault"])
    assert is_built_in(wind, wind.ports["wind_speed"])
