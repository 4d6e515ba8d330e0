"""FMUs in processes of their own: the same values, and every way in which a process ends."""

from __future__ import annotations

import logging
import math
import os
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from seatrial.errors import DiscardError, InputError, SimulationError
from seatrial.fmi.building.export import build_fmu
from seatrial.fmi.interfaces.loaded import LoadedFmu
from seatrial.fmi.isolation.isolated import IsolatedInstance
from seatrial.fmi.loading.load import load_fmu, open_instance

from . import crashing
from .conftest import source
from .native import build_native_fmu, started

EVERYTHING = ["real", "integer", "boolean", "string"]
INPUTS = [f"{name}_in" for name in EVERYTHING]
Opener = Callable[..., IsolatedInstance]


@pytest.fixture(scope="session")
def crash_fmu(tmp_path_factory: pytest.TempPathFactory, _cache: None) -> LoadedFmu:
    return load_fmu(build_native_fmu("crash", tmp_path_factory.mktemp("crash")))


@pytest.fixture
def python_fmu(write, tmp_path: Path) -> LoadedFmu:
    component = source(write("crashing.py", crashing.CRASHING), "Crashing")
    return load_fmu(build_fmu(component, tmp_path / "crashing.fmu"))


@pytest.fixture
def opened() -> Iterator[Opener]:
    """Return a function that opens an FMU in a process and starts it at 0 s."""
    instances = []

    def opened(fmu: LoadedFmu, timeout_s: float = 60.0, **start: object) -> IsolatedInstance:
        instance = IsolatedInstance(fmu, "boat", timeout_s)
        instances.append(instance)
        started(instance, **start)
        return instance

    yield opened
    for instance in instances:
        instance.free()


def same_refusal(fmu: LoadedFmu, kind: type[Exception]) -> str:
    """Return what opening an FMU raises, the same text here and in a process of its own."""
    texts = []
    for opening in (open_instance, IsolatedInstance):
        with pytest.raises(kind) as error:
            opening(fmu, "boat", *([60.0] if opening is IsolatedInstance else []))
        texts.append(str(error.value))
    assert texts[0] == texts[1]
    return texts[0]


def run(instance: IsolatedInstance, stop: float = 1.0) -> None:
    for k in range(round(stop / 0.1)):
        instance.step(k * 0.1, 0.1)


def test_values_are_those_of_the_same_fmu_in_this_process(counter_fmu: Path) -> None:
    names = ["total", "through", "steps", "was_on", "said"]
    fmu = load_fmu(counter_fmu)
    records = []
    for instance in (open_instance(fmu, "a"), IsolatedInstance(fmu, "b", 60.0)):
        instance.set_start({"gain": 0.3, "bias.a": 0.1, "u": 1 / 3, "on": True, "say": "água"})
        instance.initialise(0.0, 1.0)
        instance.begin()
        read, write = instance.reader(names), instance.writer(["u", "many", "knob", "say"])
        real = instance.reader(names[:2])
        rows = [read()]
        for k in range(40):
            write([k / 7.0, k, 1.0 + k, f"{k} ñ"])
            instance.step(k * 0.02, 0.02)
            rows.append([*read(), *real()])
            if k % 3 == 0:
                write([0.5, k, 2.0, "between"])
                rows.append([*real(), *read()])
            if k == 20:
                state = instance.get_state()
        instance.set_state(state)
        rows.append(read())
        instance.step(21 * 0.02, 0.02)
        rows.append(read())
        instance.free_state(state)
        instance.terminate()
        instance.free()
        records.append(rows)
        records.append([instance.rolls_back, instance.any_step, dict(instance.feedthrough)])
    assert records[:2] == records[2:]
    assert records[0][-2][2] == 21


@pytest.mark.parametrize(
    "bits", [0x8000000000000000, 1, 0x7FF8000000000123, 0xFFF0000000000000, 0x3FB999999999999A]
)
def test_every_bit_of_a_real_number_arrives(bits: int, opened: Opener, crash_fmu) -> None:
    instance = opened(crash_fmu)
    (value,) = struct.unpack("<d", struct.pack("<Q", bits))
    instance.writer(["real_in"])([value])
    instance.step(0.0, 0.1)
    assert struct.pack("<d", *instance.reader(["real"])()) == struct.pack("<Q", bits)


@pytest.mark.slow
def test_every_type_of_fmi_3_crosses(opened: Opener, tmp_path: Path) -> None:
    fmu = load_fmu(build_native_fmu("fmi3", tmp_path / "fmi3"))
    inputs = [v for v in fmu.variables.values() if v.name.startswith("in_")]
    outputs = [v.name for v in fmu.variables.values() if v.name.startswith("out_")]
    some = {float: 0.5, int: 1, bool: True, str: "ñ\n", bytes: b"\0\xff\0"}
    greatest = [v.integers[1] if v.type is int and not v.items else some[v.type] for v in inputs]
    rows = []
    for one in (started(open_instance(fmu, "a")), opened(fmu)):
        write, read = one.writer([v.name for v in inputs]), one.reader(outputs)
        for k, values in enumerate(([some[v.type] for v in inputs], greatest)):
            write(values)
            rows.append(read())
            one.step(k * 0.1, 0.1)
            rows.append(read())
        one.free()
    assert rows[:4] == rows[4:]
    assert {type(value) for value in rows[0]} == {float, int, bool, str, bytes}
    assert max(value for value in rows[2] if type(value) is int) >= 2**63


def test_values_of_every_type_arrive_in_one_reading(opened: Opener, crash_fmu) -> None:
    instance = opened(crash_fmu)
    write, read = instance.writer(INPUTS), instance.reader(EVERYTHING)
    for values in ([-0.0, -(2**31), True, ""], [5e-324, 2**31 - 1, False, "ñ\n" * 60]):
        write(values)
        assert read() == values
        instance.step(0.0, 0.1)
        assert read() == values
    assert math.copysign(1.0, instance.reader(["real"])()[0]) == 1.0


def test_more_than_a_pipe_holds_is_sent_and_answered(counter_fmu: Path, opened: Opener) -> None:
    instance = opened(load_fmu(counter_fmu), timeout_s=20.0)
    text = "é" * 300_000
    instance.writer(["say"])([text])
    assert instance.reader(["said"])() == [text]


@pytest.mark.parametrize(
    ("how", "said"),
    [
        (crashing.SEGFAULT, "was ended by SIGSEGV"),
        (crashing.ABORT, "was ended by SIGABRT"),
        (crashing.EXIT, "exited with status 7"),
    ],
)
def test_a_native_crash_is_an_error_that_names_it(how, said, opened: Opener, crash_fmu) -> None:
    instance = opened(crash_fmu, how=how)
    with pytest.raises(SimulationError) as first:
        run(instance)
    assert f"boat: its process {said} in step(t = 0.30000000000000004 s, h = 0.1 s)" in str(
        first.value
    )
    again = [
        lambda: instance.step(0.4, 0.1),
        lambda: instance.reader(["real"]),
        lambda: instance.writer(["real_in"]),
        instance.get_state,
    ]
    for call in again:
        with pytest.raises(SimulationError) as error:
            call()
        assert str(error.value) == str(first.value)
    instance.terminate()
    instance.free()
    instance.free()


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("exit", "exited with status 3"),
        ("segfault", r"was ended by SIGSEGV.*Segmentation fault.*in end\n"),
        ("kill", "was ended by SIGKILL"),
        ("scribble", "was ended for an answer that is none"),
    ],
)
def test_a_crash_below_python_names_call_and_line(how, said, opened: Opener, python_fmu) -> None:
    instance = opened(python_fmu, how=how)
    instance.writer(["u"])([1.0])
    with pytest.raises(SimulationError, match=f"(?s)^boat: its process {said}") as error:
        run(instance)
    assert "step(t = 0.30000000000000004 s, h = 0.1 s)" in str(error.value)


def test_a_crash_at_the_start_names_the_initialisation(opened: Opener, python_fmu) -> None:
    with pytest.raises(SimulationError, match=r"exited with status 4 in its initialisation"):
        opened(python_fmu, how="at the start")


@pytest.mark.slow
@pytest.mark.parametrize(
    "how",
    ["sleep", *(pytest.param(how, marks=pytest.mark.interop) for how in ("spin", crashing.HANG))],
)
def test_a_call_that_never_returns_is_ended(how, opened: Opener, request) -> None:
    native = isinstance(how, int)
    fmu = request.getfixturevalue("crash_fmu" if native else "python_fmu")
    instance = opened(fmu, timeout_s=5.0, how=how)
    with pytest.raises(SimulationError) as error:
        run(instance)
    assert str(error.value).startswith(
        "boat: its process was ended for not answering within 5 s (the component's key "
        "'timeout') in step(t = 0.30000000000000004 s, h = 0.1 s)"
    )
    assert native or "in end\n" in str(error.value)  # the line of Python that it was in
    with pytest.raises(SimulationError, match="not answering"):
        instance.step(0.4, 0.1)


def test_an_error_of_a_write_is_raised_by_the_next_call(opened: Opener, crash_fmu) -> None:
    instance = opened(crash_fmu)
    write = instance.writer(["real_in"])
    write([-77.0])
    with pytest.raises(SimulationError, match=r"(?s)^boat: .*no such number.*write of real_in"):
        instance.step(0.0, 0.1)
    write([2.0])
    instance.step(0.0, 0.1)
    assert instance.reader(["real"])() == [2.0]


def test_a_reading_that_fails_ahead_is_reported_by_the_reading(opened: Opener, crash_fmu) -> None:
    instance, plain = opened(crash_fmu), open_instance(crash_fmu, "boat")
    texts = []
    for one in (instance, plain):
        write, read = one.writer(["real_in"]), one.reader(["real"])
        for value in (1.0, 2.0):
            write([value])
            one.step(0.0, 0.1)
            assert read() == [value]  # from now on it comes with the step
        write([-78.0])
        one.step(0.0, 0.1)
        with pytest.raises(SimulationError) as error:
            read()
        texts.append(str(error.value))
        one.step(0.1, 0.1)
        write([3.0])
        assert read() == [3.0]  # not what failed ahead
        one.step(0.0, 0.1)
        assert read() == [3.0]
    plain.free()
    assert texts[0] == texts[1]


def test_refused_steps_are_those_of_the_plain_instance(opened: Opener, crash_fmu) -> None:
    instance = opened(crash_fmu, how=crashing.REFUSE)
    plain = open_instance(crash_fmu, "boat")
    texts = []
    for one in (instance, plain):
        one.writer(["how"])([crashing.REFUSE])
        with pytest.raises(DiscardError) as error:
            one.step(0.5, 0.1)
        texts.append(str(error.value))
    plain.free()
    assert texts[0] == texts[1]
    instance.step(0.0, 0.1)


def test_errors_and_interruptions_of_a_component_cross(opened: Opener, python_fmu) -> None:
    with pytest.raises(DiscardError, match=r"(?s)boat.*ValueError: the boat has sunk"):
        run(opened(python_fmu, how="raise"))
    with pytest.raises(KeyboardInterrupt):
        run(opened(python_fmu, how="interrupt"))


def test_an_fmu_that_cannot_be_loaded_says_the_same(crash_fmu: LoadedFmu, tmp_path: Path) -> None:
    broken = tmp_path / "broken.fmu"
    with zipfile.ZipFile(broken, "w") as archive:
        archive.write(crash_fmu.folder / "modelDescription.xml", "modelDescription.xml")
    assert "cannot be loaded on this machine" in same_refusal(load_fmu(broken), InputError)


def test_an_fmu_that_cannot_be_instantiated_says_the_same(python_fmu, monkeypatch) -> None:
    monkeypatch.setenv("NO_BOAT", "1")
    said = same_refusal(python_fmu, SimulationError)
    assert "crashing.fmu could not be instantiated" in said
    assert "there is no boat" in said


def test_messages_keep_their_level_and_order(opened: Opener, crash_fmu, caplog) -> None:
    caplog.set_level(logging.DEBUG, "seatrial.fmu.boat")
    instance = opened(crash_fmu, how=crashing.LOG)
    instance.step(0.25, 0.1)
    instance.step(0.5, 0.1)
    assert [(r.name, r.levelname, r.getMessage()) for r in caplog.records] == [
        ("seatrial.fmu.boat", level, text)
        for t in ("0.25", "0.5")
        for level, text in (("INFO", f"sailing at {t} %"), ("WARNING", "reefing"))
    ]


def test_what_is_printed_reaches_stderr_and_no_frame(
    opened: Opener, crash_fmu, python_fmu, capsys
) -> None:
    run(opened(crash_fmu, how=crashing.PRINT), 0.5)
    run(opened(python_fmu, how="print"), 0.5)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.splitlines() == ["printed at 0.3", "printed at 0.4", *["from Python"] * 2]


def resources() -> tuple[int, list[str], list[str]]:
    """Return the number of open files, the children, and the temporary files."""
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    return len(os.listdir("/proc/self/fd")), children, os.listdir(os.environ["TMPDIR"])


@pytest.mark.slow
@pytest.mark.parametrize("cycles", [5, pytest.param(200, marks=pytest.mark.long)])
def test_nothing_is_left_of_instances(cycles: int, crash_fmu, tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    before = resources()
    for k in range(cycles):
        instance = IsolatedInstance(crash_fmu, "boat", 60.0)
        instance.initialise(0.0, 1.0)
        instance.begin()
        if k % 2:
            instance.writer(["how"])([crashing.EXIT])
            with pytest.raises(SimulationError):
                instance.step(0.5, 0.1)
        instance.free()
    assert resources() == before


def test_other_systems_are_refused(crash_fmu, monkeypatch) -> None:
    monkeypatch.setattr("seatrial.fmi.isolation.isolated.os.name", "nt")
    with pytest.raises(InputError, match="POSIX"):
        IsolatedInstance(crash_fmu, "boat", 60.0)
