"""Orders and errors of step halving, against errors that are known."""

from __future__ import annotations

import numpy as np
import pytest

from seatrial.trial.records.accuracy import accuracy, by_port, ranked

T = np.linspace(0.0, 2.0, 101)
TRUE = np.sin(3.0 * T)


def runs(order: float, size: float = 0.1, count: int = 3) -> list[np.ndarray]:
    """Return runs whose error is ``size`` t cos(t), halved ``order`` times with each step."""
    return [TRUE + size * 2.0 ** (-order * i) * T * np.cos(T) for i in range(count)]


@pytest.mark.parametrize("count", [3, 5])
@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_an_error_of_known_order_is_found_exactly(order: float, count: int) -> None:
    values = runs(order, count=count)
    found = accuracy("a.x", "m", values, 1.0)
    assert found.behaviour == "converges"
    assert found.orders == pytest.approx([order] * (count - 1 - 1))
    assert found.errors == pytest.approx([np.max(np.abs(y - TRUE)) for y in values])
    assert found.relative == pytest.approx(found.errors[0] / np.ptp(values[-1]))


def test_differences_of_round_off_are_exact() -> None:
    values = [TRUE, TRUE + 1e-13, TRUE - 1e-13]
    assert accuracy("a.x", "m", values, 1.0).behaviour == "exact"
    assert accuracy("a.x", "m", values, 1e-3).behaviour == "not converging"
    assert accuracy("a.x", "m", [0 * T] * 3, 0.0).behaviour == "exact"


def test_a_difference_that_sinks_into_round_off_bounds_the_order() -> None:
    found = accuracy("a.x", "m", [TRUE + 1e-9 * T, TRUE, TRUE], 1.0)
    assert found.behaviour == "converges"
    assert found.errors[0] == pytest.approx(2e-9, rel=0.01)


@pytest.mark.parametrize(
    "values",
    [
        runs(-1.0),
        runs(0.3),
        [TRUE + 0.1 * np.random.default_rng(k).standard_normal(len(T)) for k in range(3)],
        [TRUE, TRUE + 0.01, TRUE + 0.03, TRUE + 0.031],
    ],
    ids=["grows", "hardly shrinks", "noise", "grew before"],
)
def test_differences_that_do_not_shrink_do_not_converge(values: list[np.ndarray]) -> None:
    found = accuracy("a.x", "m", values, 1.0)
    assert (found.behaviour, found.errors) == ("not converging", [])


def test_the_worst_comes_first_one_for_each_port() -> None:
    small, large = runs(1.0, 0.001), runs(1.0, 0.1)
    outputs = [
        accuracy("a.exact", "m", [TRUE] * 3, 1.0),
        accuracy("a.x.n", "m", small, 1.0),
        accuracy("a.x.e", "m", large, 1.0),
        accuracy("b.y", "m", runs(-1.0, 0.0001), 1.0),
    ]
    assert [o.signal for o in ranked(outputs)] == ["b.y", "a.x.e", "a.x.n", "a.exact"]
    assert [o.signal for o in by_port(outputs, "ab")] == ["b.y", "a.x.e", "a.exact"]
