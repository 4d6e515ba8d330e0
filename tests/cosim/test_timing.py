"""Durations in bins, against NumPy's histogram and percentiles."""

from __future__ import annotations

import numpy as np
import pytest

from seatrial.sim.timing import StepTimes


def test_bins_are_those_of_a_histogram_with_edges_at_powers_of_two() -> None:
    durations = np.random.default_rng(3).lognormal(11.0, 2.0, 5000).astype(np.int64)
    times = StepTimes()
    for k, elapsed in enumerate(durations):
        times.add(int(elapsed), 10 * k)
    edges = [0, *(2**b for b in range(64))]
    assert times.bins == np.histogram(durations, [e - 0.5 for e in edges])[0].tolist()
    assert (times.count, times.total_ns) == (5000, durations.sum())
    assert times.longest_ns == durations.max()
    assert times.longest_at_ns == 10 * durations.argmax()


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99, 1.0])
def test_a_percentile_is_a_bound_less_than_twice_the_true_one(share: float) -> None:
    durations = np.random.default_rng(4).lognormal(9.0, 1.5, 3000).astype(np.int64)
    times = StepTimes()
    for elapsed in durations:
        times.add(int(elapsed), 0)
    true = np.percentile(durations, 100 * share, method="inverted_cdf")
    assert true <= times.at_most(share) < 2 * true


def test_nothing_counted_and_a_single_one() -> None:
    times = StepTimes()
    assert times.as_json()["bins"] == []
    assert times.as_json()["longest_at_s"] is None
    times.add(0, 7)
    assert times.as_json()["bins"] == [1]
    assert times.as_json()["longest_at_s"] == 7e-9


def test_what_is_longer_than_every_bin_is_in_the_last() -> None:
    times = StepTimes()
    times.add(10**30, 0)
    assert times.bins[-1] == times.count == 1
