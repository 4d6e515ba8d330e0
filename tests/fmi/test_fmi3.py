"""FMI 3.0 FMUs of others: every type, arrays, early return, events, closed forms, rollback."""

from __future__ import annotations

import math
from pathlib import Path

import fmpy
import numpy as np
import pytest

from seatrial.errors import DiscardError, SimulationError
from seatrial.fmi.files.options import FmuOptions
from seatrial.fmi.files.scalars import INTEGERS
from seatrial.fmi.loading.load import load_fmu, open_instance

from .native import changed, read, started, without_events

NO_EVENTS = ('hasEventMode="true"', 'hasEventMode="false"')


@pytest.fixture(params=["events", "no events", "refused events"])
def path(request, native_fmu, tmp_path: Path) -> Path:
    """The slave as it is, as one that has no event mode, and as one that only says it has."""
    if request.param == "events":
        return native_fmu("fmi3")
    if request.param == "refused events":
        return without_events(native_fmu("fmi3"), tmp_path / "fmi3.fmu")
    return changed(native_fmu("fmi3"), tmp_path / "fmi3.fmu", NO_EVENTS)


@pytest.fixture
def fmi3(path: Path):
    """Return a function that makes a started instance with start values."""
    opened = []

    def start(**values):
        opened.append(open_instance(load_fmu(path), "boat"))
        return started(opened[-1], **values)

    yield start
    for instance in opened:
        instance.free()


def test_decay_is_exact_and_equal_to_fmpys_own_simulation(fmi3, path: Path) -> None:
    result = fmpy.simulate_fmu(
        str(path), stop_time=2.0, output_interval=0.1, start_values={"k": 1.3}, output=["x"],
        early_return_allowed=True,
    )  # fmt: skip
    instance = fmi3(k=1.3)
    own = read(instance, "x_again")
    for step in range(20):
        instance.step(step * 0.1, 0.1)
        own += read(instance, "x")
    assert own[-1] == pytest.approx(math.exp(-2.6), rel=1e-13)
    assert np.allclose(result["x"], own, rtol=1e-12, atol=0)
    instance.terminate()


VALUES = {
    "Float32": ([1.5, -2.25, 2.0**-100], lambda v: 2 * v),
    "Float64": ([0.1, -1e300, 3.0], lambda v: 2 * v),
    **{name: ([1, high // 2, low // 2], lambda v: 2 * v) for name, (low, high) in INTEGERS.items()},
    "Boolean": ([True, False, True], lambda v: not v),
    "String": (["água", "", 'a "b"\n'], lambda v: v),
    "Binary": ([b"\x00\xff\x01", b"", b"abc"], lambda v: v[::-1]),
}


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("when", ["before", "while stepping"])
def test_arrays_of_every_type(name: str, when: str, fmi3) -> None:
    values, expected = VALUES[name]
    inputs = [f"in_{name}[{k}]" for k in (1, 2, 3)]
    if when == "before":
        instance = fmi3(**dict(zip(inputs, values, strict=True)))
    else:
        instance = fmi3()
        instance.writer(inputs)(values)
    outputs = [f"out_{name}[{k}]" for k in (3, 1, 2)]
    found = read(instance, *outputs)
    assert found == [expected(values[k]) for k in (2, 0, 1)]
    assert {type(v) for v in found} == {type(values[0])}
    assert read(instance, *inputs) == values


def test_a_few_elements_keep_the_others(fmi3) -> None:
    instance = fmi3(**{"in_Int16[2]": 5, "matrix[3,1]": 3.0})
    for names, values in (
        (["matrix[1,2]"], [1.0]),
        (["matrix[2,1]", "in_Int16[1]"], [2.0, 7]),
        (["matrix[1,2]"], [9.0]),
    ):
        instance.writer(names)(values)
    assert read(instance, *(f"out_Int16[{k}]" for k in (1, 2, 3))) == [14, 10, 0]
    assert read(instance, *(f"transpose[{c},{r}]" for c in (1, 2) for r in (1, 2, 3))) == [
        0.0, 2.0, 3.0, 9.0, 0.0, 0.0,
    ]  # fmt: skip


def test_a_rollback_takes_the_inputs_back_too(fmi3) -> None:
    instance = fmi3()
    write = instance.writer(["in_Int16[1]", "matrix[1,1]"])
    write([1, 1.0])
    state = instance.get_state()
    write([2, 2.0])
    instance.step(0.0, 0.1)
    instance.set_state(state)
    assert read(instance, "out_Int16[1]", "transpose[1,1]", "x") == [2, 1.0, 1.0]
    write([2, 2.0])  # not the same as before, as far as the FMU knows
    instance.writer(["matrix[1,2]"])([3.0])
    assert read(instance, "out_Int16[1]", "transpose[1,1]", "transpose[2,1]") == [4, 2.0, 3.0]
    instance.free_state(state)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("in_UInt8[1]", 300, r"boat\.in_UInt8\[1\]: 300 does not fit its type, 0 to 255"),
        ("in_UInt64[3]", -1, "does not fit"),
        ("in_Int64[1]", 2**63, "does not fit"),
        ("in_Float32[2]", 1e39, r"1e\+39 does not fit its type, Float32"),
        ("in_String[2]", "a\0b", "is no C text"),
    ],
)
def test_what_c_would_cut_is_refused(fmi3, name: str, value, message: str) -> None:
    instance = fmi3()
    with pytest.raises(SimulationError, match=message):
        instance.writer([name])([value])


def test_what_the_description_says(native_fmu) -> None:
    fmu = load_fmu(native_fmu("fmi3"))
    assert fmu.variables["in_Mode"].items == {"drift": 1, "sail": 5_000_000_000}
    assert fmu.variables["rows"].causality == "structuralParameter"
    assert fmu.variables["matrix[3,2]"].start == 0.0
    assert "matrix[4,1]" not in fmu.variables
    assert "tick" not in fmu.variables
    (note,) = fmu.notes
    assert note.startswith("clocks that are local, ")
    assert note.endswith(" are no signals: tick")
    assert fmu.feedthrough["transpose[2,3]"] == [
        f"matrix[{r},{c}]" for r in (1, 2, 3) for c in (1, 2)
    ]
    assert "x" not in fmu.feedthrough


# ---------------------------------------------------------------------- events


def test_stairs_rise_at_their_instants(fmi3, request) -> None:
    instance = fmi3(stair=0.25)
    for step in range(20):
        instance.step(step * 0.1, 0.1)
        assert read(instance, "steps") == [math.floor((step + 1) * 0.1 / 0.25 + 1e-9)]
    assert read(instance, "x") == [pytest.approx(math.exp(-2.0), rel=1e-13)]
    has_events = request.node.callspec.params["path"] == "events"
    assert read(instance, "events") == [8 if has_events else 0]


def bouncing(t: float, restitution: float) -> tuple[float, float]:
    """Height and speed of a ball dropped from 1 m, by the times of its bounces."""
    g, v = 9.81, math.sqrt(2 * 9.81)
    if t < v / g:
        return 1 - g / 2 * t * t, -g * t
    t -= v / g
    while True:
        v *= restitution
        if t < 2 * v / g:
            return v * t - g / 2 * t * t, v - g * t
        t -= 2 * v / g


@pytest.mark.parametrize("h", [0.01, 0.37, 2.0])
def test_a_ball_bounces_in_any_step(fmi3, h: float) -> None:
    """The largest step has four bounces in it."""
    instance = fmi3(restitution=0.8)
    for step in range(round(2.0 / h)):
        instance.step(step * h, h)
        height, speed = bouncing((step + 1) * h, 0.8)
        assert read(instance, "height", "speed") == [
            pytest.approx(height, abs=1e-9),
            pytest.approx(speed, abs=1e-9),
        ]


def test_early_returns_are_gone_on_from(fmi3) -> None:
    instance = fmi3(longest_step=0.03)
    for step in range(10):
        instance.step(step * 0.1, 0.1)
    assert read(instance, "x") == [pytest.approx(math.exp(-1.0), rel=1e-13)]


def test_a_step_that_gets_no_further_ends(fmi3) -> None:
    instance = fmi3(longest_step=-1.0)
    with pytest.raises(
        SimulationError, match=r"returned early 10000 times and got no further than 0\.0 s"
    ):
        instance.step(0.0, 0.1)


@pytest.mark.parametrize("status", [-2, -7])
def test_a_status_that_fmi_does_not_have_is_an_error(fmi3, status: int) -> None:
    instance = fmi3(longest_step=float(status))
    with pytest.raises(SimulationError, match=f"returned status {status}, which FMI does not have"):
        instance.step(0.0, 0.1)


def test_an_event_that_never_ends(native_fmu) -> None:
    instance = open_instance(load_fmu(native_fmu("fmi3")), "boat")
    with pytest.raises(SimulationError, match="boat: an event is not over after 1000 calls"):
        started(instance, restless=True)
    instance.free()


def test_inputs_that_change_together_are_one_event(native_fmu) -> None:
    instance = started(open_instance(load_fmu(native_fmu("fmi3")), "boat"))
    discrete, continuous = ["in_Int8[1]", "in_Boolean[2]", "gain"], ["in_Float64[1]"]
    write, flow = instance.writer(discrete), instance.writer(continuous)
    write([1, True, 2.0])
    instance.writer(["in_String[1]"])(["x"])
    flow([1.0])
    assert read(instance, "events", "out_Int8[1]", "out_Float64[1]") == [1, 2, 2.0]
    write([1, True, 2.0])
    flow([2.0])
    instance.step(0.0, 0.1)
    assert read(instance, "events") == [1]  # nothing discrete has changed
    write([1, True, 3.0])
    assert read(instance, "events", "out_Float64[1]") == [2, 6.0]
    instance.free()


def test_an_fmu_that_wants_to_end(fmi3) -> None:
    instance = fmi3(end_time=0.15)
    instance.step(0.0, 0.1)
    state = instance.get_state()
    assert instance.ended_at is None
    instance.step(0.1, 0.1)
    assert instance.ended_at == pytest.approx(0.2)
    assert read(instance, "x") == [pytest.approx(math.exp(-0.2))]
    instance.step(0.2, 0.1)  # it stands
    assert read(instance, "x") == [pytest.approx(math.exp(-0.2))]
    instance.set_state(state)
    assert instance.ended_at is None
    instance.free_state(state)


# ---------------------------------------------------------------------- structural parameters


def test_sizes_follow_structural_parameters(native_fmu) -> None:
    fmu = load_fmu(native_fmu("fmi3"), FmuOptions(structure={"rows": 2}))
    assert [v.name for v in fmu.variables.ports["matrix"]] == [
        "matrix[1,1]", "matrix[1,2]", "matrix[2,1]", "matrix[2,2]",
    ]  # fmt: skip
    assert fmu.variables["matrix[1,1]"].start is None  # the FMU says those of three rows
    assert fmu.variables["rows"].start == 2
    assert "transpose[1,3]" not in fmu.variables
    instance = started(open_instance(fmu, "boat"), rows=2, **{"matrix[2,1]": 5.0})
    assert read(instance, "rows") == [2]
    instance.writer(["matrix[1,1]", "matrix[1,2]"])([1.0, 2.0])
    assert read(instance, *(f"transpose[{c},{r}]" for c in (1, 2) for r in (1, 2))) == [
        1.0, 5.0, 2.0, 0.0,
    ]  # fmt: skip
    instance.free()


def test_a_size_that_the_fmu_refuses(native_fmu) -> None:
    fmu = load_fmu(native_fmu("fmi3"), FmuOptions(structure={"rows": 9}))
    with pytest.raises(SimulationError, match=r"fmi3ExitConfigurationMode .*too many rows"):
        open_instance(fmu, "boat")


def test_a_discarded_step(fmi3) -> None:
    instance = fmi3(largest_step=0.1)
    state = instance.get_state()
    with pytest.raises(DiscardError, match="returned discard: the step is too large"):
        instance.step(0.0, 0.2)
    instance.set_state(state)
    instance.step(0.0, 0.1)
    instance.free_state(state)


def test_an_instance_that_cannot_be_made(native_fmu, tmp_path: Path) -> None:
    path = changed(native_fmu("fmi3"), tmp_path / "x.fmu", ("{fmi3}", "{other}"))
    with pytest.raises(
        SimulationError, match=r"x\.fmu could not be instantiated: early return and"
    ):
        open_instance(load_fmu(path), "boat")
