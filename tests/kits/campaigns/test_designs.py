"""Designs against closed forms: strata, moments, correlation."""

import math
from collections import Counter
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from seatrial.errors import InputError
from seatrial_kits.campaigns.designs import Design, drawn
from seatrial_kits.campaigns.distributions import Distribution, read_distribution


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
        ({"levels": ["1 m", "2 m", "6 m"]}, 3.0, math.sqrt(14.0 / 3.0)),
        # Gamma(1.5) and Gamma(2) of a Weibull law with the shape 2, which is Rayleigh's.
        ({"weibull": ["8 m/s", 2]}, 4 * math.sqrt(math.pi), 8 * math.sqrt(1 - math.pi / 4)),
        ({"rayleigh": "2 m"}, 2.0, 2.0 * math.sqrt(4 / math.pi - 1)),
        ({"exponential": "30 s"}, 30.0, 30.0),
        ({"levels": [1.0, 2.0, 6.0], "weights": [1, 2, 1]}, 2.75, math.sqrt(3.6875)),
        # a tenth in [0, 1], the rest in [2, 4]
        (
            {"bins": ["0 m", "1 m", "2 m", "4 m"], "weights": [1, 0, 9]},
            2.75,
            math.sqrt(0.1 / 3.0 + 0.9 * 28.0 / 3.0 - 2.75**2),
        ),
        ({"spaced": ["-30 cm", "0.3 m", 7]}, 0.0, 10.0 * math.sqrt(48.0 / 12.0)),
    ],
)
def test_moments_are_those_of_the_closed_form(entry: Any, mean: float, deviation: float) -> None:
    found = numbers(kind="latin-hypercube", count=20_000, vary={"a": entry})
    assert found.mean() == pytest.approx(mean, rel=1e-3, abs=1e-3 * deviation)
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


def test_a_net_of_sobols_has_one_point_in_every_elementary_interval() -> None:
    # in two dimensions his sequence is a (0, 2)-sequence (Niederreiter 1987), scrambled or not
    vary = {"a": {"uniform": [0.0, 1.0]}, "b": {"uniform": [0.0, 1.0]}}
    a, b = (numbers(key, kind="sobol", count=64, seed=5, vary=vary) for key in "ab")
    for k in range(7):
        boxes = np.floor(a * 2**k) * 64 + np.floor(b * 2 ** (6 - k))
        assert len(np.unique(boxes)) == 64


@pytest.mark.slow
def test_discrepancy_is_that_of_the_kind() -> None:
    # Hickernell 1998: of n independent points the squared centred discrepancy is on average
    # ((5/4)^s - (13/12)^s) / n
    vary = {key: {"uniform": [0.0, 1.0]} for key in "abc"}

    def discrepancy(kind: str, seed: int) -> float:
        design = Design.model_validate({"kind": kind, "count": 64, "seed": seed, "vary": vary})
        points = np.array([list(row.values()) for row in drawn(design, "here")])
        return float(qmc.discrepancy(points, method="CD"))

    found = {
        kind: np.mean([discrepancy(kind, seed) for seed in range(60)])
        for kind in ("monte-carlo", "latin-hypercube", "sobol")
    }
    independent = ((5.0 / 4.0) ** 3 - (13.0 / 12.0) ** 3) / 64.0
    # of 60 means, whose spread was 0.2 of them
    assert found["monte-carlo"] == pytest.approx(independent, rel=0.1)
    assert found["sobol"] < found["latin-hypercube"] / 3.0 < found["monte-carlo"] / 4.0


def rows(vary: Any, **content: Any) -> list[dict[str, Any]]:
    return drawn(Design.model_validate({"vary": vary, **content}), "here")


def test_a_full_factorial_has_every_combination_the_last_key_fastest() -> None:
    vary = {
        "m": {"spaced": ["0 kg", "0.3 kg", 4]},
        "way": {"levels": ["a", "b"]},
        "n": {"integers": [1, 3]},
    }
    found = rows(vary, kind="full-factorial")
    assert len(found) == 24
    assert [tuple(row.values()) for row in found[:4]] == [
        ("0.0 kg", "a", 1), ("0.0 kg", "a", 2), ("0.0 kg", "a", 3), ("0.0 kg", "b", 1),
    ]  # fmt: skip
    assert list(dict.fromkeys(row["m"] for row in found)) == [
        "0.0 kg",
        "0.1 kg",
        "0.2 kg",
        "0.3 kg",
    ]


def signs(count: int, **content: Any) -> np.ndarray:
    vary = {f"k{i}": {"levels": [-1.0, 1.0]} for i in range(count)}
    found = rows(vary, kind="fractional-factorial", **content)
    return np.array([list(row.values()) for row in found])


def shortest_word(design: np.ndarray) -> int:
    """The resolution: fewest columns whose product does not change."""
    for length in range(1, design.shape[1] + 1):
        for columns in combinations(range(design.shape[1]), length):
            if abs(design[:, columns].prod(axis=1).sum()) == len(design):
                return length
    return design.shape[1] + 1


# Montgomery, Design and Analysis of Experiments, 8th ed., table 8.14: factors, resolution, runs
@pytest.mark.parametrize(
    ("factors", "resolution", "runs"),
    [(3, 3, 4), (4, 4, 8), (5, 3, 8), (5, 5, 16), (6, 3, 8), (6, 4, 16), (6, 6, 32), (7, 3, 8), (7, 4, 16), (8, 4, 16), (8, 5, 64), (11, 3, 16), (15, 3, 16)],
)  # fmt: skip
def test_fractions_are_those_of_the_published_table(
    factors: int, resolution: int, runs: int
) -> None:
    design = signs(factors, resolution=resolution)
    assert design.shape == (runs, factors)
    assert np.array_equal(design.T @ design, runs * np.eye(factors))  # orthogonal
    assert not design.sum(axis=0).any()  # balanced
    assert shortest_word(design) >= resolution


def test_generators_make_the_columns_they_name() -> None:
    a, b, c, product, turned = signs(5, generators="a b c abc -ac").T
    assert np.array_equal(product, a * b * c)
    assert np.array_equal(turned, -a * c)
    assert len({*zip(a, b, c, strict=True)}) == 8


def test_a_text_is_drawn_as_often_as_another() -> None:
    vary = {"algorithm": {"levels": ["jacobi", "gauss-seidel"]}, "x": {"normal": [0.0, 1.0]}}
    for kind in ("latin-hypercube", "sobol"):
        found = Counter(row["algorithm"] for row in rows(vary, kind=kind, count=64))
        assert found == {"jacobi": 32, "gauss-seidel": 32}


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
        ({"vary": {"a": {"levels": [1, 2, 1]}}}, "each level once"),
        ({"vary": {"a": {"levels": [1, 2], "between": [1, 2]}}}, "between: it cuts continuous"),
        ({"vary": {"a": {"spaced": [1.0, 2.0, 1]}}}, "how many from 2 on"),
        ({"count": None}, "count: monte-carlo needs it"),
        ({"resolution": 4}, "resolution: not of monte-carlo"),
        ({"kind": "full-factorial"}, "count: not of full-factorial"),
    ],
)
def test_a_mistake_is_named(changes: Any, message: str) -> None:
    vary = {key: {"normal": [0.0, 1.0]} for key in "abc"}
    content = {"kind": "monte-carlo", "count": 4, "vary": vary, **changes}
    with pytest.raises(InputError, match=message):
        drawn(Design.model_validate(content), "here")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, "needs resolution or generators"),
        ({"resolution": 4, "generators": "a b ab"}, "needs resolution or generators"),
        ({"generators": "a b"}, "a word for each of 3 keys"),
        ({"generators": "a b d"}, "letters of their own are a, b, c"),
        ({"generators": "a b ac"}, "'ac' is no product of a, b"),
        ({"generators": "a b aa"}, "'aa' is no product"),
        (
            {"generators": "a b c", "vary": {"a": {"levels": [1, 2, 3]}}},
            "needs two levels, found 3",
        ),
        ({"generators": "a", "vary": {"a": {"normal": [0.0, 1.0]}}}, "levels, spaced or integers"),
    ],
)
def test_a_mistake_in_a_fraction_is_named(changes: Any, message: str) -> None:
    vary = {key: {"levels": [0.0, 1.0]} for key in "abc"}
    with pytest.raises(InputError, match=message):
        rows(**{"vary": vary, "kind": "fractional-factorial", **changes})


SCATTER: dict[str, Any] = {
    "rows": {"key": "hs", "bins": ["0 m", "1 m", "3 m"]},
    "columns": {"key": "tp", "bins": ["4 s", "6 s", "8 s", "12 s"]},
    "occurrences": [[10, 30, 0], [0, 20, 40]],
}


@pytest.mark.parametrize("kind", ["monte-carlo", "latin-hypercube", "sobol"])
def test_cells_of_a_scatter_diagram_are_drawn_by_their_occurrences(kind: str) -> None:
    rows = drawn(Design.model_validate({"kind": kind, "count": 8192, "scatter": SCATTER}), "here")
    hs = np.array([float(row["hs"].removesuffix(" m")) for row in rows])
    tp = np.array([float(row["tp"].removesuffix(" s")) for row in rows])
    found, *_ = np.histogram2d(hs, tp, bins=[[0, 1, 3], [4, 6, 8, 12]])
    expected = np.array(SCATTER["occurrences"]) / 100.0
    # Four standard errors of a share of 8192 independent draws.
    assert found / 8192 == pytest.approx(expected, abs=4 * math.sqrt(0.25 / 8192))
    assert (found[expected == 0] == 0).all()
    inside = tp[(hs > 1) & (tp > 8)]
    assert inside.mean() == pytest.approx(10.0, abs=4 * 4 / math.sqrt(12 * len(inside)))
    assert stats.kstest(inside, stats.uniform(8, 4).cdf).pvalue > 1e-3


def test_a_scatter_diagram_stands_beside_keys_that_correlate() -> None:
    content: Any = {
        "kind": "sobol", "count": 4096, "scatter": SCATTER,
        "vary": {"a": {"normal": [0.0, 1.0]}, "b": {"normal": [0.0, 1.0]}},
        "correlation": [{"between": ["a", "b"], "coefficient": 0.8}],
    }  # fmt: skip
    rows = drawn(Design.model_validate(content), "here")
    table = np.array([[row["a"], row["b"], float(row["hs"].split()[0])] for row in rows])
    correlation = np.corrcoef(table.T)
    assert correlation[0, 1] == pytest.approx(0.8, abs=0.02)
    assert correlation[0, 2] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"occurrences": [[1, 2, 3]]}, "2 rows of 3 numbers are needed, one less than bins"),
        ({"occurrences": [[1, 2], [3, 4]]}, "found 2 of 2"),
        ({"occurrences": [[0, 0, 0], [0, 0, 0]]}, "all are 0"),
        ({"occurrences": [[1, 2, -3], [0, 0, 0]]}, "numbers from 0 on are needed"),
        ({"rows": {"key": "tp", "bins": ["0 m", "1 m", "3 m"]}}, "found tp twice"),
        ({"rows": {"key": "hs", "bins": ["0 m", "3 m", "1 m"]}}, "rows: bins: limits in increasing"),
    ],
)  # fmt: skip
def test_mistakes_in_a_scatter_diagram(change: Any, said: str) -> None:
    content = {"kind": "monte-carlo", "count": 4, "scatter": {**SCATTER, **change}}
    with pytest.raises(InputError, match=said):
        drawn(Design.model_validate(content), "here")


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"bins": [0, 1, 2]}, r"weights = \[...\], 2 of them, is needed"),
        ({"bins": [0, 1, 2], "weights": [1]}, "weights: 2 numbers from 0 on, not all 0, is needed"),
        ({"bins": [0, 1, 2], "weights": [1, 1], "between": [0, 1]}, "between: it cuts other"),
    ],
)
def test_mistakes_in_bins(entry: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        drawn(Design.model_validate({"kind": "monte-carlo", "count": 4, "vary": {"a": entry}}), "x")


def test_a_design_without_a_key_is_refused() -> None:
    with pytest.raises(InputError, match="nothing varies"):
        drawn(Design.model_validate({"kind": "monte-carlo", "count": 4}), "here")


@pytest.mark.parametrize(
    ("form", "law"),
    [
        ({"uniform": [1.3, 6.1]}, stats.uniform(1.3, 6.1 - 1.3)),
        ({"normal": [22.0, 0.7]}, stats.norm(22.0, 0.7)),
    ],
)
@pytest.mark.parametrize("between", [None, [2.0, 21.7]])
def test_numbers_have_the_bits_of_scipy(form: Any, law: Any, between: list[float] | None) -> None:
    read = read_distribution(Distribution.model_validate({**form, "between": between}), "here")
    p = np.random.default_rng(1).random(10_000)
    if between is None:
        assert (read.quantiles(p) == law.ppf(p)).all()
        return
    low, high = law.cdf(between)
    assert (read.quantiles(p) == np.clip(law.ppf(low + (high - low) * p), *between)).all()
