"""The slave inside an FMU, driven by FMPy: state, errors, start values, life cycle."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException

from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.components.source import ComponentSource

from .conftest import Raw


def test_state_has_the_hidden_variables(raw: Raw) -> None:
    slave = raw.start(u=2.0)
    slave.doStep(0.0, 0.1)
    state = slave.getFMUstate()
    slave.doStep(0.1, 0.1)
    assert raw.get("total") == 4.0
    slave.setFMUstate(state)
    assert raw.get("total") == 2.0
    slave.doStep(0.1, 0.1)
    assert raw.get("total") == 4.0
    assert slave.getInteger([raw.vr["steps"]]) == [2]
    slave.freeFMUstate(state)


def test_serialised_state_restores_another_instance(raw: Raw, tmp_path: Path) -> None:
    slave = raw.start(u=1.0 / 3.0)
    slave.setString([raw.vr["say"]], ["naïve 水"])
    slave.doStep(0.0, 0.1)
    state = slave.getFMUstate()
    data = slave.serializeFMUstate(state)
    slave.freeFMUstate(state)
    slave.doStep(0.1, 0.1)
    total = raw.get("total")
    slave.freeInstance()
    other = raw.start()
    restored = other.deSerializeFMUstate(data)
    other.setFMUstate(restored)
    other.doStep(0.1, 0.1)
    assert raw.get("total") == total
    assert other.getString([raw.vr["said"]]) == ["naïve 水".encode()]
    other.freeFMUstate(restored)


@pytest.mark.parametrize(
    "data",
    [b"{ not json", b"[1]", b'{"dict": [["component", {"dict": []}]]}', b"\xff", b'{"array": [1]}'],
)
def test_damaged_serialised_state_is_refused_by_the_next_step(raw: Raw, data: bytes) -> None:
    slave = raw.start()
    state = slave.deSerializeFMUstate(data)
    slave.setFMUstate(state)
    with pytest.raises(FMICallException, match="discard"):
        slave.doStep(0.0, 0.1)


@pytest.mark.parametrize("say", ["raise", "nan", "exit", "bad output", "nul"])
def test_a_component_that_fails_discards_its_step(raw: Raw, say: str, capfd) -> None:
    slave = raw.start(u=1.0)
    slave.setString([raw.vr["say"]], [say])
    slave.getString([raw.vr["said"]])  # never raises: an error waits for the step
    with pytest.raises(FMICallException, match="status 2"):
        slave.doStep(0.0, 0.1)
        slave.getString([raw.vr["said"]])
        slave.doStep(0.1, 0.1)
    said = capfd.readouterr().out
    expected = {
        "raise": "ValueError: 100% broken %s %d",
        "nan": "output total is nan at t = 0.1 s",
        "exit": "SystemExit: 3",
        "bad output": "RuntimeError: outputs cannot be had",
        "nul": "no C text",
    }[say]
    assert expected in said
    if say == "raise":
        assert "counter.py" in said  # the traceback names the user's file
    slave.reset()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 0.1)
    assert slave.getInteger([raw.vr["steps"]]) == [1]


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (lambda s, vr: s.setReal([vr["gain"]], [2.0]), "gain is a fixed parameter"),
        (lambda s, vr: s.setReal([vr["total"]], [2.0]), "total is an output"),
        (lambda s, vr: s.setReal([vr["u"]], [float("nan")]), "u: nan is not a finite number"),
        (lambda s, vr: s.setInteger([vr["u"]], [2]), "u is of type float, not int"),
        (lambda s, vr: s.setReal([10_000], [2.0]), "no variable with value reference 10000"),
        (lambda s, vr: s.getReal([vr["steps"]]), "steps is of type int, not float"),
    ],
)
def test_wrong_calls_are_reported_by_the_next_step(raw: Raw, setting, message: str, capfd) -> None:
    slave = raw.start()
    setting(slave, raw.vr)
    with pytest.raises(FMICallException, match="status 2"):
        slave.doStep(0.0, 0.1)
    assert message in capfd.readouterr().out


def test_parameter_outside_its_range_is_reported(raw: Raw, capfd) -> None:
    slave = raw.instantiate()
    slave.setReal([raw.vr["gain"]], [7.0])
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    assert "gain is 7.0 1, allowed -5.0 to 5.0" in capfd.readouterr().out


def test_outputs_follow_inputs_without_a_step(raw: Raw) -> None:
    slave = raw.start(u=3.0)
    assert raw.get("through") == pytest.approx(0.3, abs=1e-15)
    slave.setReal([raw.vr["knob"]], [2.0])
    assert raw.get("through") == pytest.approx(0.6, abs=1e-15)


def test_time_is_snapped_to_the_grid(write, tmp_path: Path) -> None:
    from .conftest import source

    file = write(
        "clock.py",
        "from seatrial.model.component import Component, Output\n\n\n"
        "class Clock(Component):\n"
        '    """Shows the time it was given."""\n\n'
        '    t = Output("s", "time")\n\n'
        "    def outputs(self, t):\n        self.t = t\n",
    )
    raw = Raw(build_fmu(source(file, "Clock"), tmp_path / "clock.fmu"), tmp_path / "clock")
    slave = raw.start()
    t = 0.0
    for k in range(1, 30_001):
        slave.doStep(t, 0.01)
        t += 0.01  # what a naive host does: it misses the grid
        assert raw.get("t") == k / 100
    assert t != 300.0
    slave.freeInstance()


def test_baked_start_values_are_defaults_and_in_the_description(
    counter: ComponentSource, tmp_path: Path
) -> None:
    values = {"gain": 0.7, "bias": [5.0, 6.0], "label": "baked"}
    path = build_fmu(counter, tmp_path / "baked.fmu", values)
    raw = Raw(path, tmp_path / "baked")
    slave = raw.start(u=10.0)
    assert raw.get("through") == 7.0
    assert raw.get("bias.b") == 6.0
    assert slave.getString([raw.vr["label"]]) == [b"baked"]
    starts = {v.name: v.start for v in raw.description.modelVariables}
    assert (starts["gain"], starts["bias.a"], starts["label"]) == ("0.7", "5.0", "baked")
    slave.freeInstance()


@pytest.mark.interop
def test_two_hundred_lives_leave_nothing_behind(counter_fmu: Path, tmp_path: Path) -> None:
    raw = Raw(counter_fmu, tmp_path / "raw")
    path_before = list(sys.path)

    def live() -> None:
        slave = raw.start(u=1.0)
        slave.doStep(0.0, 0.1)
        slave.freeInstance()

    for _ in range(20):
        live()
    gc.collect()
    files, memory = len(os.listdir("/proc/self/fd")), _resident()
    for _ in range(200):
        live()
    gc.collect()
    assert len(os.listdir("/proc/self/fd")) == files
    # pythonfmu's binary keeps the script's class of each instantiation, some 10 kB.
    assert _resident() - memory < 200 * 30_000
    assert sys.path == path_before


def _resident() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
