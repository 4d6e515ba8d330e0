"""FMI 2.0 FMUs of others: every type, closed forms, FMPy's own simulation, statuses, rigs."""

from __future__ import annotations

import logging
import math
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seatrial.errors import DiscardError, FatalError, InputError, SimulationError
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import changed, lacking, read, started

FINE, NAN, DISCARD, ERROR, FATAL, WARN, BAD_START, NEGATIVE, BEYOND = range(9)


@pytest.fixture
def fmi2(native_fmu):
    """Return a function that makes a started instance with start values."""
    opened = []

    def start(**values):
        opened.append(open_instance(load_fmu(native_fmu("fmi2")), "boat"))
        return started(opened[-1], **values)

    yield start
    for instance in opened:
        instance.free()


def test_decay_is_exact(fmi2) -> None:
    instance = fmi2(k=0.7)
    for step in range(50):
        instance.step(step * 0.1, 0.1)
    assert read(instance, "x") == [pytest.approx(math.exp(-0.7 * 5.0), rel=1e-13)]
    instance.terminate()


def test_equal_to_fmpys_own_simulation(fmi2, native_fmu) -> None:
    values = {"k": 1.3, "internal_step": 0.025}
    result = fmpy.simulate_fmu(
        str(native_fmu("fmi2")),
        stop_time=2.0,
        output_interval=0.1,
        start_values=values,
        output=["x"],
    )
    instance = fmi2(**values)
    own = read(instance, "x")
    for step in range(20):
        instance.step(step * 0.1, 0.1)
        own += read(instance, "x")
    assert np.array_equal(result["x"], own)
    assert own[-1] == pytest.approx((1 - 1.3 * 0.025) ** 80, rel=1e-12)


def test_functions_may_be_missing_until_they_are_called(native_fmu, tmp_path: Path) -> None:
    names = ["fmi2CancelStep", "fmi2GetBooleanStatus", "fmi2SetString", "fmi2GetFMUstate"]
    instance = open_instance(
        load_fmu(lacking(native_fmu("fmi2"), tmp_path / "x.fmu", *names)), "boat"
    )
    try:
        started(instance, k=0.7)
        instance.step(0.0, 0.1)
        assert read(instance, "x") == [pytest.approx(math.exp(-0.07), rel=1e-13)]
        with pytest.raises(
            SimulationError, match="boat: its library has no function fmi2SetString"
        ):
            instance.writer(["s"])(["x"])
        with pytest.raises(SimulationError, match="boat: its library has no function fmi2GetFMUst"):
            instance.get_state()
        instance.writer(["trouble"])([DISCARD])
        with pytest.raises(DiscardError):
            instance.step(0.1, 0.1)
    finally:
        instance.free()
    none = lacking(native_fmu("fmi2"), tmp_path / "y.fmu", "fmi2Instantiate")
    with pytest.raises(SimulationError, match="boat: its library has no function fmi2Instantiate"):
        open_instance(load_fmu(none), "boat")


def test_every_type_goes_through(fmi2) -> None:
    instance = fmi2(gain=3.0)
    names = ["q[1]", "s", "i", "u", "b", "mode_in", "q[2]"]
    instance.writer(names)([1.5, "água 100%", -7, 2.0, True, 2, -1.5])
    outputs = ["p[2]", "r", "j", "y", "c", "mode", "p[1]"]
    assert read(instance, *outputs) == [-4.5, "água 100%", -14, 6.0, False, 2, 4.5]
    assert [type(v) for v in read(instance, *outputs)] == [float, str, int, float, bool, int, float]
    instance.writer(["gain"])([0.5])
    assert read(instance, "y") == [1.0]


def test_variables_have_what_the_description_says(native_fmu) -> None:
    fmu = load_fmu(native_fmu("fmi2"))
    speed, mode, i = (fmu.variables[n] for n in ("speed", "mode_in", "i"))
    assert (speed.unit, speed.minimum, speed.maximum, speed.nominal) == ("knot_x", -50, 50, 5)
    assert mode.items == {"drift": 1, "sail": 2}
    assert (i.integers, i.variability) == ((-(2**31), 2**31 - 1), "discrete")
    assert [v.name for v in fmu.variables.ports["q"]] == ["q[1]", "q[2]"]  # declared the other way
    assert fmu.feedthrough == {
        "y": ["u"], "p[1]": ["q[1]"], "p[2]": ["q[2]"], "echo": ["speed"],
        "j": ["i"], "mode": ["mode_in"], "c": ["b"], "r": ["s"],
    }  # fmt: skip


def test_outputs_without_dependencies_depend_on_all_inputs(native_fmu, tmp_path: Path) -> None:
    silent = changed(
        native_fmu("fmi2"), tmp_path / "silent.fmu", ('<Unknown index="16" dependencies="7"/>', "")
    )
    fmu = load_fmu(silent)
    assert fmu.feedthrough["y"] == [n for n, v in fmu.variables.items() if v.causality == "input"]


@pytest.mark.parametrize(
    ("trouble", "message", "kind"),
    [
        (DISCARD, r"boat: fmi2DoStep\(t = 0\.25 s, h = 0\.25 s\) returned discard: not such a step", DiscardError),
        (ERROR, "returned error: 100% wrong", SimulationError),
        (FATAL, "returned fatal, without a message", FatalError),
        (NEGATIVE, "returned status -1, which FMI does not have", SimulationError),
        (BEYOND, "returned status 6, which FMI does not have", SimulationError),
    ],
)  # fmt: skip
def test_what_a_refused_step_says(fmi2, trouble: int, message: str, kind: type) -> None:
    instance = fmi2(trouble=trouble, trouble_time=0.3)
    instance.step(0.0, 0.25)
    with pytest.raises(kind, match=message) as caught:
        instance.step(0.25, 0.25)
    assert type(caught.value) is kind


def test_nothing_is_asked_of_an_instance_that_returned_fatal(fmi2) -> None:
    instance = fmi2(trouble=FATAL, trouble_time=0.2)
    with pytest.raises(FatalError, match="returned fatal, without a message"):
        instance.step(0.0, 0.25)
    for call in (lambda: read(instance, "x"), lambda: instance.writer(["k"]), instance.get_state):
        with pytest.raises(FatalError, match="boat: it has returned fatal"):
            call()
    instance.terminate()


def test_a_bad_start_and_a_warning(fmi2, caplog) -> None:
    with pytest.raises(
        SimulationError, match="fmi2EnterInitializationMode returned error: there is no start"
    ):
        fmi2(trouble=BAD_START)
    with caplog.at_level(logging.INFO, "seatrial.fmu.boat"):
        fmi2(trouble=WARN).step(0.0, 0.1)
    assert [(r.levelname, r.message) for r in caplog.records] == [("WARNING", "reefing")]


def test_too_large_a_step_is_tried_again_in_smaller_ones(fmi2) -> None:
    instance = fmi2(largest_step=0.1)
    state = instance.get_state()
    with pytest.raises(DiscardError, match="the step is too large"):
        instance.step(0.0, 0.2)
    instance.set_state(state)
    for step in range(2):
        instance.step(step * 0.1, 0.1)
    assert read(instance, "x") == [pytest.approx(math.exp(-0.2), rel=1e-14)]
    instance.set_state(state)  # the handle stays valid
    assert read(instance, "x") == [1.0]
    instance.free_state(state)


@pytest.mark.parametrize("can", ["true", "false"])
def test_the_fmu_is_notified_of_what_the_master_will_do(
    can: str, native_fmu, tmp_path: Path
) -> None:
    """Not of what it can do itself."""
    path = changed(
        native_fmu("fmi2"), tmp_path / "x.fmu", ('FMUstate="true"', f'FMUstate="{can}"'),
        ('StepSize="true"', f'StepSize="{can}"'),
    )  # fmt: skip
    instance = started(open_instance(load_fmu(path), "x"))
    assert (instance.rolls_back, instance.any_step) == (can == "true", can == "true")
    instance.step(0.0, 0.1)
    assert read(instance, "never_back") == [1]
    instance.goes_back(True)
    instance.step(0.1, 0.1)
    assert read(instance, "never_back") == [0]
    instance.free()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("i", 2**31, f"boat.i: {2**31} does not fit its type, {-(2**31)} to {2**31 - 1}"),
        ("mode_in", -(2**31) - 1, "does not fit"),
        ("s", "a\0b", "is no C text"),
        ("s", "\ud800", "is no C text"),
    ],
)
def test_what_c_would_cut_is_refused(fmi2, name: str, value, message: str) -> None:
    instance = fmi2()
    before = read(instance, name)
    with pytest.raises(SimulationError, match=message):
        instance.writer([name])([value])
    assert read(instance, name) == before


def test_a_missing_binary_is_named_with_those_there(native_fmu, tmp_path: Path) -> None:
    other_machine = changed(
        native_fmu("fmi2"), tmp_path / "x.fmu", ('Identifier="fmi2"', 'Identifier="y"')
    )
    with pytest.raises(
        InputError,
        match=rf"x\.fmu: binaries/{fmpy.platform} has no y\.so",
    ):
        open_instance(load_fmu(other_machine), "x")
