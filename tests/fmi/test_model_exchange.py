"""Model exchange of every version: closed forms, events at their times, rollback, refusals."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.fmi.files.options import FmuOptions
from seatrial.fmi.instance import Instance
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

from .models import build_model_fmu
from .native import changed, read, started
from .test_fmi3 import bouncing

ME = FmuOptions(interface="model exchange")


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("models")


@pytest.fixture(params=[1, 2, 3])
def version(request) -> int:
    return request.param


@pytest.fixture
def model(version: int, folder: Path):
    """Return a function that makes a started instance with start values."""
    opened: list[Instance] = []

    def start(options: FmuOptions = ME, **values: object) -> Instance:
        fmu = load_fmu(build_model_fmu(version, folder), options)
        opened.append(open_instance(fmu, "boat"))
        return started(opened[-1], **values)

    yield start
    for instance in opened:
        instance.free()


def stepped(instance: Instance, h: float, count: int, first: int = 0) -> Instance:
    for k in range(first, first + count):
        instance.step(k * h, h)
    return instance


@pytest.mark.parametrize("h", [0.01, 0.1, 2.0])
def test_decay_and_bounces_follow_their_closed_forms(model, h: float) -> None:
    instance = model(k=1.3)
    for k in range(round(2.0 / h)):
        instance.step(k * h, h)
        t = (k + 1) * h
        height, speed = bouncing(t, 0.8)
        assert read(instance, "x", "height", "speed") == [
            pytest.approx(math.exp(-1.3 * t), abs=1e-6),
            pytest.approx(height, abs=1e-5),
            pytest.approx(speed, abs=2e-5),
        ]
    assert read(instance, "steps") == [8]
    instance.terminate()


def test_events_come_at_their_times_whatever_the_step(model) -> None:
    instance = model()
    for k in range(20):
        instance.step(k * 0.1, 0.1)
        assert read(instance, "steps") == [math.floor((k + 1) * 0.1 / 0.25 + 1e-9)]


def test_inputs_that_change_are_an_event_and_reach_outputs_at_once(model) -> None:
    instance = model()
    write = instance.writer(["u"])
    instance.step(0.0, 0.1)
    write([0.7])
    assert read(instance, "relay", "y") == [1, pytest.approx(1.4)]
    (events,) = read(instance, "events")
    write([0.7])
    stepped(instance, 0.1, 1, 1)
    assert read(instance, "events") == [events]
    write([0.2])
    assert read(instance, "relay", "events") == [0, events + 1]


def test_every_type(model) -> None:
    instance = model(flag=True, text="água")
    assert read(instance, "flag", "not_flag", "echo") == [True, False, "água"]
    instance.step(0.0, 0.1)
    instance.writer(["flag"])([False])
    instance.writer(["text"])(["b"])
    assert read(instance, "flag", "not_flag", "echo") == [False, True, "b"]


def test_a_step_event(model) -> None:
    quiet, asking = stepped(model(), 0.1, 2), stepped(model(trouble=3.0), 0.1, 2)
    (before,), (after,) = read(quiet, "events"), read(asking, "events")
    assert after == before + 1


def test_tolerance_is_that_of_the_rig(model) -> None:
    rough = stepped(model(FmuOptions("model exchange", tolerance=1e-2)), 1.0, 1)
    fine = stepped(model(FmuOptions("model exchange", tolerance=1e-11)), 1.0, 1)
    errors = [abs(read(one, "x")[0] - math.exp(-1.0)) for one in (rough, fine)]
    assert errors[0] > 1e-6
    assert errors[1] < 1e-9


def test_an_error_of_the_equations_ends_the_step_with_its_message(model) -> None:
    instance = stepped(model(trouble=1.0), 0.1, 4)
    with pytest.raises(SimulationError, match="Derivatives returned error: no derivatives here"):
        stepped(instance, 0.1, 4, 4)


def test_equations_that_cannot_be_computed_end_the_step(model) -> None:
    instance = stepped(model(trouble=2.0), 0.1, 7)
    with pytest.raises(SimulationError, match=r"boat: the solver cannot go on at t = 0\.7"):
        stepped(instance, 0.1, 1, 7)


def test_an_event_that_does_not_end(model) -> None:
    with pytest.raises(SimulationError, match="boat: an event is not over after 1000 calls of fmi"):
        stepped(model(trouble=4.0), 0.1, 4)


def test_a_model_ends_the_simulation_at_its_time(model) -> None:
    instance = stepped(model(end=0.42), 0.1, 4)
    assert instance.ended_at is None
    stepped(instance, 0.1, 2, 4)
    assert instance.ended_at == pytest.approx(0.42)
    assert read(instance, "x") == [pytest.approx(math.exp(-0.42), abs=1e-6)]
    instance.terminate()


@pytest.mark.parametrize("version", [2, 3], indirect=True)
def test_rollback_gives_the_same_again(model) -> None:
    instance = stepped(model(), 0.1, 3)
    assert instance.rolls_back
    state = instance.get_state()
    names = ("x", "height", "speed", "steps", "events")
    first = read(stepped(instance, 0.1, 7, 3), *names)
    instance.set_state(state)
    assert read(stepped(instance, 0.1, 7, 3), *names) == first
    instance.free_state(state)


@pytest.mark.parametrize("version", [1], indirect=True)
def test_fmi_1_does_not_roll_back(model) -> None:
    assert not model().rolls_back


def test_isolated_it_gives_the_same(model, version: int, folder: Path) -> None:
    plain = stepped(model(k=0.7), 0.1, 5)
    fmu = load_fmu(build_model_fmu(version, folder), ME)
    isolated = IsolatedInstance(fmu, "boat", 60.0)
    try:
        stepped(started(isolated, k=0.7, end=0.6), 0.1, 5)
        assert read(isolated, "x", "height", "steps") == read(plain, "x", "height", "steps")
        assert isolated.ended_at is None
        stepped(isolated, 0.1, 3, 5)
        assert isolated.ended_at == pytest.approx(0.6)
        isolated.terminate()
    finally:
        isolated.free()


def test_both_interfaces_are_co_simulation_unless_said(folder: Path) -> None:
    path = build_model_fmu(2, folder)
    assert load_fmu(path).interface == "co-simulation"
    assert load_fmu(path, ME).interface == "model exchange"
    assert load_fmu(build_model_fmu(3, folder)).interface == "model exchange"


def test_what_the_fmu_does_not_have_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"model3\.fmu has no co-simulation, only model exchange"):
        load_fmu(build_model_fmu(3, folder), FmuOptions("co-simulation"))


def test_the_fmu_may_say_the_tolerance(folder: Path, tmp_path: Path) -> None:
    path = changed(
        build_model_fmu(2, folder),
        tmp_path / "rough.fmu",
        ("<ModelVariables>", '<DefaultExperiment tolerance="1e-2"/><ModelVariables>'),
    )
    instance = stepped(started(open_instance(load_fmu(path, ME), "boat")), 1.0, 1)
    assert abs(read(instance, "x")[0] - math.exp(-1.0)) > 1e-6
    instance.free()
