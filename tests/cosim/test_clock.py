"""Pacing, with a simulated clock against closed forms, and with the real one."""

from __future__ import annotations

import itertools
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.sim.clock import SLICE_NS, OverrunPolicy, Pacer

MS = 1_000_000
STEP = 10 * MS


class Wall:
    """A clock that only sleeping and working move."""

    def __init__(self) -> None:
        self.ns = 123_456_789

    def sleep(self, seconds: float) -> None:
        self.ns += round(seconds * 1e9)

    def pacer(self, factor: float, policy: OverrunPolicy) -> Pacer:
        pacer = Pacer(factor, policy, now=lambda: self.ns, sleep=self.sleep, spin_ns=0)
        pacer.start(0)
        return pacer


def presented(work: list[int], factor: float, policy: OverrunPolicy) -> tuple[list[int], Pacer]:
    """Return when each communication point came, ns since the start, for steps of that work."""
    wall = Wall()
    start, pacer, points = wall.ns, wall.pacer(factor, policy), []
    for k, busy in enumerate(work, start=1):
        wall.ns += busy
        pacer.keep(k * STEP)
        points.append(wall.ns - start)
    return points, pacer


@pytest.mark.parametrize("policy", ["catch-up", "slip", "abort"])
@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_steps_in_time_come_at_t_over_factor(factor: float, policy: OverrunPolicy) -> None:
    points, pacer = presented([MS // 2] * 50, factor, policy)
    assert points == [round(k * STEP / factor) for k in range(1, 51)]
    assert (pacer.overruns.count, pacer.lost_ns, pacer.drift_ns) == (0, 0, 0)
    assert pacer.slack.total_ns == 50 * (round(STEP / factor) - MS // 2)
    assert (pacer.wake_ups.count, pacer.wake_ups.total_ns) == (50, 0)


def test_catching_up_after_a_hiccup() -> None:
    points, pacer = presented([MS] * 4 + [35 * MS] + [MS] * 5, 1.0, "catch-up")
    assert [p // MS for p in points] == [10, 20, 30, 40, 75, 76, 77, 80, 90, 100]
    assert (pacer.overruns.count, pacer.overruns.total_ns) == (3, (25 + 16 + 7) * MS)
    assert (pacer.overruns.longest_ns, pacer.overruns.longest_at_ns) == (25 * MS, 5 * STEP)
    assert (pacer.lost_ns, pacer.drift_ns) == (0, 0)


def test_slipping_loses_the_hiccup() -> None:
    points, pacer = presented([MS] * 4 + [35 * MS] + [MS] * 5, 1.0, "slip")
    assert [p // MS for p in points] == [10, 20, 30, 40, 75, 85, 95, 105, 115, 125]
    assert (pacer.overruns.count, pacer.lost_ns, pacer.drift_ns) == (1, 25 * MS, 25 * MS)


def test_lateness_is_reported_to_whom_it_must_end_the_run() -> None:
    wall = Wall()
    pacer = wall.pacer(1.0, "abort")
    wall.ns += 9 * MS
    assert pacer.keep(STEP) == 0
    wall.ns += 12 * MS
    assert pacer.keep(2 * STEP) == 2 * MS


@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_steps_that_are_always_too_long_drift_by_their_excess(factor: float) -> None:
    period, n = round(STEP / factor), 200
    for policy, lateness, lost in (("catch-up", n * (n + 1) // 2, 0), ("slip", n, n)):
        points, pacer = presented([period + 3] * n, factor, policy)
        assert points[-1] == n * (period + 3)
        assert (pacer.overruns.count, pacer.overruns.total_ns) == (n, 3 * lateness)
        assert (pacer.lost_ns, pacer.drift_ns) == (3 * lost, 3 * n)


@pytest.mark.slow
def test_rounding_does_not_add_up() -> None:
    points, pacer = presented([1000] * 300_000, 3.0, "catch-up")
    assert points[-1] == 1_000_000 * MS  # 3000 s of simulated time
    assert pacer.overruns.count == 0


@pytest.mark.slow
@given(st.lists(st.integers(0, 40 * MS), min_size=1, max_size=60))
def test_the_points_follow_the_recursion_of_each_policy(work: list[int]) -> None:
    caught, _ = presented(work, 1.0, "catch-up")
    slipped, pacer = presented(work, 1.0, "slip")
    expected_caught, expected_slipped, due = [0], [0], 0
    for k, busy in enumerate(work, start=1):
        expected_caught.append(max(k * STEP, expected_caught[-1] + busy))
        due = max(due + STEP, expected_slipped[-1] + busy)
        expected_slipped.append(due)
    assert caught == expected_caught[1:]
    assert slipped == expected_slipped[1:]
    assert pacer.lost_ns == slipped[-1] - len(work) * STEP


def test_a_stop_ends_a_long_wait_within_a_slice() -> None:
    wall = Wall()
    pacer = wall.pacer(1e-6, "catch-up")
    polls = itertools.count()
    before = wall.ns
    assert pacer.keep(STEP, lambda: next(polls) >= 3) == 0
    assert wall.ns - before == 3 * SLICE_NS
    assert SLICE_NS <= 50 * MS
    assert pacer.wake_ups.count == 0


def test_another_factor_counts_from_the_point_on_at_which_it_comes() -> None:
    wall = Wall()
    start, pacer, points = wall.ns, wall.pacer(1.0, "catch-up"), []
    for k in range(1, 31):
        if k in (11, 21):
            pacer.change({11: 4.0, 21: 0.5}[k], (k - 1) * STEP)
        wall.ns += MS
        pacer.keep(k * STEP)
        points.append((wall.ns - start) / MS)
    by_hand = [10.0 * k for k in range(1, 11)]
    by_hand += [100 + 2.5 * k for k in range(1, 11)] + [125 + 20 * k for k in range(1, 11)]
    assert points == by_hand
    assert (pacer.overruns.count, pacer.lost_ns, pacer.drift_ns) == (0, 0, 0)


def test_the_same_factor_changes_nothing() -> None:
    wall = Wall()
    pacer = wall.pacer(1.0, "catch-up")
    wall.ns += 35 * MS
    assert pacer.keep(STEP) == 25 * MS
    pacer.change(1.0, STEP)
    wall.ns += MS
    assert pacer.keep(2 * STEP) == 16 * MS


@pytest.mark.parametrize("policy", ["catch-up", "slip"])
def test_a_run_that_could_not_keep_up_does_not_race_on_when_it_is_slowed(policy) -> None:
    wall = Wall()
    pacer = wall.pacer(100.0, policy)
    for k in range(1, 101):  # steps of 1 ms, of which 0.1 ms are allowed
        wall.ns += MS
        pacer.keep(k * STEP)
    late, begun = pacer.overruns.count, wall.ns
    assert late == 100
    pacer.change(1.0, 100 * STEP)
    for k in range(101, 111):
        wall.ns += MS
        pacer.keep(k * STEP)
        assert wall.ns - begun == (k - 100) * STEP
    assert pacer.overruns.count == late
    assert pacer.lost_ns == pacer.drift_ns == 90 * MS


@pytest.mark.parametrize("policy", ["catch-up", "slip", "abort"])
def test_a_pause_is_left_out(policy: OverrunPolicy) -> None:
    wall = Wall()
    start, pacer, points = wall.ns, wall.pacer(1.0, policy), []
    for k in range(1, 11):
        wall.ns += MS
        if k == 5:
            wall.ns += 1000 * MS
            pacer.pause(1000 * MS)
        assert pacer.keep(k * STEP) == 0
        points.append((wall.ns - start) // MS)
    assert points == [10, 20, 30, 40, *range(1050, 1101, 10)]
    assert (pacer.overruns.count, pacer.lost_ns, pacer.drift_ns) == (0, 0, 0)
    assert pacer.as_json()["paused_s"] == 1.0
    assert pacer.note() == "no overrun: every step ended before its deadline; 1 s paused"


@given(
    st.lists(
        st.tuples(st.integers(0, 40), st.sampled_from([0.5, 1.0, 2.0, 8.0]), st.integers(0, 500)),
        min_size=1, max_size=60,
    )
)  # fmt: skip
def test_no_point_comes_early_whatever_changes(steps: list[tuple[int, float, int]]) -> None:
    # Neither less wall time than simulated time over the factor, nor a race after changes.
    wall = Wall()
    pacer = wall.pacer(1.0, "slip")
    for k, (busy, factor, paused) in enumerate(steps, start=1):
        before = wall.ns
        pacer.change(factor, (k - 1) * STEP)
        wall.ns += (busy + paused) * MS
        pacer.pause(paused * MS)
        pacer.keep(k * STEP)
        assert wall.ns - before == max(round(STEP / factor), busy * MS) + paused * MS


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_the_real_clock_is_never_early(factor: float) -> None:
    pacer = Pacer(factor, "catch-up")
    begun = time.monotonic_ns()
    pacer.start(0)
    for k in range(1, 21):
        pacer.keep(k * STEP)
        assert time.monotonic_ns() - begun >= k * STEP / factor
    assert pacer.overruns.count + pacer.slack.count == 20


def test_a_note_tells_of_overruns() -> None:
    assert presented([MS], 1.0, "slip")[1].note().startswith("no overrun")
    _, pacer = presented([MS, 35 * MS, MS], 1.0, "slip")
    assert pacer.note() == (
        "1 of 3 steps ended after their deadline, the latest 25 ms, at t = 0.02 s; 0.025 s lost"
    )
