"""Plants in C among waves, current and wind: the numbers of Python, and a closed form."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.compiler import HERE, library_here
from seatrial.fmi.components.source import find_source
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.loading.load import load_fmu, open_instance
from seatrial.model.component import Input, Output, Parameter
from seatrial.model.plant import State
from seatrial.physics.craft.surrounded import SurroundedPlant, surrounding
from seatrial_kits.native.cached import native_fmu
from seatrial_kits.native.export import build_native_fmu
from seatrial_kits.native.surroundings import surround, surroundings_of
from tests.command import seatrial

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux")

WEATHER = {"swell": 0.5, "rate": 2.0}


class Cork(SurroundedPlant):
    """Cork that the water takes along, but for its slip."""

    surrounding_ports = (
        surrounding("water", "m/s", "velocity of the water", ("n", "e")),
        surrounding("gust", "m/s", "velocity of the wind", ("n",)),
    )
    swell = Parameter(0.0, "m/s", "amplitude of the water's velocity", role="sea")
    rate = Parameter(1.0, "rad/s", "its frequency", role="sea")
    known_until = Parameter(1e9, "s", "end of the forecast; negative: an error then", role="sea")
    slip = Parameter(0.0, "1/s", "pull towards the origin")
    push = Input("m/s", "of somebody")
    x = State("m", "place", axes=("n", "e"))
    flow = Output("m/s", "velocity of the water to north")

    def equations(self, x, u, p):
        water = getattr(u, "water", None)
        if water is None:
            return {"x": ca.vertcat(u.push, -p.slip * x.x[1])}, {"flow": 0.0}
        slow = u.push - p.slip * (x.x[0] - u.gust)
        return {"x": ca.vertcat(water[0] + slow, water[1])}, {"flow": water[0]}

    def met(self):
        if not self.swell:
            return None
        a, w, until = self.swell, self.rate, self.known_until

        def at(t, state):
            if t > abs(until):
                return np.full(3, math.inf) if until > 0.0 else math.sqrt(until)
            return np.array([a * math.cos(w * t), a * math.sin(w * t), 0.1 * state[1]])

        return at


def _opened(values: dict[str, float]):
    source = find_source(f"{__file__}:Cork", Path.cwd())
    around = surroundings_of(source, values)
    native = open_instance(load_fmu(native_fmu(source, values, surrounded=bool(around))), "cork")
    if around:
        surround(native, around)
    return native


def _both(values: dict[str, float]):
    pair = DirectInstance(Cork("cork"), compiles=False), _opened(values)
    for each in pair:
        each.set_start(values)
        each.initialise(0.0, 100.0)
        each.begin()
    return pair


@pytest.mark.parametrize("h", [0.01, 0.004, 0.05, 0.3])
def test_the_water_carries_it_as_far_as_it_goes(h: float) -> None:
    """x = a sin(w t) / w: the cubic between evaluations meets a wave within 0.042 (w D)^4."""
    _, native = _both(WEATHER)
    read = native.reader(["x.n", "flow"])
    rate, a = WEATHER["rate"], WEATHER["swell"]
    apart = max(h, 0.05)
    for k in range(round(3.0 / h)):
        native.step(k * h, h)
        north, flow = read()
        t = (k + 1) * h
        assert flow == pytest.approx(a * math.cos(rate * t), abs=0.042 * (rate * apart) ** 4 * a)
        assert north == pytest.approx(
            a * math.sin(rate * t) / rate, abs=0.042 * (rate * apart) ** 4 * a * t + 1e-9
        )
    native.free()


def test_steps_of_any_length_and_from_a_saved_state_have_the_numbers_of_python() -> None:
    python, native = _both({**WEATHER, "slip": 0.2})
    names = ["x.n", "x.e", "flow"]
    readers = [each.reader(names) for each in (python, native)]
    writers = [each.writer(["push"]) for each in (python, native)]
    lengths = [0.01] * 9 + [0.02, 0.3, 0.3, 0.007] + [0.01] * 7
    states = None
    t = 0.0
    for k in range(60):
        h = lengths[k % len(lengths)]
        for write in writers:
            write([0.1 * (k % 7)])
        for each in (python, native):
            each.step(t, h)
        found = [read() for read in readers]
        assert [v.hex() for v in found[0]] == [v.hex() for v in found[1]]
        t += h
        if k == 33:
            states = [each.get_state() for each in (python, native)]
        if k == 47:
            for each, state in zip((python, native), states, strict=True):
                each.set_state(state)
            t = sum(lengths[i % len(lengths)] for i in range(34))
    for each in (python, native):
        each.free()


def test_one_fmu_serves_every_sea() -> None:
    source = find_source(f"{__file__}:Cork", Path.cwd())
    calm, *rough = [
        native_fmu(source, values, surrounded=bool(surroundings_of(source, values)))
        for values in ({}, WEATHER, {"swell": 2.0, "rate": 0.3})
    ]
    assert rough[0] == rough[1] != calm
    for values in (WEATHER, {"swell": 2.0, "rate": 0.3}):
        python, native = _both(values)
        for each in (python, native):
            each.step(0.0, 0.1)
        flows = [each.reader(["flow"])()[0] for each in (python, native)]
        assert (
            flows[0]
            == flows[1]
            == pytest.approx(values["swell"] * math.cos(values["rate"] * 0.1), rel=1e-3)
        )
        native.free()


def test_with_nothing_around_it_is_the_still_one() -> None:
    values = {"slip": 0.3, "x_start.e": 2.0}
    source = find_source(f"{__file__}:Cork", Path.cwd())
    among = open_instance(load_fmu(native_fmu(source, values, surrounded=True)), "cork")
    python = DirectInstance(Cork("cork"), compiles=False)
    found = []
    for each in (python, among):
        each.set_start(values)
        each.initialise(0.0, 1.0)
        each.begin()
        each.step(0.0, 0.5)
        found.append(each.reader(["x.n", "x.e", "flow"])())
        each.free()
    assert found[0] == found[1]
    assert found[0][1] == pytest.approx(2.0 * math.exp(-0.15), rel=1e-9)


def test_an_fmu_for_any_host_has_no_weather(tmp_path: Path) -> None:
    source = find_source(f"{__file__}:Cork", Path.cwd())
    with pytest.raises(InputError, match="still water and air"):
        build_native_fmu(source, tmp_path / "cork.fmu", (HERE,), WEATHER, library_here)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["hydrone-landing-waves", "mariner-seaway"])
def test_a_shipped_trial_in_waves_is_wholly_native_with_the_same_record(
    name: str, tmp_path: Path
) -> None:
    records = []
    for engine in ("direct", "native"):
        command = ["run", name, "--engine", engine, "--set", "stop=5 s", "--no-report"]
        done = seatrial(*command, "--out", engine, cwd=tmp_path)
        assert "in Python" not in done.stdout + done.stderr
        records.append((tmp_path / engine / "signals.csv").read_bytes())
    assert records[0].count(b"\n") > 40
    assert records[0] == records[1]


@pytest.mark.parametrize("known_until", [0.2, -0.2])
def test_both_end_where_there_is_no_value_around(known_until: float) -> None:
    """Where it is infinite, and where Python has an error."""
    for each in _both({**WEATHER, "known_until": known_until}):
        with pytest.raises(SimulationError) as raised:
            for k in range(10):
                each.step(k * 0.05, 0.05)
        why = "cork: there is no value for what surrounds it at t = 0.25 s"
        assert why in str(raised.value)
        each.free()
