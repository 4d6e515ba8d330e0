"""Designs against closed forms: strata, moments, correlation."""

import math
from typing import Any

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.trials.designs import Design, drawn


def numbers(key: str = "a", **content: Any) -> np.ndarray:
    rows = drawn(Design.model_validate(content), "here")
    return np.array([float(str(row[key]).split()[0]) for row in rows])


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol"])
def test_one_point_lies_in_each_stratum(kind: str) -> None:
    vary = {"a": {"uniform": [0.0, 64.0]}, "b": {"uniform": [0.0, 64.0]}}
    for key in vary:
        found = numbers(key, kind=kind, count=64, seed=3, vary=vary)
        assert sorted(np.floor(found)) == list(range(64))


@pytest.mark.parametrize(
    ("entry", "mean", "deviation"),
    [
        ({"normal": ["22 kg", "1000 g"]}, 22.0, 1.0),
        ({"uniform": ["1 m", "400 cm"]}, 2.5, 3.0 / math.sqrt(12.0)),
        ({"lognormal": [3.0, 0.9]}, 3.0, 0.9),
        ({"triangular": [0.0, 1.0, 5.0]}, 2.0, math.sqrt((25.0 + 1.0 - 5.0) / 18.0)),
        ({"integers": [1, 6]}, 3.5, math.sqrt(35.0 / 12.0)),
        # cut at one standard deviation: 1 - 2 phi(1) / (2 Phi(1) - 1) is the variance
        ({"normal": [5.0, 2.0], "between": [3.0, 7.0]}, 5.0, 2.0 * math.sqrt(0.2911250948)),
        ({"normal": ["20 degC", "2 K"]}, 20.0, 2.0),
    ],
)
def test_moments_are_those_of_the_closed_form(entry: Any, mean: float, deviation: float) -> None:
    found = numbers(kind="latin-hypercube", count=20_000, vary={"a": entry})
    assert found.mean() == pytest.approx(mean, rel=1e-3)
    assert found.std() == pytest.approx(deviation, rel=5e-3)


@pytest.mark.parametrize(("kind", "tolerance"), [("sobol", 0.005), ("monte-carlo", 0.03)])
def test_correlation_is_the_one_given(kind: str, tolerance: float) -> None:
    content: Any = {
        "kind": kind,
        "count": 8192,
        "vary": {"a": {"normal": [5.0, 2.0]}, "b": {"normal": ["3 m", "10 cm"]}},
        "correlation": [{"between": ["b", "a"], "coefficient": -0.7}],
    }
    found = np.corrcoef(numbers("a", **content), numbers("b", **content))[0, 1]
    assert found == pytest.approx(-0.7, abs=tolerance)


def test_the_seed_alone_decides() -> None:
    content: Any = {"kind": "sobol", "count": 16, "vary": {"a": {"uniform": [0.0, 1.0]}}}
    first = numbers(**content, seed=1)
    assert np.array_equal(first, numbers(**content, seed=1))
    assert not np.array_equal(first, numbers(**content, seed=2))


CONTRADICTING = [
    {"between": ["a", "b"], "coefficient": 0.9},
    {"between": ["b", "c"], "coefficient": 0.9},
    {"between": ["a", "c"], "coefficient": -0.9},
]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": "sobol", "count": 100}, "power of 2, such as 64 or 128, found 100"),
        ({"correlation": CONTRADICTING}, "not positive definite"),
        ({"correlation": CONTRADICTING[:1] * 2}, "each pair once"),
        ({"kind": "latin-hypercube", "correlation": CONTRADICTING[:1]}, "strata"),
        ({"vary": {"a": {}}}, "vary: a: exactly one of normal"),
        ({"vary": {"a": {"normal": ["1 kg", "1 m"]}}}, "'m' cannot be converted to 'kg'"),
        ({"vary": {"a": {"normal": ["1 kg", 1.0]}}}, "all numbers with a unit, or none"),
        ({"vary": {"a": {"normal": [1.0, -1.0]}}}, "a positive standard deviation"),
        ({"vary": {"a": {"uniform": [2.0, 1.0]}}}, "low below high"),
        ({"vary": {"a": {"uniform": [1.0, 2.0], "between": [3.0, 4.0]}}}, "between: nothing"),
    ],
)
def test_a_mistake_is_named(changes: Any, message: str) -> None:
    vary = {key: {"normal": [0.0, 1.0]} for key in "abc"}
    content = {"kind": "monte-carlo", "count": 4, "vary": vary, **changes}
    with pytest.raises(InputError, match=message):
        drawn(Design.model_validate(content), "here")
