"""Simulations that a caller steps, against closed forms and the command line's records."""

from __future__ import annotations

import csv
import math
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pythonfmu import FmuBuilder

from seatrial import InputError, Simulation, SimulationError
from seatrial.links.hardware import ALLOWED
from tests.command import seatrial
from tests.kit import needs_kits

Rig = Callable[..., str]


def table(folder: Path) -> dict[str, list[str]]:
    with (folder / "signals.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, zip(*rows, strict=True), strict=True))


def as_written(value: Any) -> str:
    return str(int(value)) if isinstance(value, (bool, np.bool_)) else str(value)


def same_as_record(simulated: Any, folder: Path) -> None:
    """Assert that a recording holds what the command line wrote, digit by digit."""
    record = table(folder)
    assert [repr(t) for t in simulated.t.tolist()] == list(record.pop("time"))
    assert list(simulated) == list(record)
    for name, column in record.items():
        assert [as_written(v) for v in simulated[name].tolist()] == list(column), name


def test_a_lag_and_an_oscillator_follow_their_closed_forms(rig: Rig) -> None:
    # Held forces: x'' = -x by the explicit map of one step, whose eigenvalues are known.
    with Simulation(rig(), step=0.01, set={"source.level": 2.0}) as sim:
        assert (sim.time, sim.step_size) == (0.0, 0.01)
        sim.run(1)
        assert sim.time == 1.0
        assert sim.get("lag.y") == pytest.approx(2.0 * (1.0 - math.exp(-2.0)), rel=1e-12)
        h, root = 0.01, math.sqrt(1.0 - 0.01**2 / 16.0)
        z = complex(1.0 - h * h / 4.0, h * root)  # of [[1 - h²/2, h], [-h, 1]]
        x = (z**100).real - (h * h / 4.0) / (h * root) * (z**100).imag
        assert sim.get("body.x") == pytest.approx(x, rel=1e-9)


@pytest.mark.slow
def test_a_shipped_rig_gives_the_numbers_of_a_trial(tmp_path: Path) -> None:
    sets = ["--set", "stop=2 s", "--set", "drone.pad=diagonal-aft"]
    seatrial("run", "hydrone-landing", "--engine", "direct", "--out", "run", *sets, cwd=tmp_path)
    given = {"drone.pad": "diagonal-aft", "drone.phase": "landing"}
    with Simulation("landing", set=given) as sim:
        recording = sim.record()
        sim.run("2 s")
    same_as_record(recording.signals, tmp_path / "run")


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_set_override_and_release_do_what_events_and_faults_do(
    engine: str, trial: str, tmp_path: Path
) -> None:
    seatrial("run", trial, "--engine", "direct", "--out", "run", cwd=tmp_path)
    with Simulation(tmp_path / "rig.toml", engine=engine) as sim:
        sim.run(0.5)
        sim.set("source.level", "2 V")
        sim.set("types.place", np.array([0.1, 0.2, 0.3]))
        assert sim.get("source.y") == 2.0
        sim.run(1)
        sim.override("lag.u", 5.0)
        sim.override("spring.force", "-300 mN")
        sim.run(2)
        sim.release("lag.u")
        sim.release("spring.force")
        sim.run(3)
        last = {name: sim.get(name) for name in sim.signals}
    record = table(tmp_path / "run")
    assert {name: as_written(value) for name, value in last.items()} == {
        name: record[name][-1] for name in last
    }


def test_what_is_recorded_with_actions_at_points_is_the_trials_record(
    trial: str, tmp_path: Path
) -> None:
    """An observer that acts does so after its point; a trial's events come before theirs."""
    seatrial("run", trial, "--engine", "direct", "--out", "run", cwd=tmp_path)
    with Simulation(tmp_path / "rig.toml") as sim:

        @sim.observe
        def events(simulation: Simulation) -> None:
            if simulation.time == 0.5:
                simulation.set("source.level", 2.0)
                simulation.set("types.place", [0.1, 0.2, 0.3])
            if simulation.time == 1.0:
                simulation.override("lag.u", 5.0)
                simulation.override("spring.force", -0.3)
            if simulation.time == 2.0:
                simulation.release("lag.u")
                simulation.release("spring.force")

        recording = sim.record()
        sim.step(30)
    same_as_record(recording.signals, tmp_path / "run")


def test_values_of_every_kind_are_read(rig: Rig) -> None:
    with Simulation(rig(), set={"types.place": ("1 cm", 2, 3.0)}) as sim:
        sim.step(7)
        place = sim.get("types.place")
        assert (place.dtype, place.tolist()) == (np.float64, [0.01, 2.0, 3.0])
        assert sim.get("types.echo").tolist() == [0.01, 2.0, 3.0]
        assert (sim.get("types.flag"), sim.get("types.count")) == (True, 70)
        assert sim.get("types.text") == 'at "0.70", é'
        assert sim.get("lag.time_constant") == 0.5
        assert sim.get("spring.x") == sim.get("body.x")  # as it arrives now,
        assert sim.get("body.force") == sim.get("spring.force")  # not as it was held in the step
        sim.override("spring.x", "3 dm")
        assert sim.get("spring.x") == 0.3 != sim.get("body.x")
        assert sim.get("spring.force") == -0.3


def test_units_descriptions_and_connections_are_listed(rig: Rig) -> None:
    with Simulation(rig()) as sim:
        force = sim.signals["spring.force"]
        assert (force.unit, force.description, force.type) == ("N", "force on the end", float)
        assert "spring.force" not in sim.inputs
        assert (sim.inputs["lag.u"].feeder, sim.inputs["lag.u"].tunable) == ("source.y", False)
        assert (sim.inputs["spring.rest"].feeder, sim.inputs["spring.rest"].tunable) == ("", True)
        level = sim.parameters["source.level"]
        assert (level.minimum, level.maximum, level.tunable) == (0.0, 10.0, True)
        assert not sim.parameters["lag.time_constant"].tunable
        assert len(sim.signals) == 12


def test_observers_see_every_communication_point_until_they_are_dropped(rig: Rig) -> None:
    seen: list[float] = []
    with Simulation(rig()) as sim:
        first = sim.observe(lambda simulation: seen.append(simulation.time))
        positions = sim.record("types.echo", "body.?")
        sim.step(3)
        sim.unobserve(first)
        sim.step()
        assert seen == [0.1, 0.2, 0.3]
        assert list(positions.signals) == ["body.x", "body.v", *(f"types.echo.{a}" for a in "xyz")]
        assert positions.signals.t.tolist() == [0.0, 0.1, 0.2, 0.3, 0.4]
        assert positions.signals["types.echo"].shape == (5, 3)
        with pytest.raises(InputError, match="does not observe"):
            sim.unobserve(first)


# ---------------------------------------------------------------------- errors


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda sim: sim.get("bdy.x"), "unknown component 'bdy'; did you mean 'body'"),
        (lambda sim: sim.get("lag.z"), "lag: unknown port 'z'"),
        (lambda sim: sim.set("lag.tme_constant", 1), "did you mean 'time_constant'"),
        (lambda sim: sim.set("lag.time_constant", 1), "is fixed and cannot change during a run"),
        (lambda sim: sim.set("lag.u", 1), "fed by source.y; a fault replaces it"),
        (lambda sim: sim.set("lag.y", 1), "causality output and cannot be set"),
        (lambda sim: sim.set("source.level", 11.0), "not in its range"),
        (lambda sim: sim.set("source.level", "2 m"), "'m' cannot be converted to 'V'"),
        (lambda sim: sim.set("types.place", [1, 2]), "3 values are needed"),
        (lambda sim: sim.override("spring.rest", 1), "neither an output nor an input"),
        (lambda sim: sim.release("spring.frce"), "did you mean 'force'"),
        (lambda sim: sim.record("lag.x"), "unknown port 'x'"),
        (lambda sim: sim.record("lga.*"), "no signal matches 'lga.*'"),
        (lambda sim: sim.record("lag.u"), "no output"),
        (lambda sim: sim.run(0.25), "not a whole number of communication steps of 0.1 s"),
        (lambda sim: sim.run("0 s"), "from 0.2 s on"),
        (lambda sim: sim.run("4 m"), "cannot be converted to 's'"),
        (lambda sim: sim.step(-1), "cannot be negative"),
    ],
)
def test_mistakes_are_named(call: Callable[[Simulation], object], said: str, rig: Rig) -> None:
    with Simulation(rig()) as sim:
        sim.step(2)
        with pytest.raises(InputError) as caught:
            call(sim)
        assert said in str(caught.value)
        sim.step()  # and change nothing
        assert sim.get("source.y") == 1.0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"engine": "dirct"}, "did you mean 'direct'"),
        ({"set": {"lag.time_const": 1.0}}, "did you mean 'time_constant'"),
        ({"set": {"lag.time_constant": -1.0}}, "not in its range"),
        ({"step": "3 m"}, "step: "),
        ({"step": -0.1}, "must be positive"),
        ({"variant": "nominal"}, "nothing to vary"),
    ],
)
def test_mistakes_in_the_making_are_named(options: dict[str, Any], said: str, rig: Rig) -> None:
    with pytest.raises(InputError) as caught:
        Simulation(rig(), **options)
    assert said in str(caught.value)


def test_a_closed_simulation_and_a_state_of_another_are_refused(rig: Rig) -> None:
    path = rig()
    with Simulation(path) as other:
        state = other.save()
        sim = Simulation(path)
        with pytest.raises(InputError, match="the state of another simulation"):
            sim.restore(state)
        sim.close()
        sim.close()
        for call in (sim.step, sim.save, lambda: sim.get("lag.y"), lambda: sim.set("lag.u", 1.0)):
            with pytest.raises(InputError, match="is closed"):
                call()
    with pytest.raises(InputError, match="is closed"):
        other.restore(state)


# ---------------------------------------------------------------------- the outside world

MAVLINK = {"autopilot": "mavlink"}


@needs_kits("mavlink")
@pytest.mark.parametrize(
    ("link", "said"),
    [
        ("udpout:192.0.2.1:14550", "reaches the host 192.0.2.1; a simulation in Python"),
        ("udpin:0.0.0.0:14550", "listens at 0.0.0.0, where other hosts reach it"),
        ("serial:/dev/null:57600", "reaches the device /dev/null; a simulation in Python"),
    ],
)
def test_nothing_but_programs_on_this_machine_is_reached(
    link: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even where the environment allows it: nobody watches over what would move."""
    monkeypatch.setenv(ALLOWED, "1")
    with pytest.raises(InputError) as caught:
        Simulation("sil", choices=MAVLINK, set={"autopilot.mavlink.links": link})
    assert said in str(caught.value)
    assert os.environ[ALLOWED] == "1"


@needs_kits("mavlink")
def test_links_on_this_machine_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(ALLOWED, raising=False)
    links = {"autopilot.mavlink.links": "udpin:127.0.0.1:0"}
    with Simulation("sil", choices=MAVLINK, set=links) as sim:
        sim.step(2)
        with pytest.raises(InputError, match=r"the state of autopilot\.mavlink cannot be saved"):
            sim.save()
    assert ALLOWED not in os.environ


SLAVE = """
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Clockwork(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.y, self.stop = 0.0, 0.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))
        self.register_variable(Real("stop", causality=Fmi2Causality.output))

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        self.stop = -1.0 if stop_time is None else stop_time

    def do_step(self, current_time, step_size):
        self.y += self.u * step_size
        return True
"""


@pytest.mark.parametrize(
    ("engine", "isolated"), [("fmu", ""), ("direct", ", isolated = true"), ("direct", "")]
)
def test_an_fmu_of_somebody_else_is_stepped_without_a_stop_time(
    engine: str, isolated: str, rig: Rig, tmp_path: Path
) -> None:
    (tmp_path / "clockwork.py").write_text(SLAVE, "utf-8")
    FmuBuilder.build_FMU(tmp_path / "clockwork.py", dest=tmp_path)
    path = rig(more=f'slave = {{ fmu = "Clockwork.fmu"{isolated} }}')
    if engine == "direct" and not isolated:
        with pytest.raises(InputError, match="can only run with the engines 'fmu' and 'native'"):
            Simulation(path)
        return
    with Simulation(path, engine=engine) as sim:
        assert sim.get("slave.stop") == -1.0
        sim.set("slave.u", 2.0)
        sim.run("500 ms")
        assert sim.get("slave.y") == pytest.approx(1.0, rel=1e-12)


PROCESS = '''
"""Says in which process it is."""
import os

from seatrial.model.component import Component, Output


class Process(Component):
    """Its process."""

    pid = Output("1", "process", type=int)

    def outputs(self, t):
        self.pid = os.getpid()
'''


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX pipes")
@pytest.mark.parametrize("written", [True, "true"])
def test_a_setting_gives_a_component_a_process_of_its_own(written: object, write) -> None:
    write("process.py", PROCESS)
    entry = 'fmu = "process.py:Process"'
    path = write(
        "rig.toml", f'step = "0.1 s"\n[components]\na = {{ {entry} }}\nb = {{ {entry} }}\n'
    )
    with Simulation(path, set={"b.isolated": written}) as sim:
        sim.step()
        pid = int(sim.get("b.pid"))
        assert sim.get("a.pid") == os.getpid() != pid
        os.kill(pid, signal.SIGKILL)
        with pytest.raises(SimulationError, match="b: its process was ended by SIGKILL"):
            sim.step()
    with pytest.raises(InputError, match=r"set: b\.isolated: true, false or 'sandboxed' is needed"):
        Simulation(path, set={"b.isolated": "jailed"})
    with pytest.raises(InputError, match=r"set: bb\.isolated: unknown component 'bb'"):
        Simulation(path, set={"bb.isolated": True})


@pytest.mark.parametrize("engine", ["direct", "fmu"])
def test_a_reset_is_a_new_simulation(engine: str, rig: Rig) -> None:
    given = {"source.level": 2.0, "lag.time_constant": "200 ms", "body.mass": 3.0}
    with Simulation(rig(), engine=engine, seed=5, set=given) as new:
        new.step(7)
        wanted = [new.get(name) for name in new.signals]
    with Simulation(rig(), engine=engine) as sim:
        sim.step(3)
        sim.set("types.place", [1.0, 2.0, 3.0])
        sim.override("lag.y", 7.0)
        sim.inject("fixed", "spring.force", value=1.0)
        sim.reset(set=given, seed=5)
        assert sim.time == 0.0
        recording = sim.record("lag.y")
        sim.step(7)
        assert [sim.get(name) for name in sim.signals] == wanted
        assert recording.signals["lag.y"][-1] == sim.get("lag.y")
        sim.reset(set={"body.mass": 1.0})
        sim.run(1)
        assert sim.get("lag.y") == pytest.approx(2.0 * (1.0 - math.exp(-5.0)), rel=1e-12)


def test_a_reset_that_does_not_fit_changes_nothing(rig: Rig) -> None:
    with Simulation(rig(), set={"body.mass": 3.0}) as sim:
        sim.step(3)
        before = [sim.get(name) for name in sim.signals]
        with pytest.raises(InputError, match=r"reset: lag.time_constant.*range"):
            sim.reset(set={"body.mass": 1.0, "lag.time_constant": -1.0}, seed=9)
        assert [sim.get(name) for name in sim.signals] == before
        sim.step(3)
        after = [sim.get(name) for name in sim.signals]
        sim.reset()
        sim.step(6)
        assert [sim.get(name) for name in sim.signals] == after


def test_a_state_from_before_a_reset_is_gone_back_to(rig: Rig) -> None:
    with Simulation(rig()) as sim:
        sim.step(5)
        saved = sim.save()
        sim.step(2)
        wanted = [sim.get(name) for name in sim.signals]
        sim.reset(set={"body.mass": 2.0})
        sim.step(1)
        sim.restore(saved)
        assert sim.time == 0.5
        sim.step(2)
        assert [sim.get(name) for name in sim.signals] == wanted
