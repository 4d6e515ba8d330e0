"""Instants of a component with a period of its own, against brute force and SciPy."""

from __future__ import annotations

import bisect
import itertools
import math
from fractions import Fraction
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from seatrial.errors import InputError
from seatrial.model.component import NS, Input, Output, Parameter
from seatrial.model.sampled import Sampled


class Diary(Sampled):
    """Writes down what it sees at every instant, and when it published what."""

    u = Input("m", "input")
    y = Output("m", "input as sampled")
    k = Output("1", "last instant sampled", type=int)
    held = Output("1", "calls of hold", type=int)
    feedthrough: ClassVar = {"y": ("u",), "k": ("u",)}

    def reset(self, t):
        self.updates: list[list[float]] = []
        self.holds = 0

    def sample(self, t, k):
        self.y, self.k = self.u, k

    def update(self, t, k):
        self.updates.append([k, t, self.u, self.y])

    def hold(self, t):
        self.holds += 1
        self.held = self.holds


def running(cls: type[Sampled], start: float = 0.0, **values) -> Sampled:
    component = cls("it")
    for name, value in values.items():
        component.set(name, value)
    component.setup(start)
    component.initialise()
    component.begin()
    return component


@st.composite
def schedules(draw) -> tuple[int, int, list[int]]:
    """A start, a period and communication steps, whole microseconds, at most 3000 instants."""
    period = draw(st.one_of(st.integers(1, 50), st.integers(1, 2_000_000)))
    steps = draw(st.lists(st.integers(1, 100 * period), min_size=1, max_size=30))
    return draw(st.integers(0, 10**8)), period, steps


@settings(max_examples=200)
@given(schedules())
def test_instants_are_those_of_brute_force(schedule: tuple[int, int, list[int]]) -> None:
    start, period, steps = schedule
    edges = list(itertools.accumulate(steps, initial=start))
    instants = range(start, edges[-1], period)
    holder = [
        bisect.bisect_right(edges, instant) - 1 for instant in instants
    ]  # whose step it is in
    diary = running(Diary, start / 1e6, period=period / 1e6)
    for number, (now, step) in enumerate(zip(edges, steps, strict=False)):
        diary.set("u", number)
        last = (now - start) // period
        # At an instant the input acts at once; between two the last one's stays.
        acting = number if now in instants else holder[last]
        assert (diary.get("y"), diary.get("k")) == (acting, last)
        diary.advance(now / 1e6, step / 1e6)
    assert diary.updates == [
        [k, float(Fraction(instant, 10**6)), number, number]
        for k, (instant, number) in enumerate(zip(instants, holder, strict=True))
    ]


def test_what_comes_between_two_instants_is_not_seen() -> None:
    diary = running(Diary, period=0.1)
    seen = []
    for k in range(41):  # a pulse between the instants at 0.2 and 0.3, one across 0.5
        diary.set("u", 1.0 if 21 <= 2 * k <= 29 or 49 <= 2 * k <= 51 else 0.0)
        seen.append(diary.get("y"))
        diary.advance(k * 0.02, 0.02)
    assert [k for k, y in enumerate(seen) if y] == [25, 26, 27, 28, 29]


@pytest.mark.parametrize(("step_ms", "per_step"), [(100, 10), (95, 9.5), (10, 1), (3, 0.3)])
def test_all_instants_of_a_step_run_and_the_last_is_published(step_ms: int, per_step) -> None:
    diary = running(Diary, period=0.01)
    t_ms = 0
    for number in range(1, 21):
        diary.set("u", number)
        diary.advance(t_ms / 1000, step_ms / 1000)
        t_ms += step_ms
        done = math.ceil(number * per_step - 1e-9)
        assert len(diary.updates) == done
        landed = t_ms % 10 == 0  # an instant at the very end is sampled, not yet updated
        assert diary.get("k") == (done if landed else done - 1)
        assert diary.get("y") == (number if landed else diary.updates[-1][3])
    assert [k for k, *_ in diary.updates] == list(range(len(diary.updates)))


class Delay(Sampled):
    """y(k) = u(k - 1)."""

    u = Input("m", "input")
    y = Output("m", "u, one sample ago")

    def reset(self, t):
        self.kept = 0.0

    def sample(self, t, k):
        self.y = self.kept

    def update(self, t, k):
        self.kept = self.u


@pytest.mark.parametrize("per_period", [1, 2, 5])
def test_a_unit_delay_delays_by_one_sample(per_period: int) -> None:
    u = np.random.default_rng(3).normal(size=200)
    delay = running(Delay, period=0.02)
    y = []
    for k, value in enumerate(u):
        delay.set("u", value)
        y.append(delay.get("y"))
        for i in range(per_period):
            delay.advance((k + i / per_period) * 0.02, 0.02 / per_period)
    np.testing.assert_array_equal(y, signal.lfilter([0.0, 1.0], [1.0], u))


def test_two_delays_in_a_row_are_two_samples() -> None:
    u = np.random.default_rng(4).normal(size=100)
    first, second = running(Delay), running(Delay)
    y = []
    for k, value in enumerate(u):
        first.set("u", value)
        second.set("u", first.get("y"))
        y.append(second.get("y"))
        for delay in (first, second):
            delay.advance(k * 0.01, 0.01)
    np.testing.assert_array_equal(y, signal.lfilter([0.0, 0.0, 1.0], [1.0], u))


class Filter(Sampled):
    """y = C x + D u, then x = A x + B u: output first, memory after."""

    u = Input("m", "input")
    y = Output("m", "filtered")
    feedthrough: ClassVar = {"y": ("u",)}
    A: ClassVar = np.array([[0.9, 0.2], [-0.3, 0.7]])
    B: ClassVar = np.array([0.5, -1.0])
    C: ClassVar = np.array([1.0, 0.25])
    D = 0.75

    def reset(self, t):
        self.x = np.zeros(2)

    def sample(self, t, k):
        self.y = self.C @ self.x + self.D * self.u

    def update(self, t, k):
        self.x = self.A @ self.x + self.B * self.u


def test_a_filter_with_feedthrough_is_scipys() -> None:
    u = np.random.default_rng(5).normal(size=300)
    component = running(Filter)
    y = []
    for k, value in enumerate(u):
        component.set("u", 99.0)  # read at the same instant, then changed: the last value counts
        component.get("y")
        component.set("u", value)
        y.append(component.get("y"))
        component.advance(k * 0.01, 0.01)
    system = (Filter.A, Filter.B[:, None], Filter.C[None, :], [[Filter.D]], 0.01)
    expected = signal.dlsim(system, u[:, None])[1].ravel()
    np.testing.assert_allclose(y, expected, rtol=0, atol=1e-13)


def test_reading_again_and_again_at_an_instant_leaves_the_memory_alone() -> None:
    once, often = running(Filter), running(Filter)
    for k in range(50):
        for _ in range(k % 4):
            often.set("u", k)
            often.get("y")
        for component in (once, often):
            component.set("u", math.cos(k))
            component.advance(k * 0.01, 0.01)
        assert once.get("y") == often.get("y")


@given(st.integers(0, 30), st.integers(1, 30))
def test_a_rollback_counts_instants_again(before: int, taken_back: int) -> None:
    diary = running(Diary, 3.0, period=0.025)

    def run(first: int, last: int) -> None:
        for k in range(first, last):
            diary.set("u", k)
            diary.advance(3.0 + k * 0.01, 0.01)

    run(0, before)
    state = diary.get_state()
    run(before, before + taken_back)
    written = list(diary.updates)
    diary.set_state(state)
    run(before, before + taken_back)
    assert diary.updates == written


def test_hold_runs_at_every_communication_point() -> None:
    diary = running(Diary, period=1.0)
    before = diary.get("held")
    for k in range(50):
        diary.advance(k / 100, 0.01)
    assert diary.get("held") == before + 50
    assert len(diary.updates) == 1


def test_a_period_that_is_no_whole_nanosecond_is_rounded_once() -> None:
    """60 Hz in 10 ms steps for 1000 s: 60 000 instants, drift of one third of a ns each."""
    diary = running(Diary, period=1 / 60)
    for k in range(100_000):
        diary.advance(k * 0.01, 0.01)
    period_ns = round(NS / 60)
    assert len(diary.updates) == -(-1000 * NS // period_ns) == 60_000
    assert diary.updates[-1][1] == 59_999 * period_ns / NS


@pytest.mark.parametrize("period", [0.0, -0.1, 5e-7])
def test_periods_below_a_microsecond_are_refused(period: float) -> None:
    with pytest.raises(InputError, match=r"it\.period is .* s, allowed at least 1e-06 s"):
        running(Diary, period=period)


def test_a_subclass_has_a_default_period_of_its_own() -> None:
    class Slow(Diary):
        period = Parameter(0.5, "s", "sample period", min=1e-6)

    slow, diary = running(Slow), running(Diary)
    for component in (slow, diary):
        component.advance(0.0, 1.0)
    assert (len(slow.updates), len(diary.updates)) == (2, 100)
