"""The life of a component: values, phases, time, state, noise."""

from __future__ import annotations

import copy
import json
import math
from collections import namedtuple
from fractions import Fraction
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from seatrial.errors import InputError, SimulationError
from seatrial.model.component import (
    NS,
    Component,
    Input,
    Noise,
    Output,
    Parameter,
    seconds,
)
from seatrial.model.sampled import Sampled


class Lag(Component):
    """Counts its calls; half of its state is in attributes that are no ports."""

    gain = Parameter(2.0, "1", "gain", min=0.0)
    trim = Parameter(0.5, "1", "trim", tunable=True, min=-1.0, max=1.0)
    mode = Parameter("a", "1", "mode", tunable=True, choices=("a", "b"))
    u = Input("m", "input", axes="xyz")
    v = Input("m", "second input")
    many = Input("1", "count", type=int)
    y = Output("m", "output", axes="xyz")
    seen = Output("m", "v")
    started = Output("1", "starts", type=int)
    feedthrough: ClassVar = {"y": ("u",), "seen": ("v",)}

    def __init__(self, name: str = "lag") -> None:
        super().__init__(name)
        self.starts = 0
        self.computed: list[float] = []

    def start(self, t):
        self.starts += 1
        self.x = self.gain

    def step(self, t, h):
        self.x += self.trim * h * sum(self.u)

    def outputs(self, t):
        self.computed.append(t)
        self.y = [self.x + u for u in self.u]
        self.seen = self.v
        self.started = self.starts


def running(cls: type[Component] = Lag, name: str = "it") -> Component:
    component = cls(name)
    component.initialise()
    component.begin()
    return component


# ---------------------------------------------------------------------- set and get


def test_a_port_whole_or_one_scalar() -> None:
    component = running()
    component.set("u", (1.0, 2.0, 3.0))
    component.set("u.y", 5)
    assert component.get("u") == [1.0, 5.0, 3.0]
    assert component.get("u.z") == 3.0
    assert component.get("y") == [3.0, 7.0, 5.0]
    assert component.get("y.x") == 3.0


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("sene", r"did you mean 'seen'\?"),
        ("modes", r"did you mean 'mode'\?"),
        ("u.w", r"did you mean 'u\.[xyz]' or 'u\.[xyz]'\?"),
        ("thrust", r"\(known: gain, many, mode, seen, started, trim, u, u\.x"),
    ],
)
def test_unknown_names_have_near_misses(name: str, hint: str) -> None:
    component = running()
    for ask in (lambda: component.get(name), lambda: component.set(name, 1.0)):
        with pytest.raises(InputError, match=f"unknown port '{name}'.*{hint}"):
            ask()


def test_one_call_sets_all_or_nothing() -> None:
    component = running()
    component.set("u", [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"it\.u\.y: nan is not a finite number"):
        component.set("u", [9.0, math.nan, 9.0])
    references = [component.scalar_by_name[n].reference for n in ("u.x", "y.x")]
    with pytest.raises(InputError, match=r"y\.x is an output and cannot be set"):
        component.write(references, [9.0, 9.0], float)
    assert component.get("u") == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", ["u.x", "v", "gain"])
def test_numbers_that_are_none_are_refused(bad: float, place: str) -> None:
    component = Lag("it")
    component.initialise()
    with pytest.raises(InputError, match=rf"it\.{place}: {bad} is not a finite number"):
        component.set(place, bad)


def test_two_infinities_do_not_hide_each_other_and_large_numbers_may_overflow_a_sum() -> None:
    component = running()
    with pytest.raises(InputError, match=r"u\.x: inf"):
        component.set("u", [math.inf, -math.inf, 0.0])
    component.set("u", [1.7e308, 1.7e308, 1.7e308])
    assert component.get("u") == [1.7e308] * 3


@pytest.mark.parametrize(
    ("references", "kind", "message"),
    [
        ([99], float, "there is no variable with value reference 99"),
        ([-1], float, "there is no variable with value reference -1"),
        (["many"], float, "many is of type int, not float"),
        (["u.x", "mode"], float, "mode is of type str, not float"),
        (["gain"], str, "gain is of type float, not str"),
    ],
)
def test_references_that_do_not_fit(references, kind, message: str) -> None:
    component = Lag("it")
    numbers = [
        r if isinstance(r, int) else component.scalar_by_name[r].reference for r in references
    ]
    for ask in (
        lambda: component.write(numbers, [1.0] * len(numbers), kind),
        lambda: component.read(numbers, kind),
    ):
        with pytest.raises(InputError, match=f"it: {message}"):
            ask()


# ---------------------------------------------------------------------- phases


def test_fixed_parameters_are_refused_once_begun_and_tunable_ones_are_not() -> None:
    component = Lag("it")
    component.set("gain", 3.0)
    component.initialise()
    component.set("gain", 4.0)
    component.begin()
    with pytest.raises(InputError, match="it: gain is a fixed parameter and cannot change once"):
        component.set("gain", 5.0)
    assert component.get("gain") == 4.0
    component.set("trim", -0.5)
    component.set("u.x", 1.0)
    component.advance(0.0, 0.5)
    assert component.get("y.y") == 4.0 - 0.5 * 0.5
    component.set("trim", 1.0)
    component.advance(0.5, 0.5)
    assert component.get("y.y") == 4.0 - 0.25 + 0.5


@pytest.mark.parametrize(
    ("port", "bad", "message"),
    [
        ("trim", 1.5, r"it\.trim is 1\.5 1, allowed -1\.0 to 1\.0"),
        ("mode", "c", "unknown value of mode 'c'"),
    ],
)
def test_tunable_parameters_keep_to_their_limits_in_a_run(port, bad, message: str) -> None:
    component = running()
    before = component.get(port)
    with pytest.raises(InputError, match=message):
        component.set(port, bad)
    component.advance(0.0, 0.1)
    assert component.get(port) == before


def test_a_parameter_set_before_begin_starts_again_and_an_input_does_not() -> None:
    component = Lag("it")
    component.set("gain", 3.0)
    component.initialise()
    assert component.get("started") == 1
    component.set("u", [1.0, 1.0, 1.0])
    assert component.get("y") == [4.0] * 3
    assert component.get("started") == 1
    component.set("gain", 10.0)
    component.set("trim", 0.25)
    assert component.get("y") == [11.0] * 3
    assert component.get("started") == 2  # once for both
    component.set("gain", 20.0)
    component.begin()
    assert component.values[component.ports["started"].offset] == 3  # without being asked
    assert component.get("y") == [21.0] * 3


def test_what_initialise_refused_begin_refuses_until_it_is_repaired() -> None:
    component = Lag("it")
    component.set("gain", -1.0)
    for _ in range(2):
        with pytest.raises(InputError, match="gain"):
            component.initialise()
        for _ in range(2):
            with pytest.raises(InputError, match="gain"):
                component.begin()
            with pytest.raises(InputError, match="gain"):
                component.get("y")
    assert component.starts == 0
    component.set("gain", 1.0)
    component.begin()
    assert component.get("y") == [1.0] * 3


def test_a_component_that_refuses_in_start_keeps_refusing() -> None:
    class Picky(Lag):
        def start(self, t):
            if self.gain > 5:
                raise InputError("too much")
            super().start(t)

    component = Picky("it")
    component.set("gain", 6.0)
    for call in (component.initialise, component.begin, component.begin):
        with pytest.raises(InputError, match="too much"):
            call()
    component.set("gain", 5.0)
    component.begin()
    assert component.get("y.x") == 5.0


def test_before_initialise_reading_gives_start_values_and_runs_nothing() -> None:
    component = Lag("it")
    component.set("v", 2.0)
    assert (component.get("v"), component.get("seen"), component.get("gain")) == (2.0, 0.0, 2.0)
    assert (component.starts, component.computed) == (0, [])


def test_initialised_again_it_starts_over() -> None:
    component = running()
    component.set("u", [1.0, 0.0, 0.0])
    component.advance(0.0, 1.0)
    component.setup(0.0)
    component.initialise()
    assert component.get("y.y") == 2.0
    assert component.now_ns == 0
    component.set("gain", 7.0)  # not begun: fixed parameters are open again
    assert component.get("y.y") == 7.0


# ---------------------------------------------------------------------- outputs


def test_outputs_are_computed_when_something_was_set_and_not_otherwise() -> None:
    component = running()

    def count(action) -> int:
        before = len(component.computed)
        action()
        return len(component.computed) - before

    places = [component.scalar_by_name["y.x"].reference]
    assert count(lambda: component.get("y")) == 0
    assert count(lambda: component.set("v", 1.0)) == 0
    assert count(lambda: component.get("y")) == 1
    assert count(lambda: [component.get("seen"), component.read(places, float)]) == 0
    assert count(lambda: [component.set("v", 2.0), component.set("u.x", 2.0)]) == 0
    assert count(lambda: component.read(places, float)) == 1
    assert count(lambda: component.advance(0.0, 0.1)) == 1
    assert count(lambda: component.get("y")) == 0
    assert count(lambda: component.set("trim", 0.1)) == 0
    assert count(lambda: component.get("y")) == 1
    assert component.computed[-1] == 0.1


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("port", ["single", "vector.b"])
def test_outputs_that_are_no_numbers_name_port_and_time(bad: float, port: str) -> None:
    class Sinks(Component):
        single = Output("m", "one")
        vector = Output("m", "two", axes="ab")

        def step(self, t, h):
            if t >= 0.2:
                name, _, axis = port.partition(".")
                setattr(self, name, [1.0, bad] if axis else bad)

    component = running(Sinks, "boat")
    for k in range(2):
        component.advance(k / 10, 0.1)
    with pytest.raises(SimulationError) as error:
        component.advance(0.2, 0.1)
    assert str(error.value) == f"boat: output {port} is {bad} at t = 0.3 s"


def test_outputs_that_are_no_numbers_are_refused_between_steps_too() -> None:
    class Root(Component):
        u = Input("m2", "input", start=4.0)
        y = Output("m", "square root")
        feedthrough: ClassVar = {"y": ("u",)}

        def outputs(self, t):
            self.y = math.sqrt(self.u) if self.u >= 0.0 else math.nan

    component = running(Root, "boat")
    assert component.get("y") == 2.0
    component.advance(0.0, 0.5)
    component.set("u", -1.0)
    for _ in range(2):
        with pytest.raises(SimulationError, match=r"boat: output y is nan at t = 0\.5 s"):
            component.get("y")
    component.set("u", 9.0)
    assert component.get("y") == 3.0


def test_outputs_may_be_large() -> None:
    class Large(Component):
        y = Output("m", "y", axes="abc")

        def outputs(self, t):
            self.y = [1.7e308] * 3  # finite, though their sum is not

    component = running(Large)
    component.advance(0.0, 0.1)
    assert component.get("y") == [1.7e308] * 3


# ---------------------------------------------------------------------- time


class Watch(Component):
    """Remembers the times it is given."""

    y = Output("s", "time")

    def start(self, t):
        self.steps: list[tuple[float, float]] = []
        self.published = [t]

    def step(self, t, h):
        self.steps.append((t, h))

    def outputs(self, t):
        self.published.append(t)


@pytest.mark.interop
@pytest.mark.parametrize("start", [0.0, 12.34, 86400.0])
@pytest.mark.parametrize("h", [0.01, 0.02, 0.1, 1 / 3, 1 / 60])
def test_a_host_that_accumulates_its_time_is_kept_on_the_grid(h: float, start: float) -> None:
    """10^5 steps of t += h: every time is the double nearest to start + k h in whole ns."""
    steps = 100_000 if start == 0.0 else 20_000
    watch = Watch("watch")
    watch.setup(start)
    watch.initialise()
    watch.begin()
    first, t = len(watch.published), start
    for _ in range(steps):
        watch.advance(t, h)
        t += h
    start_ns, h_ns = round(Fraction(start) * NS), round(Fraction(h) * NS)
    expected = [float(Fraction(start_ns + k * h_ns, NS)) for k in range(steps + 1)]
    assert [t for t, _ in watch.steps] == expected[:-1]
    assert watch.published[first:] == expected[1:]
    assert {given for _, given in watch.steps} == {h_ns / NS}
    assert watch.now_ns == start_ns + steps * h_ns
    # The host's own sum did miss the grid, or this shows nothing.
    assert t != expected[-1]


@given(st.integers(-2 * 10**15, 2 * 10**15))
def test_seconds_give_their_nanoseconds_back(ns: int) -> None:
    assert round(seconds(ns) * NS) == ns
    assert seconds(ns) == float(Fraction(ns, NS))


@pytest.mark.parametrize("start", [1.7e9, -3e6, math.inf, math.nan])
def test_times_too_large_for_whole_nanoseconds_are_refused(start: float) -> None:
    with pytest.raises(InputError, match="it: start time is"):
        Lag("it").setup(start)


def test_starts_at_its_start_time() -> None:
    watch = Watch("watch")
    watch.setup(-1.5)
    watch.initialise()
    watch.begin()
    assert set(watch.published) == {-1.5}
    watch.advance(-1.5, 0.5)
    assert (watch.steps, watch.published[-1], watch.now) == ([(-1.5, 0.5)], -1.0, -1.0)


def test_a_host_that_jumps_is_followed_and_one_that_trembles_is_not() -> None:
    watch = running(Watch)
    watch.advance(0.0, 0.1)
    watch.advance(0.1 + 0.9e-3, 0.1)  # less than 1 % of the step
    assert watch.steps[-1][0] == 0.1
    watch.advance(0.2 - 1.1e-3, 0.1)
    assert watch.steps[-1][0] == 0.1989
    watch.advance(5.0, 0.1)
    assert (watch.steps[-1][0], watch.now) == (5.0, 5.1)


def test_steps_of_different_length_add_up() -> None:
    watch = running(Watch)
    t = 0.0
    for h in [0.1, 0.05, 0.025, 0.0125, 0.0125, 0.3] * 1000:
        watch.advance(t, h)
        t += h
    assert watch.now == 500.0


# ---------------------------------------------------------------------- state


class Deep(Component):
    """State in every allowed form, some of it born on the way."""

    u = Input("m", "u")
    y = Output("m", "y")

    def start(self, t):
        self.numbers = [0.0, 1]
        self.nested = {"a": [1.0, {"b": (2.0, [3.0])}], 7: None}
        self.array = np.zeros((2, 2))
        self.flag, self.text = False, "x"

    def step(self, t, h):
        self.numbers[0] += self.u
        self.nested["a"][1]["b"][1][0] *= 1.5
        self.array[0, 1] += self.u * h
        self.flag = not self.flag
        self.text += "y"
        if t >= 0.3:
            self.late = getattr(self, "late", 0.0) + 1.0

    def outputs(self, t):
        late = getattr(self, "late", 0.0)
        deep = self.nested["a"][1]["b"][1][0]
        self.y = self.numbers[0] + self.array.sum() + deep + late + len(self.text) + self.flag


def drive(component: Component, first: int, last: int) -> list[float]:
    rows = []
    for k in range(first, last):
        component.set("u", math.sin(k))
        component.advance(k / 10, 0.1)
        rows.append(component.get("y"))
    return rows


@pytest.mark.parametrize("at", [0, 2, 5])
def test_a_restored_component_goes_on_bit_by_bit(at: int) -> None:
    component = running(Deep)
    drive(component, 0, at)
    state = component.get_state()
    went_on = drive(component, at, 12)
    for _ in range(2):  # a state may be used again
        component.set_state(state)
        assert component.now == at / 10
        assert drive(component, at, 12) == went_on
    fresh = Deep("other")
    fresh.set_state(state)
    assert drive(fresh, at, 12) == went_on
    assert fresh.name == "other"


def test_attributes_born_later_are_gone_after_a_rollback() -> None:
    component = running(Deep)
    drive(component, 0, 2)
    state = component.get_state()
    drive(component, 2, 6)
    assert component.late == 3.0
    component.set_state(state)
    assert not hasattr(component, "late")


def test_a_state_is_a_copy_down_to_its_leaves() -> None:
    component = running(Deep)
    state = component.get_state()
    kept = copy.deepcopy(state)
    drive(component, 0, 6)
    component.set_state(state)
    drive(component, 0, 6)
    np.testing.assert_equal(state, kept)
    state["nested"]["a"][1]["b"][1][0] = 1e6
    assert component.nested["a"][1]["b"][1][0] < 1e3


def test_restoring_brings_back_values_phase_and_staleness() -> None:
    component = Lag("it")
    component.initialise()
    before = component.get_state()
    component.set("v", 1.0)
    pending = component.get_state()  # v is set, outputs are not computed
    component.begin()
    component.advance(0.0, 0.1)
    component.set_state(pending)
    component.set("gain", 5.0)  # in initialisation again
    assert (component.get("seen"), component.get("y.x")) == (1.0, 5.0)
    component.set_state(before)
    assert (component.get("seen"), component.get("y.x"), component.now) == (0.0, 2.0, 0.0)


Point = namedtuple("Point", "x y")


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (object(), "object"),
        ({1, 2}, "set"),
        (b"bytes", "bytes"),
        (Point(1, 2), "Point"),
        (np.array([object()]), "ndarray"),
        (np.random.default_rng(1), "Generator"),
        (lambda: 0, "function"),
        (Fraction(1, 3), "Fraction"),
        (1j, "complex"),
    ],
    ids=lambda v: v if isinstance(v, str) else "",
)
@pytest.mark.parametrize("nested", [False, True])
def test_state_that_is_no_plain_data_is_refused_by_name(value, kind: str, nested: bool) -> None:
    component = running()
    component.hidden = {"a": [1.0, (value,)]} if nested else value
    with pytest.raises(TypeError, match=rf"attribute it\.hidden is not plain data: {kind}$"):
        component.get_state()


@pytest.mark.parametrize("value", [np.int64(3), np.float64(0.1), np.bool_(True), np.str_("x")])
def test_numpy_numbers_are_plain_data(value) -> None:
    component = running()
    component.hidden = [value]
    state = component.get_state()
    json.dumps(state["hidden"])  # for which NumPy's own integers and Booleans are too odd
    component.set_state(state)
    assert component.hidden == [value.item()]


def test_transient_attributes_are_no_state_and_survive_a_rollback() -> None:
    class Connected(Lag):
        transient = Component.transient | {"socket"}

    component = running(Connected)
    component.socket = object()
    state = component.get_state()
    assert "socket" not in state
    assert "name" not in state
    socket = component.socket
    component.set_state(state)
    assert component.socket is socket


# ---------------------------------------------------------------------- noise


class Noisy(Noise, Sampled):
    """Two normal numbers per sample."""

    y = Output("m", "white", axes="ab")

    def sample(self, t, k):
        self.y = self.generator(k).standard_normal(2).tolist()


class Other(Noisy):
    pass


def drawn(cls: type[Noisy], seed: float, count: int, size: int = 1) -> np.ndarray:
    component = cls("it")
    component.set("seed", seed)
    return np.array([component.generator(k).standard_normal(size) for k in range(count)])


def test_noise_does_not_depend_on_how_often_or_in_which_order_it_is_asked() -> None:
    component = Noisy("it")
    forth = [component.generator(k).standard_normal(5).tolist() for k in range(50)]
    order = np.random.default_rng(0).permutation(50)
    for _ in range(2):
        for k in order:
            assert component.generator(int(k)).standard_normal(5).tolist() == forth[k]
    assert len({row[0] for row in forth}) == 50


def test_noise_is_the_same_after_a_rerun_a_rollback_and_with_half_steps() -> None:
    def run(parts: int, redo: bool = False) -> list[list[float]]:
        component = running(Noisy)
        rows = []
        for k in range(40):
            state = component.get_state()
            for i in range(parts):
                component.advance(k / 100 + i * 0.01 / parts, 0.01 / parts)
            if redo:
                component.set_state(state)
                component.advance(k / 100, 0.01)
            rows.append(component.get("y"))
        return rows

    once = run(1)
    assert once == run(1) == run(2) == run(1, redo=True) == run(5, redo=True)
    assert len({tuple(row) for row in once}) == 40


def test_seeds_and_kinds_of_component_draw_independent_numbers() -> None:
    """Correlation of 4000 pairs: |r| sqrt(n) is below 4.5 with 1 - 7e-6 confidence each."""
    series = [drawn(Noisy, seed, 4000)[:, 0] for seed in (1.0, 2.0, 3.0, 2.0**53)]
    series.append(drawn(Other, 1.0, 4000)[:, 0])
    correlation = np.corrcoef(series)
    off = correlation[~np.eye(len(series), dtype=bool)]
    assert np.abs(off).max() * math.sqrt(4000) < 4.5


def test_noise_is_standard_normal_and_white() -> None:
    """20 000 samples of 4; each check holds with 99.99 % confidence for true white noise."""
    values = drawn(Noisy, 7.0, 20_000, 4)
    flat = values.ravel()
    n = flat.size
    bound = stats.norm.isf(0.5e-4)  # 3.9 standard deviations
    assert abs(flat.mean()) * math.sqrt(n) < bound
    low, high = stats.chi2.interval(0.9999, n)
    assert low < (flat**2).sum() < high
    assert stats.kstest(flat, "norm").pvalue > 1e-4
    for lag in (1, 2, 3, 10):  # from sample to sample
        r = np.mean(values[lag:, 0] * values[:-lag, 0])
        assert abs(r) * math.sqrt(20_000 - lag) < bound
    for i, j in ((0, 1), (0, 3), (1, 2)):  # within a sample
        assert abs(np.mean(values[:, i] * values[:, j])) * math.sqrt(20_000) < bound


def test_samples_do_not_overlap_however_much_one_draws() -> None:
    """The stream of sample 0, a million numbers long, holds nothing of the next samples."""
    component = Noisy("it")
    long = set(component.generator(0).integers(0, 2**63, 10**6).tolist())
    for k in range(1, 50):
        assert long.isdisjoint(component.generator(k).integers(0, 2**63, 100).tolist())


@pytest.mark.parametrize(
    ("seed", "message"),
    [(-1.0, "allowed 0.0 to"), (1e30, "allowed 0.0 to"), (1.5, "a whole number is needed")],
)
def test_seeds_that_cannot_be(seed: float, message: str) -> None:
    component = Noisy("it")
    component.set("seed", seed)
    with pytest.raises(InputError, match=message):
        component.initialise()


@settings(max_examples=25)
@given(st.lists(st.tuples(st.sampled_from("uvs"), st.floats(-1e6, 1e6)), max_size=30))
def test_outputs_are_those_of_the_last_values_whatever_the_order_of_calls(calls) -> None:
    component = running()
    u, v, x, t = 0.0, 0.0, 2.0, 0.0
    for kind, value in calls:
        if kind == "u":
            u = value
            component.set("u.x", value)
        elif kind == "v":
            v = value
            component.set("v", value)
        else:
            component.advance(t, 0.5)
            t, x = t + 0.5, x + 0.5 * 0.5 * u
    assert component.get("y") == [x + u, x, x]
    assert component.get("seen") == v
    json.dumps({k: v for k, v in component.get_state().items() if k != "computed"})
